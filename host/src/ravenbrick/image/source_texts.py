# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Source files of an image, as its debug information names them."""

from __future__ import annotations

import io
import posixpath
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile

from ravenbrick.image.elf import ElfImage

__all__ = ["named_sources", "source_texts"]

SUFFIXES = (".adb", ".ads", ".c", ".h", ".S")


def _folders(header: Mapping[str, Any], home: str) -> list[str]:
    """By index in the line table (DWARF 5, section 6.2.4; before, 0 is the compiler's folder)."""
    named = [posixpath.join(home, name.decode()) for name in header["include_directory"]]
    return named if header["version"] >= 5 else [home, *named]


def named_sources(content: bytes) -> list[str]:
    """Paths of the files in the line tables of an ELF file; raises `ELFError` on damaged ones."""
    elf = ELFFile(io.BytesIO(content))
    if not elf.has_dwarf_info():
        return []
    dwarf = elf.get_dwarf_info()
    found: set[str] = set()
    for unit in dwarf.iter_CUs():
        program = dwarf.line_program_for_CU(unit)
        if program is None:
            continue
        home = unit.get_top_DIE().attributes.get("DW_AT_comp_dir")
        folders = _folders(program.header, "" if home is None else home.value.decode())
        for entry in program.header["file_entry"]:
            if entry.dir_index < len(folders):
                found.add(posixpath.join(folders[entry.dir_index], entry.name.decode()))
    return sorted(found)


def _below(named: str, root: Path) -> Path | None:
    """The file below a root folder that is meant: a tree may have been moved since the build."""
    _, below, rest = posixpath.normpath(named).rpartition(f"/{root.name}/")
    return (root / rest).resolve() if below else None


def source_texts(image: ElfImage, roots: Sequence[Path]) -> dict[str, str]:
    """Text of each source file below one of the root folders, by its path in the line tables."""
    try:
        named: Iterable[str] = named_sources(image.content)
    except (ELFError, ValueError, KeyError, AttributeError):
        return {}
    texts: dict[str, str] = {}
    folders = [root.resolve() for root in roots]
    for name in (name for name in named if name.endswith(SUFFIXES)):
        for file in (_below(name, folder) for folder in folders):
            if file and file.is_file() and any(file.is_relative_to(root) for root in folders):
                if file.suffix in SUFFIXES:
                    texts[name] = file.read_text(encoding="utf-8", errors="replace")
                break
    return texts
