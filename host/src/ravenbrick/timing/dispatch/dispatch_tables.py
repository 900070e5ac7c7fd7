# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Dispatch tables of GNAT in an image, in the layout of the run-time's package Ada.Tags."""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

__all__ = ["DispatchTables"]

ALLOCATED = 2
# Type_Specific_Data: depth, level, alignment, name, ..., interfaces, ..., tags of all ancestors
NAME, INTERFACES, ANCESTORS, INTERFACE_BYTES = 0x0C, 0x20, 0x28, 20
# Dispatch_Table_Wrapper, before the tag: size, kind, predefined operations, offset, type's data
SIZE, KIND, PREDEFINED, TYPE_DATA = -20, -16, -12, -4
RUN_TIME = {"ada", "system", "interfaces", "gnat", "ravenbrick"}
CONCURRENT = (3, 5)  # Tagged_Kind of protected and task types
# Primary_DT and Secondary_DT, with each Tagged_Kind
OF_TYPE, OF_INTERFACE = range(0x0001, 0x0601, 0x100), range(0x0002, 0x0602, 0x100)


@dataclass(frozen=True)
class _Type:
    """Names of a type and all its ancestors (None if not known), and its operations."""

    names: frozenset[str | None]
    operations: tuple[int, ...]


class DispatchTables:
    """All tables of an image."""

    def __init__(self, elf: Any) -> None:
        self.words: dict[int, int] = {}
        self._bytes: list[tuple[int, bytes]] = []
        self._interfaces: set[str | None] = set()
        for section in elf.iter_sections():
            if not section["sh_flags"] & ALLOCATED or section["sh_type"] != "SHT_PROGBITS":
                continue
            begin, content = section["sh_addr"], section.data()
            words = struct.unpack(f"<{len(content) // 4}I", content[: len(content) & ~3])
            self.words |= dict(zip(range(begin, begin + len(content), 4), words, strict=False))
            self._bytes.append((begin, content))
        self._types = [self._type(tag) for tag in self._tags()]
        # The table of a type for an interface does not say for which one.
        interfaces = frozenset(self._interfaces)
        self._types += [_Type(interfaces, self._operations(tag)) for tag in self._interface_tags()]

    def word(self, address: int) -> int:
        """A word of the image; 0 outside of it."""
        return self.words.get(address, 0)

    def _tags(self) -> Iterator[int]:
        """Tags: the type's data, which is named before a table, names this table first."""
        for address, word in self.words.items():
            tag = address - TYPE_DATA
            if self.words.get(word + ANCESTORS) == tag and self.word(tag + KIND) in OF_TYPE:
                yield tag

    def _interface_tags(self) -> Iterator[int]:
        for address, word in self.words.items():
            tag = address - KIND
            if word in OF_INTERFACE and self.word(tag + PREDEFINED) in self.words:
                yield tag

    def _name(self, tag: int) -> str | None:
        """Name of a type without that of its package; None if not known, or in the run-time, which
        may call its operations without being asked to."""
        address = self.word(self.word(tag + TYPE_DATA) + NAME)
        for begin, content in self._bytes:
            if begin <= address < begin + len(content):
                text = content[address - begin : content.find(b"\0", address - begin)]
                root, *_, name = text.decode("latin-1").lower().split(".") * 2
                return None if root in RUN_TIME else name or None
        return None

    def _type(self, tag: int) -> _Type:
        data = self.word(tag + TYPE_DATA)
        interfaces = self.word(data + INTERFACES)
        places = [interfaces + 4 + INTERFACE_BYTES * n for n in self._range(interfaces)]
        implemented = {self._name(self.word(place)) for place in places}
        self._interfaces |= implemented
        places = [data + ANCESTORS + 4 * n for n in self._range(data, 1)]
        family = {self._name(self.word(place)) for place in places}
        if self.word(tag + KIND) >> 8 in CONCURRENT:  # named after a record that stands for it
            family.add(None)
        return _Type(frozenset(family | implemented), self._operations(tag))

    def _range(self, address: int, more: int = 0) -> range:
        """Numbers of what a word counts; no more than the image has room for."""
        return range(min(self.word(address) + more, len(self.words)))

    def _operations(self, tag: int) -> tuple[int, ...]:
        return tuple(self.word(tag + 4 * number) for number in self._range(tag + SIZE))

    def operations(self, slot: int, names: Collection[str] | None) -> set[int]:
        """Operations with this number of all types with an ancestor of these names, if any."""
        near = [
            t
            for t in self._types
            if names is None or None in t.names or not t.names.isdisjoint(names)
        ]
        return {t.operations[slot] for t in near if slot < len(t.operations)} - {0}
