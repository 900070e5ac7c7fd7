# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A stand-in for the module `virtual_brick` with predefined results of runs.

Two cyclic tasks and a first-order response to a touch; no processor is emulated.
"""

from __future__ import annotations

import functools
import hashlib
import json
import math
import struct
from dataclasses import dataclass

from ravenbrick.brick.slices import run_until_picture
from ravenbrick.clock import MASTER_CLOCK

CLOCK = MASTER_CLOCK.hertz.as_integer_ratio()
HERTZ = CLOCK[0] / CLOCK[1]
MILLISECOND = HERTZ / 1000
DRAWN_CYCLES = round(5 * MILLISECOND)
RUNNING, RELEASE, COMPLETION, ENTERED, LEFT, DISPLAY, STOPPED, RESUMED = 1, 3, 4, 5, 6, 7, 10, 11
IDLE = 0xFFFF_FFFF
TIME_CONSTANT = 0.1
LINE = "vehicle.adb:12"
# Letter number n is drawn as the number n in its first column; a blank is blank.
FONT = b"".join(bytes([number, 0, 0, 0, 0]) for number in range(95))
SPEED = 4.0 * math.radians(116)


class ConfigurationError(ValueError):
    """As the real module's."""


class ImageError(ValueError):
    """As the real module's."""


class InputError(ValueError):
    """As the real module's."""


@dataclass(frozen=True)
class Stop:
    """As the real module's."""

    reason: str
    at_cycles: int
    message: str


@dataclass(frozen=True)
class Thread:
    """As the real module's."""

    name: str
    base_priority: int
    stack_base: int
    stack_size: int
    stack_used: int
    address: int


THREADS = [
    Thread("display_task", 1, 0x20A000, 4096, 700, 0x209000),
    Thread("control_task", 2, 0x20B000, 4096, 900, 0x209100),
    Thread("coprocessor_task", 30, 0x20C000, 1024, 400, 0x209200),
]
# Index in THREADS, period (ms), first release (ms), release latency and execution time (cycles).
JOBS = [(2, 2, 10.0, 100, 9_000), (1, 4, 10.5, 150, 20_000), (0, 500, 11.5, 200, 4_000)]


@functools.cache
def _picture() -> bytes:
    """The text of `LINE` in the first line, in the letters of `FONT`."""
    rows = [[0] * 100 for _ in range(64)]
    for place, letter in enumerate(LINE):
        glyph = FONT[5 * (ord(letter) - 32) :][:5]
        for column in range(5):
            for row in range(8):
                rows[row][2 + 6 * place + column] = glyph[column] >> row & 1
    return b"".join(bytes(row) for row in rows)


class VirtualBrick:
    """As the real module's; `fault_ms` makes every run end in a fault at that instant."""

    fault_ms: int | None = None
    threads_unobserved: str | None = None
    link_up_cycles = 0

    def __init__(self, configuration_json: str, elf: bytes) -> None:
        self._configuration = json.loads(configuration_json)
        self._elf = elf
        self._inputs: list[tuple[int, str, float]] = []
        self._probes: list[str] = []
        self.cycles = 0
        self.clock_hz = CLOCK

    def schedule_input(self, at_cycles: int, name: str, value: float) -> None:
        if name.startswith("unheard"):
            raise InputError(f"unknown input {name}")
        self._inputs.append((at_cycles, name, value))

    def add_probe(self, symbol: str, kind: str) -> None:
        self._probes.append(symbol)

    def run_until(self, cycles: int) -> Stop:
        fault = self.fault_ms
        if fault is not None and cycles > fault * MILLISECOND:
            self.cycles = int(fault * MILLISECOND)
            return Stop("fault", self.cycles, "read of the unmodelled register 0xFFFA0000")
        off = [at for at, name, value in self._inputs if name == "button.orange" and value]
        if off and off[0] + 1000 <= cycles:
            self.cycles = off[0] + 1000
            return Stop("power_off", self.cycles, "")
        self.cycles = cycles
        return Stop("reached", cycles, "")

    def trace_calls(self, functions: list[str]) -> None:
        """Nothing is called."""

    def traced_calls(self) -> list[object]:
        return []

    def raised_at(self) -> None:
        """No exception is raised."""

    def stack_overflows(self) -> list[str]:
        return []

    def run_until_picture(self, instants: list[int], first: int, end: int) -> tuple[Stop, int]:
        return run_until_picture(self, instants, first, end)

    @property
    def lcd_version(self) -> int:
        """Of the only picture that is drawn."""
        return int(self.cycles >= DRAWN_CYCLES)

    def lcd(self) -> bytes:
        """The text of `LINE` in the first line."""
        return _picture()

    def read_memory(self, address: int, length: int) -> bytes:
        return FONT[:length]

    def threads(self) -> list[Thread]:
        return list(THREADS)

    def events(self) -> bytes:
        records: list[tuple[int, int, int, int]] = []
        for thread, period, first, latency, execution in JOBS:
            number = 0
            while (at := round((first + number * period) * MILLISECOND)) < self.cycles:
                begin = at + latency
                end = begin + execution
                records += [
                    (at, RESUMED, 0, 0),
                    (at, RELEASE, thread, at),
                    (begin, RUNNING, thread, 0),
                    (end, COMPLETION, thread, at),
                    (end, RUNNING, IDLE, 0),
                    (end, STOPPED, 0, 0),
                ]
                number += 1
        drawn = (DRAWN_CYCLES, DISPLAY, 0, 1)
        records = [(0, STOPPED, 0, 0), drawn, *sorted(records, key=lambda record: record[0])]
        inside = [record for record in records if record[0] <= self.cycles]
        return b"".join(struct.pack("<QIIq", *record) for record in inside)

    def _touch(self) -> float:
        pressed = [at for at, name, value in self._inputs if name == "touch.1" and value]
        return pressed[0] / HERTZ if pressed else math.inf

    def signals(self) -> dict[str, tuple[bytes, bytes]]:
        period = self._configuration["signal_period_cycles"]
        instants = list(range(0, self.cycles + 1, period))
        begin = self._touch()
        bench = self._configuration["body"]["kind"] == "bench"
        open_loop = any(name == "button.left" for _, name, _ in self._inputs)
        columns: dict[str, list[float]] = {name: [] for name in ("x", "y", "heading")}
        motor: dict[str, list[float]] = {name: [] for name in ("encoder", "angular_velocity")}
        setpoint: list[float] = []
        for at in instants:
            after = max(at / HERTZ - begin, 0.0)
            decay = math.exp(-after / TIME_CONSTANT)
            angle = SPEED * (after - TIME_CONSTANT * (1 - decay))
            motor["encoder"].append(math.floor(math.degrees(angle)))
            motor["angular_velocity"].append(SPEED * (1 - decay) if after else 0.0)
            setpoint.append(4.0 if after > 0 else 0.0)
            columns["x"].append(0.028 * angle)
            columns["y"].append((0.05 if open_loop else 0.002) * 0.028 * angle)
            columns["heading"].append(0.0)
        named = {f"motor.{p}.{name}": values for p in "BC" for name, values in motor.items()}
        named |= {} if bench else {f"body.{name}": values for name, values in columns.items()}
        named |= {f"probe.{symbol}": setpoint for symbol in self._probes}
        cycles = struct.pack(f"<{len(instants)}Q", *instants)
        return {
            name: (cycles, struct.pack(f"<{len(values)}d", *values))
            for name, values in named.items()
        }

    def trace_digest(self) -> str:
        head = json.dumps([self._configuration, sorted(self._inputs)], sort_keys=True).encode()
        return hashlib.sha256(head + self.events() + self._elf).hexdigest()
