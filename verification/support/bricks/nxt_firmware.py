# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The brick's own firmware 1.29 (Debian package `nxt-firmware`) on the virtual brick."""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import virtual_brick
from ravenbrick.clock import MASTER_CLOCK

from verification.support.bricks.observe import NXT_MOTOR
from verification.support.elf_files import Elf

IMAGE = Path("/usr/share/nxt-firmware/nxt_firmware.bin")
FLASH = 0x0010_0000
COMPUTER = "00:1A:7D:00:00:01"
MENU_MS = 6_000
CONFIGURATION: dict[str, Any] = {
    "battery": {"kind": "aa", "voltage": 8.0},
    "motors": {port: {"parameters": NXT_MOTOR} for port in "ABC"},
    "sensors": {"1": {"kind": "touch"}},
    "bluetooth": {
        "address": "00:16:53:0A:0B:0C",
        "name": "Rover",
        "known": [{"address": COMPUTER, "name": "computer"}],
    },
}


def firmware_brick(**changes: Any) -> Any:
    """A brick with the firmware, just switched on; skips where the package is absent."""
    if not IMAGE.exists():
        pytest.skip(f"{IMAGE} is absent: install the Debian package nxt-firmware")
    elf = Elf(FLASH)
    elf.content(FLASH, IMAGE.read_bytes())
    return virtual_brick.VirtualBrick(json.dumps({**CONFIGURATION, **changes}), elf.build())


def run_ms(brick: Any, milliseconds: int) -> None:
    """Let time pass; the run must go on."""
    stop = brick.run_until(brick.cycles + MASTER_CLOCK.cycles_of_ms(milliseconds))
    assert stop.reason == "reached", stop.message


@cache
def _menu() -> Any:
    brick = firmware_brick()
    run_ms(brick, MENU_MS)
    return brick.snapshot()


def brick_at_the_menu() -> Any:
    """A brick whose firmware shows its menu; each caller has its own."""
    brick = firmware_brick()
    brick.restore(_menu())
    return brick


def encoder(brick: Any, port: str) -> float:
    """Tacho edges of a motor, at the last sample."""
    values = brick.signals()[f"motor.{port}.encoder"][1]
    return float(struct.unpack("<d", values[-8:])[0])


def picture(brick: Any) -> list[str]:
    """The LCD, two rows of pixels in a line of half-height blocks, without trailing blanks."""
    pixels = brick.lcd()
    rows = [pixels[100 * row : 100 * row + 100] for row in range(64)]
    blocks = {(0, 0): " ", (1, 0): "▀", (0, 1): "▄", (1, 1): "█"}
    lines = (
        "".join(blocks[pair] for pair in zip(upper, lower, strict=True))
        for upper, lower in zip(rows[::2], rows[1::2], strict=True)
    )
    return [line.rstrip() for line in lines]


def compile_nxc(program: str) -> bytes:
    """The bytecode of an NXC program; skips where `nbc` is absent."""
    if shutil.which("nbc") is None:
        pytest.skip("nbc is absent: install the Debian package nbc")
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "program.nxc"
        source.write_text(program)
        target = source.with_suffix(".rxe")
        command = ["nbc", "-v=128", f"-O={target}", str(source)]
        result = subprocess.run(command, capture_output=True, text=True)
        assert target.exists(), result.stdout + result.stderr
        return target.read_bytes()
