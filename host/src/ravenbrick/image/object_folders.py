# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Folders of objects that are compiled alike, and the drivers' objects that projects share.

What one project has compiled of the drivers, the next one begins with. gprbuild decides of each
unit whether it is still right, by the instants and checksums of sources in its ALI file.
"""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import tarfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.run_time import run_time_home
from ravenbrick.project.workspace import tree

__all__ = ["COMPILED_WITH", "archive_of", "keep_objects", "same_objects"]

COMPILED_WITH = "compiled-with.json"
KINDS = (".ali", ".o")
# Only by its package Builder does a project change how units of other projects are compiled.
_BUILDER = re.compile(r"\bbuilder\b", re.IGNORECASE)
_NAMES_EXECUTABLES = re.compile(
    r"\bpackage\s+builder\s+is(\s*for\s+executable\s*\([^)]*\)\s*use\s[^;]*;)*\s*end\s+builder\b",
    re.IGNORECASE,
)


def archive_of(settings: Settings, project_files: Iterable[Path]) -> Path | None:
    """The archive of the drivers' objects; None for a build that may compile them otherwise."""
    if settings.run_time or settings.configuration:
        return None
    ours = (tree() / "tools", tree() / "drivers")
    for file in project_files:
        if file.resolve().is_relative_to(ours[0]) or file.resolve().is_relative_to(ours[1]):
            continue
        text = file.read_text("utf-8", errors="replace")
        if len(_BUILDER.findall(text)) != 2 * len(_NAMES_EXECUTABLES.findall(text)):
            return None
    return run_time_home() / "drivers" / f"{settings.objects}.tar"


@contextmanager
def same_objects(
    folder: Path, choices: Mapping[str, Any], archive: Path | None = None
) -> Iterator[None]:
    """Objects in a folder are compiled by these choices, each whole; gprbuild would not notice.

    They are removed when others compiled them, or when whoever did was killed. Those of the archive
    then take their place.
    """
    record, text = folder / COMPILED_WITH, json.dumps(choices, sort_keys=True)
    if not record.is_file() or record.read_text("utf-8") != text:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for name, (content, instant) in _kept(archive, text).items():
            (folder / name).write_bytes(content)
            os.utime(folder / name, (instant, instant))
    record.unlink(missing_ok=True)
    yield
    record.write_text(text, encoding="utf-8")


def _kept(archive: Path | None, record: str) -> dict[str, tuple[bytes, int]]:
    """Objects and ALI files of an archive by name, each with its instant; none of other choices."""
    found: dict[str, tuple[bytes, int]] = {}
    with suppress(OSError, tarfile.TarError):
        if archive is not None:
            with tarfile.open(archive, "r:") as members:
                for member in members:
                    if stream := members.extractfile(member):
                        found[member.name] = (stream.read(), int(member.mtime))
    made_by, _instant = found.pop(COMPILED_WITH, (b"", 0))
    return found if made_by == record.encode() else {}


def keep_objects(folder: Path, archive: Path | None) -> None:
    """Add the objects of a folder to the archive, where they are whole and not yet in it."""
    record = folder / COMPILED_WITH
    if archive is None or not record.is_file():
        return
    text = record.read_text("utf-8")
    before = _kept(archive, text)
    objects = {
        file.name: (file.read_bytes(), int(file.stat().st_mtime))
        for file in folder.iterdir() if file.suffix in KINDS
    }  # fmt: skip
    if objects.items() <= before.items():
        return
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as made:
        content = {**before, **objects, COMPILED_WITH: (text.encode(), 0)}
        for name, (data, instant) in sorted(content.items()):
            member = tarfile.TarInfo(name)
            member.size, member.mtime = len(data), instant
            made.addfile(member, io.BytesIO(data))
    with suppress(OSError):
        atomic_write(archive, stream.getvalue())
