# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Build manifests: the files and settings a product was built from, and whether they changed."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import shown_path
from ravenbrick.json_values import json_values

__all__ = ["BuildManifest", "file_digest"]

VERSION = 1
# A file that changed just before it was looked at may change again without another time stamp.
COARSE_NS = 100_000_000


def file_digest(path: str | Path) -> str:
    """SHA-256 of a file's content, in hexadecimal digits."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _stamp(path: str) -> list[int]:
    found = os.stat(path)
    return [found.st_size, found.st_mtime_ns, found.st_ctime_ns]


def _names(folder: str) -> list[str]:
    """Files of a folder that a compiler may read; none where there is no folder."""
    try:
        with os.scandir(folder) as entries:
            return sorted(
                e.name for e in entries if e.name[0] not in ".#" and e.name[-1] != "~"
                and e.is_file()
            )  # fmt: skip
    except OSError:
        return []


@dataclass
class BuildManifest:
    """Settings, the names in each folder of sources, and stamp and digest of each file."""

    settings: dict[str, Any]
    folders: dict[str, list[str]]
    files: dict[str, tuple[list[int], str]]
    version: int = VERSION

    @classmethod
    def now(
        cls, settings: dict[str, Any], folders: Iterable[Path], files: Iterable[Path]
    ) -> BuildManifest:
        """The present state; files that do not exist are recorded as missing."""
        found = {str(folder): _names(str(folder)) for folder in folders}
        manifest = cls(settings, found, {})
        for folder, names in found.items():
            for name in names:
                manifest.add(Path(folder, name))
        for file in files:
            manifest.add(file)
        return manifest

    def add(self, file: Path) -> None:
        """Add a file."""
        path = str(file)
        try:
            stamp = _stamp(path)
            if max(stamp[1:]) > time.time_ns() - COARSE_NS:
                stamp = [stamp[0], 0, 0]
            self.files[path] = (stamp, file_digest(path))
        except FileNotFoundError:
            self.files[path] = ([-1, 0, 0], "")

    @classmethod
    def read(cls, path: Path) -> BuildManifest | None:
        """The manifest in a file; None where there is none that can be read."""
        try:
            manifest = cls(**json_values(path.read_bytes()))
        except (OSError, ValueError, TypeError):
            return None
        return manifest if manifest.version == VERSION else None

    def write(self, path: Path) -> None:
        """Write the manifest; raises `OSError`."""
        atomic_write(path, json.dumps(asdict(self)) + "\n")

    def change(self, settings: dict[str, Any], file: Path | None = None) -> str | None:
        """What has changed, in words for the user; None for nothing.

        Stamps are looked at first, contents where they differ; `file` then gets the new stamps.
        """
        for name in {**self.settings, **settings}:
            if self.settings.get(name) != settings.get(name):
                return f"the setting '{name}'"
        for folder, names in self.folders.items():
            if _names(folder) != names:
                return shown_path(folder)
        renewed = False
        for path, (stamp, digest) in self.files.items():
            try:
                now = _stamp(path)
                if now == stamp:
                    continue
                if file_digest(path) != digest:
                    return shown_path(path)
            except OSError:
                if digest:
                    return shown_path(path)
                continue
            self.add(Path(path))
            renewed = renewed or self.files[path][0][1] != 0
        if renewed and file:
            with suppress(OSError):
                self.write(file)
        return None
