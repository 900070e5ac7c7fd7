# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Images of other firmware families on the virtual brick: what the LCD shows.

None of them may be kept in the repository: each is looked for where its environment variable
says. `python -m verification.firmware.images` runs those that are there and writes
`images.json`, in which one that is absent keeps what was seen of it last, and from it
docs/reference/firmware-images.md with its pictures.
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

from tools.docs import tables
from tools.docs.pictures.lcd import WIDTH
from verification.support.paths import ROOT

RESULTS = ROOT / "verification" / "firmware" / "images.json"
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
    """A kind of firmware; `variables` name the files it needs.

    `shows` is in words what somebody found who looked at the picture. `picture` is its digest where
    every image of the family shows the same.
    """

    name: str
    variables: tuple[str, ...]
    source: str
    shows: str
    run_ms: int
    picture: str | None = None
    in_ram: bool = False


MENU = "LEGO's menu: *My Files*, Bluetooth, the brick's name, USB, battery"
FAMILIES = (
    Family(
        "LEGO 1.29.2",
        ("RAVENBRICK_NXT_FIRMWARE",),
        "Debian package nxt-firmware 1.29.2-1",
        MENU,
        7_000,
    ),
    Family(
        "NBC/NXC enhanced firmware 1.32",
        ("RAVENBRICK_NBC_FIRMWARE",),
        "lms_arm_nbcnxc_132_20130303_2051.rfw of BricxCC, also in nxtOSEK's repository",
        MENU,
        7_000,
    ),
    Family(
        "leJOS NXJ",
        ("RAVENBRICK_LEJOS_VM", "RAVENBRICK_LEJOS_MENU"),
        "lejos_nxt_rom.bin and StartUpText.bin of the leJOS repository (snapshot/bin)",
        "its menu: battery, the brick's name from the Bluetooth module, *Run Default*, five icons",
        4_000,
    ),
    Family(
        "nxtOSEK",
        ("RAVENBRICK_NXTOSEK",),
        "helloworld_ram.bin of nxtOSEK's C++ samples",
        "its splash screen, white on black",
        2_000,
        in_ram=True,
    ),
    Family(
        "NxOS base",
        ("RAVENBRICK_NXOS",),
        "danderson/nxos bbed11a, a ROM kernel whose program calls `tests_display` of its test"
        " system, built from its sources; with GCC 12 the received frame, the stack and the end of"
        " the cleared memory had to be aligned to words",
        "*Display test* and the character set, after its tones",
        4_000,
        picture="4de6c3dc48267423",
    ),
    Family(
        "Pybricks",
        ("RAVENBRICK_PYBRICKS",),
        "firmware-base.bin in build/nxt.zip of the npm package @pybricks/firmware 7.28.0, an"
        " official build of 4.0.0b5",
        "its mascot",
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


def lejos_flash(machine: bytes, menu: bytes) -> bytes:
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
    return lejos_flash(*files) if len(files) > 1 else files[0]


def boot(family: Family, image: bytes) -> tuple[Any, Any]:
    """The brick after its time, and its stop."""
    address = USER_RAM if family.in_ram else FLASH
    brick = virtual_brick.VirtualBrick.from_binary(json.dumps(CONFIGURATION), image, address)
    return brick, brick.run_until(family.run_ms * CYCLES_PER_MS)


def picture(brick: Any) -> list[str]:
    """The LCD, line by line, `#` for a dark pixel."""
    pixels = brick.lcd()
    lines = (pixels[at : at + WIDTH] for at in range(0, len(pixels), WIDTH))
    return ["".join("#" if pixel else " " for pixel in line).rstrip() for line in lines]


def digest(brick: Any) -> str:
    """Of the LCD's pixels below the status line, whose icons move."""
    return hashlib.sha256(brick.lcd()[1000:]).hexdigest()[:16]


def seen(family: Family) -> dict[str, Any]:
    """What the image did and showed, or why it was not run."""
    names = list(family.variables)
    about = {"name": family.name, "source": family.source, "variables": names}
    try:
        image = image_of(family)
    except ImageAbsentError as error:
        return {**about, "absent": str(error)}
    brick, stop = boot(family, image)
    return {
        **about,
        "bytes": len(image),
        "sha256": hashlib.sha256(image).hexdigest(),
        "run_ms": family.run_ms,
        "stop": stop.message or stop.reason,
        "shows": family.shows,
        "digest": digest(brick),
        "picture": picture(brick),
    }


def main() -> int:
    """Run what is there; results and page."""
    before = {row["name"]: row for row in json.loads(RESULTS.read_text())}
    rows = [seen(family) for family in FAMILIES]
    kept = [before.get(row["name"], row) if "absent" in row else row for row in rows]
    tables.write_rows(RESULTS, kept)
    return tables.main([])


if __name__ == "__main__":
    sys.exit(main())
