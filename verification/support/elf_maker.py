# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Small ARM images with chosen sizes, byte by byte."""

from __future__ import annotations

import struct

__all__ = ["make_elf"]

HEADER, PROGRAM, SECTION, SYMBOL = 52, 32, 40, 16


def _strings(names: list[str]) -> tuple[bytes, dict[str, int]]:
    table, offsets = b"\0", {}
    for name in names:
        offsets[name] = len(table)
        table += name.encode() + b"\0"
    return table, offsets


def make_elf(
    *,
    base: int = 0x0020_2000,
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
    """An executable with .text, .data, .bss and named words in .bss."""
    text_at, data_at = base, base + text_size
    bss_at = data_at + data_size
    names, name_at = _strings([".text", ".data", ".bss", ".symtab", ".strtab", ".shstrtab"])
    strings, string_at = _strings(list(symbols))
    table = bytes(SYMBOL)
    for index, symbol in enumerate(symbols):
        table += struct.pack("<IIIBBH", string_at[symbol], bss_at + 4 * index, 4, 0x11, 0, 3)
    content_at = HEADER + PROGRAM
    symbols_at = content_at + text_size + data_size
    strings_at = symbols_at + len(table)
    names_at = strings_at + len(strings)
    sections_at = names_at + len(names)
    program = struct.pack(
        "<8I",
        1,
        content_at,
        base,
        base,
        text_size + data_size,
        text_size + data_size + bss_size,
        7,
        4,
    )
    sections = [
        bytes(SECTION),
        struct.pack("<10I", name_at[".text"], 1, 6, text_at, content_at, text_size, 0, 0, 4, 0),
        struct.pack(
            "<10I", name_at[".data"], 1, 3, data_at, content_at + text_size, data_size, 0, 0, 4, 0
        ),
        struct.pack("<10I", name_at[".bss"], 8, 3, bss_at, symbols_at, bss_size, 0, 0, 4, 0),
        struct.pack("<10I", name_at[".symtab"], 2, 0, 0, symbols_at, len(table), 5, 1, 4, SYMBOL),
        struct.pack("<10I", name_at[".strtab"], 3, 0, 0, strings_at, len(strings), 0, 0, 1, 0),
        struct.pack("<10I", name_at[".shstrtab"], 3, 0, 0, names_at, len(names), 0, 0, 1, 0),
    ]
    header = struct.pack(
        "<16sHHIIIIIHHHHHH",
        b"\x7fELF\x01\x01\x01" + bytes(9),
        2,
        machine,
        1,
        base,
        HEADER,
        sections_at,
        0,
        HEADER,
        PROGRAM,
        1,
        SECTION,
        len(sections),
        6,
    )
    content = bytes(text_size + data_size)
    return header + program + content + table + strings + names + b"".join(sections)
