# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""An image for the brick: read, and refused with a reason when it cannot be one."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

from ravenbrick.errors import ImageFileError, shown_path
from ravenbrick.project.workspace import BuildKind

__all__ = [
    "DEBUGGING_BUILD",
    "REGIONS",
    "ElfImage",
    "ImageKind",
    "Section",
    "Symbol",
    "read_binary",
    "read_image",
]

ImageKind = Literal["ram", "flash"]
DEBUGGING_BUILD = "debugging build: its times are not those of the release image"
_DEBUG_MARK = "ravenbrick_debugging_build"  # tools/application.gpr
_BUILD = "build it with 'ravenbrick build'"
# Of the ELF specification, 32 bits. pyelftools is slow to load, and to read many entries.
_HEADER = struct.Struct("<16xHHIIIIIHHHHHH")
_PROGRAM_HEADER = struct.Struct("<6I8x")
_SECTION_HEADER = struct.Struct("<7I12x")
_SYMBOL = struct.Struct("<III2xH")
_LOADED, _SYMBOL_TABLES, _WITHOUT_CONTENT = 1, (2, 11), 8
_UNDEFINED = 0


@dataclass(frozen=True)
class Region:
    """A part of the brick's memory that an image may occupy (AT91SAM7S256 memory map)."""

    name: str
    begin: int
    end: int

    @property
    def size(self) -> int:
        """Bytes."""
        return self.end - self.begin


RAM = Region("RAM", 0x0020_0000, 0x0021_0000)
IMAGE_RAM = Region("RAM that the boot monitor leaves", 0x0020_2000, 0x0021_0000)
FLASH = Region("flash", 0x0010_0000, 0x0014_0000)
REGIONS = {"ram": IMAGE_RAM, "flash": FLASH}
LOAD_REGIONS = REGIONS | {"whole-ram": RAM}


@dataclass(frozen=True)
class Section:
    """A section that takes room on the brick."""

    name: str
    address: int
    size: int
    kind: Literal["text", "data", "bss"]


@dataclass(frozen=True)
class Symbol:
    """A named object or function."""

    address: int
    size: int


@dataclass(frozen=True)
class ElfImage:
    """A checked image; `content` is the whole file.

    A `bare` image has no headers: its bytes lie from `entry` on, and nothing has a name.
    """

    path: Path
    content: bytes
    kind: ImageKind
    entry: int
    sections: tuple[Section, ...]
    symbols: dict[str, Symbol]
    bare: bool = False

    @property
    def build(self) -> BuildKind:
        """The kind of build, by a symbol in the image itself."""
        return "debug" if _DEBUG_MARK in self.symbols else self.kind

    @property
    def digest(self) -> str:
        """SHA-256 of the file, as hexadecimal digits."""
        return hashlib.sha256(self.content).hexdigest()

    def size_of(self, kind: str) -> int:
        """Bytes of all sections of a kind."""
        return sum(section.size for section in self.sections if section.kind == kind)

    def bytes_at(self, address: int, size: int) -> bytes:
        """What the file loads at an address; fewer bytes where its segment ends."""
        for segment in _segments(self.content):
            offset = address - segment.address
            if 0 <= offset < segment.file_bytes:
                return _loaded_bytes(self.content, segment)[offset : offset + size]
        return b""

    def loaded_parts(self) -> list[tuple[int, bytes]]:
        """Load addresses and bytes of what is not empty."""
        segments = _segments(self.content)
        parts = ((found.load_address, _loaded_bytes(self.content, found)) for found in segments)
        return [part for part in parts if part[1]]

    def task_objects(self) -> dict[str, Symbol]:
        """Task name -> its object (control block and stack), for each single Ada task.

        Under the Ravenscar profile GNAT gives tasks no image, but the object of a task `t` of the
        package `p` is the symbol `p__t`, and its body `p__tTKB`.
        """
        return {
            name.rpartition("__")[2]: symbol
            for name, symbol in sorted(self.symbols.items())
            if symbol.size and f"{name}TKB" in self.symbols
        }


def _refuse(path: Path, problem: str, advice: str = _BUILD) -> ImageFileError:
    return ImageFileError(f"{shown_path(path)}: {problem}; {advice}")


def _check_header(path: Path, content: bytes) -> None:
    if content[:4] != b"\x7fELF":
        raise _refuse(path, "is not an ELF file (the first bytes are not 7F 45 4C 46)")
    if len(content) < 52:
        raise _refuse(path, f"is truncated: {len(content)} bytes, the header alone has 52")
    if content[4:6] != b"\x01\x01":
        raise _refuse(path, "is not a 32-bit little-endian ELF file, as the brick needs")
    header = _header(content)
    if header.machine != 40:
        raise _refuse(path, f"is for machine {header.machine}, not for ARM (40)")
    if header.kind != 2:
        raise _refuse(path, "is not an executable image; link it first")
    tables = (
        (header.programs, header.program_size, header.program_count, _PROGRAM_HEADER),
        (header.sections, header.section_size, header.section_count, _SECTION_HEADER),
    )
    needed = max(begin + size * count for begin, size, count, _ in tables)
    if needed > len(content):
        raise _refuse(path, f"is truncated: {len(content)} of at least {needed} bytes")
    if any(count and size != layout.size for _, size, count, layout in tables):
        raise _refuse(path, "is damaged (the size of an entry in its tables)")


