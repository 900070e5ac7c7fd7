# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Images of other firmware families on the virtual brick: what the LCD shows.

None of them may be kept in the repository: each is looked for where its environment variable
says. `python -m conformance.firmware_images` writes the table `docs/reference/firmware-images.md`
of those that are there; one that is absent keeps what was seen of it last.
"""

from __future__ import annotations

import hashlib
import json
import os
import struct
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import virtual_brick

ROOT = Path(__file__).resolve().parent.parent
TABLE = ROOT / "docs" / "reference" / "firmware-images.md"
FLASH = 0x0010_0000
USER_RAM = 0x0020_2000
FLASH_BYTES = 0x4_0000
PAGE_BYTES = 256
CYCLES_PER_MS = 48_055
CONFIGURATION: dict[str, Any] = {
    "battery": {"kind": "aa", "voltage": 8.0},
    "bluetooth": {"address": "00:16:53:0A:0B:0C", "name": "Rover"},
}


@dataclass(frozen=True)
class Family:
    """A kind of firmware; `variables` name the files it needs."""

    name: str
    variables: tuple[str, ...]
    source: str
    run_ms: int
    in_ram: bool = False


FAMILIES = (
    Family(
        "LEGO 1.29.2",
        ("RAVENBRICK_NXT_FIRMWARE",),
        "Debian package nxt-firmware 1.29.2-1",
        7_000,
    ),
    Family(
        "NBC/NXC enhanced firmware 1.32",
        ("RAVENBRICK_NBC_FIRMWARE",),
        "lms_arm_nbcnxc_132_20130303_2051.rfw of BricxCC, also in nxtOSEK's repository",
        7_000,
    ),
    Family(
        "leJOS NXJ",
        ("RAVENBRICK_LEJOS_VM", "RAVENBRICK_LEJOS_MENU"),
        "lejos_nxt_rom.bin and StartUpText.bin of the leJOS repository (snapshot/bin)",
        4_000,
    ),
    Family(
        "nxtOSEK",
        ("RAVENBRICK_NXTOSEK",),
        "helloworld_ram.bin of nxtOSEK's C++ samples",
        2_000,
        in_ram=True,
    ),
    Family(
        "NxOS base",
        ("RAVENBRICK_NXOS",),
        "a ROM kernel of NxOS whose program shows the character set, built from its sources; with"
        " GCC 12 the received frame, stack and cleared memory had to be aligned to words",
        4_000,
    ),
    Family(
        "Pybricks",
        ("RAVENBRICK_PYBRICKS",),
        "firmware-base.bin for the NXT of pybricks-micropython, built from its sources with"
        " upstream MicroPython 1.26.1 in place of its fork of that version",
        8_000,
    ),
)
DEFAULTS = {"RAVENBRICK_NXT_FIRMWARE": "/usr/share/nxt-firmware/nxt_firmware.bin"}


class ImageAbsentError(Exception):
    """The variable is not set, or names no file."""


def _file(variable: str) -> bytes:
    path = os.environ.get(variable) or DEFAULTS.get(variable)
    if not path:
        raise ImageAbsentError(f"{variable} is not set")
    if not Path(path).is_file():
        raise ImageAbsentError(f"{variable}: no file {path}")
    return Path(path).read_bytes()


def _lejos(machine: bytes, menu: bytes) -> bytes:
    """Virtual machine, menu behind it and an empty directory, as its own tool flashes them."""
    start = -(-len(machine) // PAGE_BYTES) * PAGE_BYTES
    image = bytearray(b"\xff" * FLASH_BYTES)
    image[: len(machine)] = machine
    image[start : start + len(menu)] = menu
    mark = machine.index(b"MNUAMNULFLSP")
    image[mark : mark + 12] = struct.pack("<3I", FLASH + start, len(menu), 420)
    image[420 * PAGE_BYTES : 423 * PAGE_BYTES] = bytes(3 * PAGE_BYTES)
    return bytes(image)


def image_of(family: Family) -> bytes:
    """The bytes to load. Raises ImageAbsentError."""
    files = [_file(variable) for variable in family.variables]
    return _lejos(*files) if len(files) > 1 else files[0]


def boot(family: Family, image: bytes) -> tuple[Any, Any]:
    """The brick after its time, and its stop."""
    address = USER_RAM if family.in_ram else FLASH
    brick = virtual_brick.VirtualBrick.from_binary(json.dumps(CONFIGURATION), image, address)
    return brick, brick.run_until(family.run_ms * CYCLES_PER_MS)


def picture(brick: Any) -> str:
    """The LCD in Braille cells of 2 by 4 pixels."""
    pixels = brick.lcd()
    dots = ((0, 0, 1), (0, 1, 2), (0, 2, 4), (1, 0, 8), (1, 1, 16), (1, 2, 32), (0, 3, 64))
    dots += ((1, 3, 128),)

    def cell(column: int, row: int) -> str:
        bits = (bit for x, y, bit in dots if pixels[100 * (row + y) + column + x])
        return chr(0x2800 + sum(bits))

    rows = ("".join(cell(c, r) for c in range(0, 100, 2)) for r in range(0, 64, 4))
    return "\n".join(rows)


def digest(brick: Any) -> str:
    """Of the LCD's pixels below the status line, whose icons move."""
    return hashlib.sha256(brick.lcd()[1000:]).hexdigest()[:16]


def _seen_before(family: Family) -> list[str]:
    """The family's section of the present page, without its heading; empty when it was not run."""
    page = TABLE.read_text(encoding="utf-8") if TABLE.exists() else ""
    section = page.partition(f"## {family.name}\n")[2].partition("\n## ")[0].strip("\n")
    return section.split("\n") if "```" in section else []


def table() -> str:
    """The page; a family that was never run is named with the reason."""
    lines = [
        "<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->",
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        "# Firmware images on the virtual brick",
        "",
        "Generated by `python -m conformance.firmware_images`. Pictures are the LCD, eight pixels",
        "a character.",
    ]
    for family in FAMILIES:
        names = ", ".join(f"`{variable}`" for variable in family.variables)
        heading = ["", f"## {family.name}", ""]
        source = f"{family.source} ({names})."
        try:
            image = image_of(family)
        except ImageAbsentError as error:
            lines += heading + (_seen_before(family) or [source, "", f"Not run: {error}."])
            continue
        lines += [*heading, source]
        brick, stop = boot(family, image)
        sha = hashlib.sha256(image).hexdigest()
        lines += [
            "",
            f"{len(image):,} bytes, SHA-256 `{sha[:16]}…`; after {family.run_ms / 1000:g} s:"
            f" {stop.reason}{', ' + stop.message if stop.message else ''}.",
            f"Picture `{digest(brick)}`.",
            "",
            "```text",
            picture(brick),
            "```",
        ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    TABLE.write_text(table(), encoding="utf-8")
    sys.exit(0)
