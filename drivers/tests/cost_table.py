# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles that the drivers' operations and interrupts take, measured on the virtual brick.

`python -m drivers.tests.cost_table <elf of tests/costs> <file>` writes the table as Markdown.
"""

from __future__ import annotations

import bisect
import json
import struct
import sys
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path

import virtual_brick

from drivers.tests.observe import CLOCK_DENOMINATOR, CLOCK_NUMERATOR, Brick, bench

OPERATIONS = [
    "nothing",
    "`Motor_Encoders.Encoder_Count`",
    "`Motor_Encoders.Current`",
    "`Motor_Controls.Drive`",
    "`Touch_Sensors.Pressed`",
    "`AVR.Raw_Input`",
    "`Light_Sensors.Light_Value`",
    "`Light_Sensors.Enable_Floodlight`",
    "`Sound_Sensors.Sound_Level`",
    "`Battery.Voltage`",
    "`Display.Put_Noupdate`, 16 letters",
    "`Display.Put_Noupdate`, 6 digits",
    "`Display.Screen_Update`",
    "`Ultrasonic_Sensors.Measure`",
    "`Audio.Play_Tone`, 20 ms",
    "`Audio.Time_Remaining`",
    "nothing",
]
SOURCES = {2: "motor edges (PIOA)", 5: "display (SPI)", 8: "sound (SSC)", 9: "co-processor (TWI)"}
SOURCES |= {12: "alarm of the run-time (TC0)", 13: "sensor buses (TC1)"}
PERIOD_CYCLES = 100 * CLOCK_NUMERATOR // (CLOCK_DENOMINATOR * 1000)
END_MS = 2_500
MAIN, LINK = 0, 1
MASK_SYMBOL = "ravenbrick__interrupts__masked"
STEP_CYCLES = 4
ACTIVE_MS = 1.0

Span = tuple[int, int]


@dataclass(frozen=True)
class Operation:
    """Cycles of one operation: of its task, of interrupts it causes, longest masking."""

    name: str
    task: int
    interrupts: int
    masked: int


@dataclass(frozen=True)
class Interrupt:
    """Cycles of the handlers of one source."""

    name: str
    count: int
    mean: float
    longest: int


@dataclass(frozen=True)
class Run:
    """When threads and handlers had the processor; handlers without those they were held by."""

    threads: dict[int, list[Span]]
    handlers: list[tuple[int, int, int, int]]
    releases: list[int]


def start(elf: bytes) -> Brick:
    """A brick with a sensor of each kind and a motor that is turned."""
    kinds = ("touch", "light", "sound", "ultrasonic")
    sensors = {str(port): {"kind": kind} for port, kind in enumerate(kinds, 1)}
    brick = Brick(virtual_brick.VirtualBrick(json.dumps(bench() | {"sensors": sensors}), elf))
    brick.set(10, "motor.A.hand_angle", 6.0)
    return brick


def observe(brick: Brick) -> Run:
    """The run from its events. A handler is (start, end, source, cycles of its own)."""
    kinds = brick.device.event_kinds()
    threads: dict[int, list[Span]] = {}
    handlers: list[tuple[int, int, int, int]] = []
    nested: list[list[int]] = []
    releases = []
    running, since = -1, 0
    for at, kind, subject, value in struct.iter_unpack("<QIIq", brick.device.events()):
        name = kinds[kind]
        if name == "thread_running":
            threads.setdefault(running, []).append((since, at))
            running, since = subject, at
        elif name == "interrupt_entered":
            nested.append([at, subject, 0])
        elif name == "interrupt_left" and nested:
            began, source, inner = nested.pop()
            handlers.append((began, at, source, at - began - inner))
            if nested:
                nested[-1][2] += at - began
        elif name == "release" and subject == MAIN:
            releases.append(value)
    return Run(threads, sorted(handlers), releases)


def begun_in(run: Run, window: Span) -> list[tuple[int, int, int, int]]:
    """Handlers that begin in a window."""
    first = bisect.bisect_left(run.handlers, window[0], key=itemgetter(0))
    last = bisect.bisect_left(run.handlers, window[1], key=itemgetter(0))
    return run.handlers[first:last]


def thread_cycles(run: Run, thread: int, window: Span) -> int:
    """Cycles of a thread in a window without the handlers that interrupt it."""
    spans = run.threads[thread]
    first = bisect.bisect_right(spans, window[0], key=itemgetter(1))
    last = bisect.bisect_left(spans, window[1], key=itemgetter(0))
    spans = spans[first:last]
    total = sum(min(end, window[1]) - max(begin, window[0]) for begin, end in spans)
    for begin, end, _, own in begun_in(run, window):
        if any(a <= begin and end <= b for a, b in spans):
            total -= own
    return total


def handler_cycles(run: Run, window: Span, sources: set[int]) -> int:
    """Cycles of handlers of some sources that begin in a window."""
    return sum(own for _, _, source, own in begun_in(run, window) if source in sources)


def longest_masking(elf: bytes, window: Span) -> int:
    """Longest time in the begin of a window in which the kernel holds interrupts back."""
    brick = start(elf)
    device = brick.device
    device.run_until(window[0])
    address, size = device.symbol(MASK_SYMBOL)
    end = window[0] + brick.cycles(ACTIVE_MS)
    longest, since = 0, None
    while device.cycles < end:
        device.run_until(device.cycles + STEP_CYCLES)
        if int.from_bytes(device.read_memory(address, size), "little", signed=True) < 0:
            since = None
        else:
            since = device.cycles if since is None else since
            longest = max(longest, device.cycles - since)
    return longest


def windows(run: Run) -> list[Span]:
    """The period of each operation: the last release is that of the last one."""
    last = run.releases[-1]
    starts = [
        last - (len(OPERATIONS) - 1 - place) * PERIOD_CYCLES for place in range(len(OPERATIONS))
    ]
    return [(begin - 100, begin + PERIOD_CYCLES - 200) for begin in starts]


def measure(elf: bytes) -> tuple[list[Operation], list[Interrupt], int]:
    """Operations, interrupts and the longest job of the co-processor's task."""
    brick = start(elf)
    brick.run(END_MS)
    assert brick.integer("operations") == len(OPERATIONS)
    run = observe(brick)
    caused = {5, 8, 13}
    spans = windows(run)
    empty = thread_cycles(run, MAIN, spans[0])
    operations = [
        Operation(
            name,
            thread_cycles(run, MAIN, window) - empty,
            handler_cycles(run, window, caused),
            longest_masking(elf, window),
        )
        for name, window in zip(OPERATIONS, spans, strict=True)
    ]
    interrupts = []
    for source, name in SOURCES.items():
        own = [cycles for _, _, number, cycles in run.handlers if number == source]
        if own:
            interrupts.append(Interrupt(name, len(own), sum(own) / len(own), max(own)))
    periods = range(spans[0][0], spans[-1][0], PERIOD_CYCLES // 50)
    link = max(thread_cycles(run, LINK, (at, at + PERIOD_CYCLES // 50)) for at in periods)
    return operations, interrupts, link


def table(elf: bytes) -> str:
    """The page."""
    operations, interrupts, link = measure(elf)
    lines = [
        "# What the drivers cost",
        "",
        "Generated by `make -C drivers costs` from a run on the virtual brick; do not edit. All",
        "figures are cycles of the processor's 48.05 MHz clock, of one run of an image in RAM.",
        "",
        "| Operation | Task | Interrupts caused | Longest masking |",
        "|---|---:|---:|---:|",
    ]
    lines += [
        f"| {row.name} | {row.task} | {row.interrupts} | {row.masked} |" for row in operations[1:-1]
    ]
    lines += [
        "",
        "*Task*: processor time of the calling task beyond that of a job that does nothing.",
        "*Interrupts caused*: handlers of display, sound and sensor buses until the effect is",
        "over, at their own priorities. *Longest masking*: time for which interrupts of some",
        "priority wait because of a protected action, in the caller or beside it; the short",
        "sections with all interrupts off are not in it. No operation polls.",
        "",
        "| Interrupt | Count | Mean | Longest |",
        "|---|---:|---:|---:|",
    ]
    lines += [
        f"| {row.name} | {row.count} | {row.mean:.0f} | {row.longest} |" for row in interrupts
    ]
    lines += [
        "",
        "Handlers from their entry in the interrupt controller to its end, without those nested in",
        f"them. The task of the co-processor link takes at most {link} cycles in 2 ms.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    Path(sys.argv[2]).write_text(table(Path(sys.argv[1]).read_bytes()))