class _Header(NamedTuple):
    kind: int
    machine: int
    version: int
    entry: int
    programs: int
    sections: int
    flags: int
    size: int
    program_size: int
    program_count: int
    section_size: int
    section_count: int
    names: int


class _Segment(NamedTuple):
    kind: int
    offset: int
    address: int
    load_address: int
    file_bytes: int
    memory_bytes: int


class _SectionHeader(NamedTuple):
    name: int
    kind: int
    flags: int
    address: int
    offset: int
    size: int
    link: int


def _header(content: bytes) -> _Header:
    return _Header(*_HEADER.unpack_from(content))


def _rows(layout: struct.Struct, content: bytes, begin: int, count: int) -> Iterator[Any]:
    return layout.iter_unpack(content[begin : begin + count * layout.size])


def _segments(content: bytes) -> list[_Segment]:
    """What is loaded, of a file whose header was checked."""
    header = _header(content)
    rows = _rows(_PROGRAM_HEADER, content, header.programs, header.program_count)
    found = (_Segment(*row) for row in rows)
    return [segment for segment in found if segment.kind == _LOADED]


def _loaded_bytes(content: bytes, segment: _Segment) -> bytes:
    return content[segment.offset : segment.offset + segment.file_bytes]


def _check_segments(path: Path, content: bytes) -> None:
    for segment in _segments(content):
        end = segment.offset + segment.file_bytes
        if end > len(content):
            raise _refuse(path, f"is truncated: {len(content)} of at least {end} bytes")
        if segment.memory_bytes == 0:
            continue
        _check_place(path, segment.address, segment.memory_bytes)
        _check_place(path, segment.load_address, segment.file_bytes)


def _check_place(path: Path, address: int, size: int) -> None:
    for region in (RAM, FLASH):
        if region.begin <= address < region.end:
            if address + size > region.end:
                over = address + size - region.end
                raise _refuse(
                    path,
                    f"is {over} bytes too large for the {region.name} "
                    f"(0x{region.begin:08X} to 0x{region.end - 1:08X})",
                    "shorten stacks or code, or build a flash image with '--image flash'",
                )
            return
    if size:
        raise _refuse(path, f"has a segment at 0x{address:08X}, where the brick has no memory")


def _section_headers(content: bytes, header: _Header) -> list[_SectionHeader]:
    rows = _rows(_SECTION_HEADER, content, header.sections, header.section_count)
    return [_SectionHeader(*row) for row in rows]


def _sections(headers: list[_SectionHeader], names: bytes) -> tuple[Section, ...]:
    found = []
    for section in headers:
        if not section.flags & 2 or section.size == 0:
            continue
        kind: Literal["text", "data", "bss"] = "data" if section.flags & 1 else "text"
        if section.kind == _WITHOUT_CONTENT:
            kind = "bss"
        name = _name_at(names, section.name).decode("utf-8", "replace")
        found.append(Section(name, section.address, section.size, kind))
    return tuple(sorted(found, key=lambda section: section.address))


def _content_of(content: bytes, section: _SectionHeader) -> bytes:
    return content[section.offset : section.offset + section.size]


def _name_at(names: bytes, begin: int) -> bytes:
    return names[begin : max(begin, names.find(b"\0", begin))]


def _symbols(content: bytes, headers: list[_SectionHeader]) -> dict[str, Symbol]:
    found: dict[str, Symbol] = {}
    for table in headers:
        if table.kind in _SYMBOL_TABLES:
            names = _content_of(content, headers[table.link])
            found |= _defined(_content_of(content, table), names)
    return found


def _defined(table: bytes, names: bytes) -> dict[str, Symbol]:
    """The named symbols of a table."""
    found: dict[str, Symbol] = {}
    for begin, value, size, section in _SYMBOL.iter_unpack(table):
        name = _name_at(names, begin)
        if name and section != _UNDEFINED:
            found[name.decode("utf-8", "replace")] = Symbol(value, size)
    return found


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise _refuse(path, "there is no such image") from None
    except OSError as error:
        raise _refuse(path, f"cannot be read ({error.strerror})") from None


def read_binary(path: Path, place: str) -> ElfImage:
    """Read an image without headers, for the beginning of one of `LOAD_REGIONS`.

    Raises `ImageFileError` when it is empty or too large.
    """
    content, region = _content(path), LOAD_REGIONS[place]
    kind: ImageKind = "flash" if region is FLASH else "ram"
    if not 0 < len(content) <= region.size:
        raise ImageFileError(
            f"{path}: has {len(content)} bytes, expected 1 to {region.size} for {region.name}; "
            "give a raw binary image"
        )
    return ElfImage(path, content, kind, region.begin, (), {}, bare=True)


def read_image(path: Path) -> ElfImage:
    """Read and check an image; raises `ImageFileError` with what is wrong and what to do."""
    content = _content(path)
    _check_header(path, content)
    header = _header(content)
    _check_segments(path, content)
    try:
        headers = _section_headers(content, header)
        names = _content_of(content, headers[header.names]) if headers else b""
        sections, symbols = _sections(headers, names), _symbols(content, headers)
    except (IndexError, struct.error) as error:
        raise _refuse(path, f"is damaged ({type(error).__name__})") from None
    kind: ImageKind = "flash" if FLASH.begin <= header.entry < FLASH.end else "ram"
    return ElfImage(path, content, kind, header.entry, sections, symbols)
