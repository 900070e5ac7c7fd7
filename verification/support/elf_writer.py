# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A minimal writer of ELF executables for ARM (System V ABI, chapters 4 and 5)."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field

RAM = 0x0020_2000


@dataclass
class Elf:
    """Words at addresses, and symbols."""

    entry: int = RAM
    segments: list[tuple[int, bytes]] = field(default_factory=list)
    symbols: list[tuple[str, int, int, bool]] = field(default_factory=list)

    def words(self, address: int, words: list[int]) -> Elf:
        """Add a segment."""
        self.segments.append((address, struct.pack(f"<{len(words)}I", *words)))
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
        contents_at = 52 + 32 * len(self.segments)
        contents = b"".join(content for _, content in self.segments)
        table, strings = self._symbol_table()
        names = b"\0.symtab\0.strtab\0.shstrtab\0"
        table_at = contents_at + len(contents)
        strings_at = table_at + len(table)
        names_at = strings_at + len(strings)
        headers, offset = b"", contents_at
        for address, content in self.segments:
            size = len(content)
            headers += struct.pack("<8I", 1, offset, address, address, size, size, 7, 4)
            offset += size
        sections = bytes(40)
        sections += struct.pack("<10I", 1, 2, 0, 0, table_at, len(table), 2, 1, 4, 16)
        sections += struct.pack("<10I", 9, 3, 0, 0, strings_at, len(strings), 0, 0, 1, 0)
        sections += struct.pack("<10I", 17, 3, 0, 0, names_at, len(names), 0, 0, 1, 0)
        header = b"\x7fELF\1\1\1" + bytes(9) + struct.pack("<2H", 2, 40)
        header += struct.pack("<5I", 1, self.entry, 52, names_at + len(names), 0x0500_0000)
        header += struct.pack("<6H", 52, 32, len(self.segments), 40, 4, 3)
        return header + headers + contents + table + strings + names + sections

    def _symbol_table(self) -> tuple[bytes, bytes]:
        table, strings = bytes(16), b"\0"
        for name, address, size, code in self.symbols:
            kind = 0x12 if code else 0x11
            table += struct.pack("<3I2BH", len(strings), address, size, kind, 0, 0xFFF1)
            strings += name.encode() + b"\0"
        return table, strings
