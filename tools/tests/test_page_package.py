# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The page that is shipped: it is that of these sources, whole, and says nothing of its builder."""

from __future__ import annotations

import hashlib
import json
import re
import zipfile
from pathlib import Path

import pytest

from tools import page_package
from tools.page_package import MANIFEST, PACKED


def packed_files() -> dict[str, bytes]:
    """The files of the packed page."""
    with zipfile.ZipFile(PACKED) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_the_shipped_page_was_built_from_these_sources() -> None:
    """Else it is stale: 'make page' builds and packs it."""
    changed = page_package.stale()
    assert not changed, f"the shipped page is stale, run 'make page'; changed: {changed}"


def test_the_archive_has_the_files_of_its_manifest() -> None:
    """One cannot be renewed without the other."""
    digests = {
        name: hashlib.sha256(content).hexdigest() for name, content in packed_files().items()
    }
    assert digests == json.loads(MANIFEST.read_text())["files"]


def test_every_package_of_the_page_runs_on_the_oldest_node() -> None:
    """A newer Node.js on a developer's machine hides one that does not."""
    lock = json.loads((page_package.ROOT / "web" / "package-lock.json").read_text())["packages"]
    (oldest,) = re.findall(r"^>=(\d+)", lock[""]["engines"]["node"])
    for name, package in lock.items():
        accepted = package.get("engines", {}).get("node", ">=0")
        majors = re.findall(r"(\^|>=) ?v?(\d+)", accepted)
        fits = (n == oldest if sign == "^" else int(n) <= int(oldest) for sign, n in majors)
        assert any(fits), f"{name} needs Node.js {accepted}"


def test_no_folder_of_the_builder_is_in_the_page() -> None:
    """The same sources give the same bytes in every folder, with the pinned tools."""
    for name, content in packed_files().items():
        found = re.findall(rb"/(?:home|root|work|tmp|Users)/[\w./-]+", content)
        assert not found, f"{name}: {found[:3]}"


def test_a_changed_source_and_another_page_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By their files."""
    monkeypatch.setattr(page_package, "ROOT", tmp_path)
    monkeypatch.setattr(page_package, "BUILT", tmp_path / "build" / "page")
    monkeypatch.setattr(page_package, "PACKED", tmp_path / "page.zip")
    monkeypatch.setattr(page_package, "MANIFEST", tmp_path / "page.json")
    source, built = tmp_path / "web" / "src" / "main.ts", tmp_path / "build" / "page" / "main.js"
    for path in (source, built):
        path.parent.mkdir(parents=True)
        path.write_text("1")
    page_package.pack(["rustc 1"])
    before = (tmp_path / "page.zip").read_bytes()
    page_package.pack(["rustc 1"])
    assert (tmp_path / "page.zip").read_bytes() == before
    assert (page_package.stale(), page_package.different()) == ([], [])
    source.write_text("2")
    built.write_text("2")
    assert (page_package.stale(), page_package.different()) == (["web/src/main.ts"], ["main.js"])
