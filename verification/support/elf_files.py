# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Small ARM executables, byte by byte (System V ABI, chapters 4 and 5)."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field

__all__ = ["RAM", "Elf", "make_elf"]

RAM = 0x0020_2000
HEADER, PROGRAM, SECTION, SYMBOL = 52, 32, 40, 16
CONTENT, SYMBOLS, STRINGS, NO_CONTENT = 1, 2, 3, 8
WRITE, CODE = 3, 6
ABSOLUTE = 0xFFF1


def _strings(names: list[str]) -> tuple[bytes, list[int]]:
    """A table of strings, and where each begins."""
    table, offsets = b"\0", []
    for name in names:
        offsets.append(len(table))
        table += name.encode() + b"\0"
    return table, offsets


@dataclass
class Elf:
    """Content at addresses, named sections, and symbols."""

    entry: int = RAM
    machine: int = 40
    segments: list[tuple[int, bytes, int]] = field(default_factory=list)
    sections: list[tuple[str, int, int, int, int]] = field(default_factory=list)
    symbols: list[tuple[str, int, int, bool]] = field(default_factory=list)

    def words(self, address: int, words: list[int]) -> Elf:
        """Add a segment."""
        return self.content(address, struct.pack(f"<{len(words)}I", *words))

    def content(self, address: int, content: bytes) -> Elf:
        """Add a segment."""
        self.segments.append((address, content, len(content)))
        return self

    def function(self, name: str, address: int) -> Elf:
        """Add a symbol of code."""
        self.symbols.append((name, address, 4, True))
        return self

    def object(self, name: str, address: int, size: int) -> Elf:
        """Add a symbol of data."""
        self.symbols.append((name, address, size, False))
        return self

    def build(self) -> bytes:
        """The file."""
        headers, contents = b"", b""
        at = HEADER + PROGRAM * len(self.segments)
        offsets = []
        for address, content, size in self.segments:
            offset = at + len(contents)
            offsets.append((address, offset))
            headers += struct.pack("<8I", 1, offset, address, address, len(content), size, 7, 4)
            contents += content
        strings, names_at = _strings([name for name, *_ in self.symbols])
        table = bytes(SYMBOL)
        for (_, address, size, code), name_at in zip(self.symbols, names_at, strict=True):
            kind = 0x12 if code else 0x11
            table += struct.pack("<3I2BH", name_at, address, size, kind, 0, ABSOLUTE)
        rows = [
            (name, kind, flags, address, offset + address - begin, size, 0)
            for name, kind, flags, address, size in self.sections
            for begin, offset in offsets[:1]
        ]
        tables = ((".symtab", SYMBOLS, table), (".strtab", STRINGS, strings))
        section_names = [row[0] for row in rows] + [".symtab", ".strtab", ".shstrtab"]
        names, section_names_at = _strings(section_names)
        for name, kind, content in (*tables, (".shstrtab", STRINGS, names)):
            rows.append((name, kind, 0, 0, at + len(contents), len(content), kind == SYMBOLS))
            contents += content
        sections = bytes(SECTION)
        for name_at, (_, kind, flags, address, offset, size, symbols) in zip(
            section_names_at, rows, strict=True
        ):
            rest = (len(rows) - 1, 1, 4, SYMBOL) if symbols else (0, 0, 1, 0)
            sections += struct.pack("<10I", name_at, kind, flags, address, offset, size, *rest)
        count = len(rows) + 1
        header = b"\x7fELF\1\1\1" + bytes(9) + struct.pack("<2H", 2, self.machine)
        header += struct.pack("<5I", 1, self.entry, HEADER, at + len(contents), 0x0500_0000)
        header += struct.pack("<6H", HEADER, PROGRAM, len(self.segments), SECTION, count, count - 1)
        return header + headers + contents + sections


def make_elf(
    *,
    base: int = RAM,
    text_size: int = 64,
    data_size: int = 16,
    bss_size: int = 128,
    symbols: tuple[str, ...] = (
        "vehicle_setpoint_left",
        "vehicle_setpoint_right",
        "nxt__fonts__shapes",
    ),
    machine: int = 40,
) -> bytes:
    """An executable with .text, .data, .bss of zeros and named words in .bss."""
    data_at = base + text_size
    bss_at = data_at + data_size
    size = text_size + data_size
    elf = Elf(base, machine, segments=[(base, bytes(size), size + bss_size)])
    elf.sections = [
        (".text", CONTENT, CODE, base, text_size),
        (".data", CONTENT, WRITE, data_at, data_size),
        (".bss", NO_CONTENT, WRITE, bss_at, bss_size),
    ]
    for index, name in enumerate(symbols):
        elf.object(name, bss_at + 4 * index, 4)
    return elf.build()
