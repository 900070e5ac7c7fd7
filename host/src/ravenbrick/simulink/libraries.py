# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a model takes from other files: blocks of libraries, referenced models, functions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from ravenbrick.errors import DesignError
from ravenbrick.simulink.file import SimulinkBlock, SimulinkSystem, read_simulink

__all__ = ["Libraries", "tight"]

_SUFFIXES = (".slx", ".mdl")
_LARGEST_PROGRAM = 1 << 20
# Folders of classes and packages, and private ones: their functions have no plain name elsewhere.
_OWNED = re.compile(r"/(?:[@+][^/]*|private)(?:/|\Z)")


def tight(name: str) -> str:
    """A block's name with single blanks, as names are compared here."""
    return " ".join(name.split())


class Libraries:
    """Model files beside a model, and in folders given besides with all that is in them."""

    def __init__(self, model: Path, folders: Sequence[Path] = ()) -> None:
        self._model = model
        self._folders = tuple(folders)
        self._read: dict[str, SimulinkSystem | None] = {}
        self._programs: dict[str, str | None] = {}

    def _find(self, name: str, suffixes: Sequence[str] = _SUFFIXES) -> Path | None:
        own = [self._model.with_name(f"{name}{suffix}") for suffix in suffixes]
        found = [path for path in own if path.is_file()]
        for folder in self._folders:
            every = (path for suffix in suffixes for path in folder.rglob(f"{name}{suffix}"))
            found += sorted(p for p in every if not _OWNED.search(p.parent.as_posix()))
        return found[0] if found else None

    def program(self, name: str) -> str | None:
        """The text of the file of a function; None if there is no such file."""
        if name not in self._programs:
            path = self._find(name, (".m",)) if re.fullmatch(r"\w+", name) else None
            small = path is not None and path.stat().st_size <= _LARGEST_PROGRAM
            self._programs[name] = (
                path.read_text(encoding="utf-8", errors="replace") if path and small else None
            )
        return self._programs[name]

    def system(self, name: str) -> SimulinkSystem | None:
        """The root system of a model file; None if there is no such file, or it is damaged."""
        if name not in self._read:
            plain = re.fullmatch(r"[\w-]+", name)
            path = self._find(name) if plain else None
            try:
                self._read[name] = None if path is None else read_simulink(path)
            except DesignError:
                self._read[name] = None
        return self._read[name]

    def block(self, source: str, own: str) -> SimulinkBlock | None:
        """The block that a link names, as `library/system/block`; `own` is the library it is in."""
        parts = [tight(part.replace("\0", "/")) for part in source.replace("//", "\0").split("/")]
        name = own if parts[0] == "$bdroot" else parts[0]
        system = self.system(name)
        found: SimulinkBlock | None = None
        for part in parts[1:]:
            if system is None:
                return None
            found = next((b for b in system.blocks.values() if b.name == part), None)
            system = None if found is None else found.system
        return found
