# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""An image for the brick: read, and refused with a reason when it cannot be one."""

from __future__ import annotations

import hashlib
import io
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ravenbrick.errors import ImageFileError, shown_path
from ravenbrick.project.workspace import BuildKind

if TYPE_CHECKING:
    from elftools.elf.elffile import ELFFile

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
_HEADER = struct.Struct("<16xHHIIIIIHHHHHH")
_SYMBOL = struct.Struct("<III2xH")
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
        from elftools.elf.elffile import ELFFile

        for segment in ELFFile(io.BytesIO(self.content)).iter_segments("PT_LOAD"):
            offset = address - segment["p_vaddr"]
            if 0 <= offset < segment["p_filesz"]:
                return bytes(segment.data()[offset : offset + size])
        return b""

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
    (kind, machine, _version, _entry, programs, sections, _flags, _size) = (
        fields := _HEADER.unpack_from(content)
    )[:8]
    program_size, program_count, section_size, section_count, _names = fields[8:]
    if machine != 40:
        raise _refuse(path, f"is for machine {machine}, not for ARM (40)")
    if kind != 2:
        raise _refuse(path, "is not an executable image; link it first")
    needed = max(programs + program_size * program_count, sections + section_size * section_count)
    if needed > len(content):
        raise _refuse(path, f"is truncated: {len(content)} of at least {needed} bytes")


def _check_segments(path: Path, elf: ELFFile, length: int) -> None:
    for segment in elf.iter_segments("PT_LOAD"):
        end = segment["p_offset"] + segment["p_filesz"]
        if end > length:
            raise _refuse(path, f"is truncated: {length} of at least {end} bytes")
        if segment["p_memsz"] == 0:
            continue
        for address, size in (
            (segment["p_vaddr"], segment["p_memsz"]),
            (segment["p_paddr"], segment["p_filesz"]),
        ):
            _check_place(path, address, size)


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


def _sections(elf: ELFFile) -> tuple[Section, ...]:
    found = []
    for section in elf.iter_sections():
        flags = section["sh_flags"]
        if not flags & 2 or section["sh_size"] == 0:
            continue
        kind: Literal["text", "data", "bss"] = "data" if flags & 1 else "text"
        if section["sh_type"] == "SHT_NOBITS":
            kind = "bss"
        found.append(Section(section.name, section["sh_addr"], section["sh_size"], kind))
    return tuple(sorted(found, key=lambda section: section.address))


def _symbols(elf: ELFFile) -> dict[str, Symbol]:
    from elftools.elf.sections import SymbolTableSection  # slow to load

    found: dict[str, Symbol] = {}
    for table in elf.iter_sections():
        if isinstance(table, SymbolTableSection):
            found |= _defined(table.data(), table.stringtable.data())
    return found


def _defined(table: bytes, names: bytes) -> dict[str, Symbol]:
    """The named symbols of a table: pyelftools takes ten times as long for its whole entries."""
    found: dict[str, Symbol] = {}
    for begin, value, size, section in _SYMBOL.iter_unpack(table):
        name = names[begin : max(begin, names.find(b"\0", begin))]
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
    from elftools.common.exceptions import ELFError  # slow to load
    from elftools.elf.elffile import ELFFile

    content = _content(path)
    _check_header(path, content)
    try:
        elf = ELFFile(io.BytesIO(content))
        _check_segments(path, elf, len(content))
        entry = elf["e_entry"]
        sections, symbols = _sections(elf), _symbols(elf)
    except (ELFError, ValueError, KeyError, AttributeError, struct.error) as error:
        raise _refuse(path, f"is damaged ({type(error).__name__})") from None
    kind: ImageKind = "flash" if FLASH.begin <= entry < FLASH.end else "ram"
    return ElfImage(path, content, kind, entry, sections, symbols)
