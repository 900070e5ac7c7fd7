# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""An image as plain bytes in the order of the memory, which the loaders of a real brick take."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ravenbrick.errors import ImageFileError
from ravenbrick.image.elf import FLASH, REGIONS, ElfImage

__all__ = ["FlatImage", "flat_flash_file", "flat_image"]

_GAP = b"\xff"


@dataclass(frozen=True)
class FlatImage:
    """Bytes from `address` on; the processor begins at `entry`."""

    content: bytes
    address: int
    entry: int


def flat_image(image: ElfImage) -> FlatImage:
    """The loaded bytes of an image from the beginning of its region; gaps are as erased flash.

    Raises `ImageFileError` when a part lies outside the region that a loader may write.
    """
    region = REGIONS[image.kind]
    parts = image.loaded_parts()
    end = region.begin
    for address, data in parts:
        if not region.begin <= address <= address + len(data) <= region.end:
            raise ImageFileError(
                f"{image.path}: {len(data)} bytes at 0x{address:08X} are outside the {region.name} "
                f"(0x{region.begin:08X} to 0x{region.end - 1:08X}); link it with the project's own "
                "linker script"
            )
        end = max(end, address + len(data))
    content = bytearray(_GAP * (end - region.begin))
    for address, data in parts:
        place = address - region.begin
        content[place : place + len(data)] = data
    return FlatImage(bytes(content), region.begin, image.entry)


def flat_flash_file(path: Path) -> FlatImage:
    """A file with the content of the flash, such as LEGO's firmware; raises `ImageFileError`."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ImageFileError(f"{path}: cannot be read ({error.strerror})") from None
    if content[:4] == b"\x7fELF" or not 1024 <= len(content) <= FLASH.size:
        raise ImageFileError(
            f"{path}: is not the content of a brick's flash; expected a plain file of 1,024 to "
            f"{FLASH.size:,} bytes, as firmware is published"
        )
    return FlatImage(content, FLASH.begin, FLASH.begin)
