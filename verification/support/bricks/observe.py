# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A virtual brick as tests see it: milliseconds, text on the display, motor commands."""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.catalogue import part_values
from ravenbrick.clock import MASTER_CLOCK

FONT_FILE = Path(__file__).resolve().parents[3] / "drivers" / "src" / "display" / "nxt-fonts.ads"
GLYPH = re.compile(r"'(.)' => \(((?:2#[01]{8}#(?:, )?){5})\)")

WIDTH, HEIGHT = 100, 64
COLUMNS, ROWS = 16, 8
CELL, MARGIN, GLYPH_WIDTH, ROW_HEIGHT = 6, 2, 5, 8

MOTORS = "ABC"
CLOCK_NUMERATOR, CLOCK_DENOMINATOR = MASTER_CLOCK.hertz.as_integer_ratio()

# The motor of the catalogue without dry friction and play: what it does can be computed.
NXT_MOTOR = {
    **part_values("motors", "nxt"),
    "coulomb_friction": 0.0,
    "static_friction": 0.0,
    "backlash": 0.0,
}

# Shares of red, green and blue light that a surface throws back.
SURFACES = {
    "black": (0.06, 0.06, 0.07),
    "blue": (0.12, 0.25, 0.55),
    "green": (0.15, 0.50, 0.25),
    "yellow": (0.90, 0.70, 0.20),
    "red": (0.75, 0.12, 0.12),
    "white": (0.95, 0.93, 0.90),
}


def bench() -> dict[str, Any]:
    """Three motors of the NXT set, A held by hand, B and C free; a touch sensor on port 1."""
    return {
        "seed": 1,
        "battery": battery(8.0),
        "motors": {
            "A": {"parameters": NXT_MOTOR, "held_by_hand": True, "hand_rate": 4.0},
            "B": {"parameters": NXT_MOTOR},
            "C": {"parameters": NXT_MOTOR},
        },
        "body": {"kind": "bench"},
        "sensors": {"1": {"kind": "touch"}},
    }


def battery(volts: float) -> dict[str, Any]:
    """A rechargeable pack without internal resistance."""
    return {"kind": "li_ion", "voltage": volts, "internal_resistance": 0.0}


def read_font() -> dict[tuple[int, ...], str]:
    """The letter of each shape: five columns, lowest bit on top."""
    shapes = {}
    for letter, columns in GLYPH.findall(FONT_FILE.read_text()):
        shape = tuple(int(bits, 2) for bits in re.findall(r"2#([01]{8})#", columns))
        shapes[shape] = letter
    return shapes


FONT = read_font()


@dataclass(frozen=True)
class MotorCommand:
    """A command of the co-processor to a motor: duty cycle (%), and whether it shorts windings."""

    at_ms: float
    motor: str
    duty: int
    brake: bool


class Brick:
    """A virtual brick and what a test asks of it."""

    def __init__(self, device: Any) -> None:
        self.device = device

    def cycles(self, ms: float) -> int:
        """The first cycle at or after an instant."""
        return -(-round(ms * 1000) * CLOCK_NUMERATOR // (CLOCK_DENOMINATOR * 1_000_000))

    def run(self, until_ms: float) -> Any:
        """Run to an instant and expect to get there."""
        stop = self.device.run_until(self.cycles(until_ms))
        assert stop.reason == "reached", f"{stop.reason} at cycle {stop.at_cycles}: {stop.message}"

    def run_to_end(self, until_ms: float) -> Any:
        """Run to an instant or to the end before; returns why it stopped."""
        return self.device.run_until(self.cycles(until_ms))

    def set(self, at_ms: float, name: str, value: float) -> None:
        """Let an input change at an instant."""
        self.device.schedule_input(self.cycles(at_ms), name, value)

    def integer(self, symbol: str) -> int:
        """A 32-bit signed object."""
        return self.integers(symbol)[0]

    def integers(self, symbol: str) -> list[int]:
        """An array of 32-bit signed objects."""
        data = self.bytes(symbol)
        return list(struct.unpack(f"<{len(data) // 4}i", data))

    def number(self, symbol: str) -> float:
        """A single-precision object."""
        return float(struct.unpack("<f", self.bytes(symbol))[0])

    def bytes(self, symbol: str) -> bytes:
        """The memory of an object."""
        address, size = self.device.symbol(symbol)
        return bytes(self.device.read_memory(address, size))

    def picture(self) -> list[str]:
        """The display, one string per line of pixels: '#' dark, '.' clear."""
        pixels = self.device.lcd()
        lines = [pixels[line * WIDTH : (line + 1) * WIDTH] for line in range(HEIGHT)]
        return ["".join("#" if pixel else "." for pixel in line) for line in lines]

    def text(self) -> list[str]:
        """The display as eight rows of letters; '?' for what is not a letter."""
        pixels = self.device.lcd()
        return [
            "".join(_letter(pixels, row, column) for column in range(COLUMNS)).rstrip()
            for row in range(ROWS)
        ]

    def motor_commands(self) -> list[MotorCommand]:
        """Every command so far."""
        kinds = {name: kind for kind, name in self.device.event_kinds().items()}
        commands = []
        for at, kind, subject, value in struct.iter_unpack("<QIIq", self.device.events()):
            if kind == kinds["motor_command"]:
                ms = at * 1000 * CLOCK_DENOMINATOR / CLOCK_NUMERATOR
                duty = (value + 128) % 256 - 128
                commands.append(MotorCommand(ms, MOTORS[subject], duty, bool(value & 0x100)))
        return commands

    def motors(self, at_ms: float) -> dict[str, tuple[int, bool]]:
        """Duty cycle and brake of each motor at an instant; the co-processor begins with brakes."""
        return {motor: (0, True) for motor in MOTORS} | {
            command.motor: (command.duty, command.brake)
            for command in self.motor_commands()
            if command.at_ms < at_ms
        }


def _letter(pixels: bytes, row: int, column: int) -> str:
    left, top = MARGIN + CELL * column, ROW_HEIGHT * row
    shape = tuple(
        sum(pixels[(top + bit) * WIDTH + left + part] << bit for bit in range(ROW_HEIGHT))
        for part in range(GLYPH_WIDTH)
    )
    return FONT.get(shape, "?")
