# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The page that is shipped: it is that of these sources, whole, and says nothing of its builder."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import zipfile
from pathlib import Path

import pytest

from tools.page_package import PACKAGES, ROOT, Package

EACH = pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.packed.name)


def packed_files(package: Package) -> dict[str, bytes]:
    """The files of a packed page."""
    with zipfile.ZipFile(package.packed) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@EACH
def test_the_shipped_page_was_built_from_these_sources(package: Package) -> None:
    """Else it is stale: 'make page' builds and packs it."""
    changed = package.stale()
    assert not changed, f"the shipped page is stale, run 'make page'; changed: {changed}"


@pytest.mark.long("builds the page")
def test_the_sources_give_the_bytes_that_are_shipped() -> None:
    """Where the pinned Rust and Node.js are."""
    compared = subprocess.run(
        [ROOT / "tools" / "page", "compare"], text=True, capture_output=True, check=False
    )
    if compared.returncode == 4:
        pytest.skip(compared.stderr)
    assert compared.returncode == 0, compared.stdout + compared.stderr


@EACH
def test_the_archive_has_the_files_of_its_manifest(package: Package) -> None:
    """One cannot be renewed without the other."""
    digests = {
        name: hashlib.sha256(content).hexdigest() for name, content in packed_files(package).items()
    }
    assert digests == json.loads(package.listed.read_text())["files"]


def test_the_studio_with_its_editor_is_small() -> None:
    """A quarter of a megabyte beside the brick's page, most of it CodeMirror."""
    (studio,) = (package for package in PACKAGES if package.packed.name == "studio.zip")
    assert studio.packed.stat().st_size < 250_000


def test_every_package_of_the_page_runs_on_the_oldest_node() -> None:
    """A newer Node.js on a developer's machine hides one that does not."""
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text())["packages"]
    (oldest,) = re.findall(r"^>=(\d+)", lock[""]["engines"]["node"])
    for name, package in lock.items():
        accepted = package.get("engines", {}).get("node", ">=0")
        majors = re.findall(r"(\^|>=) ?v?(\d+)", accepted)
        fits = (n == oldest if sign == "^" else int(n) <= int(oldest) for sign, n in majors)
        assert any(fits), f"{name} needs Node.js {accepted}"


@EACH
def test_no_folder_of_the_builder_is_in_the_page(package: Package) -> None:
    """The same sources give the same bytes in every folder, with the pinned tools."""
    for name, content in packed_files(package).items():
        found = re.findall(rb"/(?:home|root|work|tmp|Users)/[\w./-]+", content)
        assert not found, f"{name}: {found[:3]}"


def test_a_changed_source_and_another_page_are_named(tmp_path: Path) -> None:
    """By their files."""
    package = Package(
        tmp_path / "build" / "page", ("web/src/**/*",), tmp_path / "page.zip", tmp_path
    )
    source, built = tmp_path / "web" / "src" / "main.ts", tmp_path / "build" / "page" / "main.js"
    for path in (source, built):
        path.parent.mkdir(parents=True)
        path.write_text("1")
    package.pack(["rustc 1"])
    before = package.packed.read_bytes()
    package.pack(["rustc 1"])
    assert package.packed.read_bytes() == before
    assert (package.stale(), package.different()) == ([], [])
    source.write_text("2")
    built.write_text("2")
    assert (package.stale(), package.different()) == (["web/src/main.ts"], ["main.js"])
