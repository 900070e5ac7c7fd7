# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles that the drivers' operations and interrupts take, measured on the virtual brick.

`python -m verification.benchmarks.driver_costs <folder of the test programs> <file>` writes the
table as
Markdown, and the figures as JSON beside it.
"""

from __future__ import annotations

import bisect
import io
import json
import struct
import sys
from collections.abc import Callable
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from typing import Any

import virtual_brick
from elftools.elf.elffile import ELFFile
from ravenbrick.brick.links.peers import BluetoothComputer
from ravenbrick.telemetry import Session

from verification.support.bricks.observe import CLOCK_DENOMINATOR, CLOCK_NUMERATOR, Brick, bench

COSTS = [
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
]
DISPLAY_MOTOR_COSTS = [
    "`Display.Put_At_Noupdate`, 16 letters",
    "`Display.Drawing.Draw_Line`, 100 pixels",
    "`Regulated_Motors.Turn_To`",
    "`RS485.Send`, 16 bytes",
    "`RS485.Receive`, 16 bytes",
    "`Parameters.Store.Load`",
]
DEVICE_COSTS = [
    "`Buttons.Current_Button`",
    "`Power.Last_Reset`",
    "`Watchdog.Restart`",
    "`Sensor_Ports.Current_State`",
    "`Sensor_Ports.Convert`",
    "`Color_Sensors.Measure`",
    "`Color_Sensors.Color_Of`",
    "`Parameters.Store.Save`",
    "`Brick_Name.Set_Name`",
    "`Brick_Name.Name`",
    "`Power.Reset_At_Brown_Out`",
]
LINE_COSTS = [
    "`Bluetooth.Poll`",
    "`Bluetooth.Send`, 64 bytes",
    "`Bluetooth.Receive`, 64 bytes",
    "",
    "`USB.Send`, 64 bytes",
    "`USB.Receive`, 64 bytes",
    "",
    "`Direct_Commands.Execute`, battery level",
    "`Direct_Commands.Tick`",
]
TELEMETRY_COSTS = [
    "`Telemetry.Publish`, 1 value",
    "`Telemetry.Publish`, 4 values",
    "`Telemetry.Publish`, 8 values",
    "`Telemetry.Current`",
]
TELEMETRY_PARTS = {
    "queue, names, protocol": ("nxt__telemetry__", "nxt__frames__"),
    "server of a program": ("cost_link__server__",),
    "driver of Bluetooth": ("nxt__bluetooth",),
}
SAMPLE_BYTES = 12
LINK_MS = 1_500
SOURCES = {
    2: "motor edges (PIOA)",
    5: "display (SPI)",
    6: "RS485 (USART0)",
    8: "sound (SSC)",
    9: "co-processor (TWI)",
    11: "USB (UDP)",
    12: "alarm of the run-time (TC0)",
    13: "sensor buses (TC1)",
    14: "colour sensors (TC2)",
}
CAUSED = {5, 6, 8, 11, 13, 14}
PERIOD_CYCLES = 100 * CLOCK_NUMERATOR // (CLOCK_DENOMINATOR * 1000)
TASKS = {"coprocessor_task": 2.0, "regulator_task": 4.0, "server_task": 10.0}
MAIN = 0
MASK_SYMBOL = "ravenbrick__interrupts__masked"
STEP_CYCLES = 4
ACTIVE_MS = 1.0

TELEMETRY = "telemetry_costs"
COMPUTER = "00:1A:7D:00:00:01"
RECEIVED = bytes(range(64))

Span = tuple[int, int]


@dataclass(frozen=True)
class Program:
    """A test program: its operations in order, between two empty jobs, what is plugged in, when the
    run ends."""

    name: str
    operations: list[str]
    sensors: dict[str, str]
    end_ms: float
    surround: Callable[[Brick], None] = lambda brick: None


@dataclass(frozen=True)
class Operation:
    """Cycles of one operation: of its task, of interrupts it causes, longest masking, and from its
    call to its return."""

    name: str
    task: int
    interrupts: int
    masked: int
    returns_after: int


@dataclass(frozen=True)
class Interrupt:
    """Cycles of the handlers of one source."""

    name: str
    count: int
    mean: float
    longest: int


@dataclass(frozen=True)
class Task:
    """Longest job of a driver's task, cycles, and its period, ms."""

    name: str
    period_ms: float
    longest: int


@dataclass(frozen=True)
class Run:
    """When threads and handlers had the processor; handlers without those they were held by."""

    threads: dict[int, list[Span]]
    handlers: list[tuple[int, int, int, int]]
    releases: list[int]


def connect(brick: Brick) -> None:
    """A Bluetooth computer and a USB host connect; both send 64 bytes before they are read."""
    device = brick.device
    device.bluetooth_send(0, COMPUTER, "in_range", name="computer")
    page = brick.cycles(1_800)
    device.bluetooth_send(page, COMPUTER, "page", name="computer", pin="1234")
    device.bluetooth_send(brick.cycles(3_250), COMPUTER, "data", RECEIVED)
    brick.set(0, "usb.plugged", 1)
    timeout = brick.cycles(1_000)
    transfers: list[tuple[float, str, int, bytes, int]] = [
        (300, "reset", 0, b"", 0),
        (350, "control", 0, bytes([0, 5, 5, 0, 0, 0, 0, 0]), 0),
        (400, "control", 0, bytes([0, 9, 1, 0, 0, 0, 0, 0]), 0),
        (3_520, "in", 2, b"", 64),
        (3_550, "out", 1, RECEIVED, 0),
    ]
    for number, (at_ms, kind, endpoint, data, length) in enumerate(transfers):
        at = brick.cycles(at_ms)
        device.usb_transfer(at, number, timeout, kind, endpoint, data, length)


def listen(brick: Brick) -> None:
    """A host listens to the brick's telemetry."""
    brick.run(LINK_MS)
    computer = BluetoothComputer(brick.device, pin="1234")
    computer.connect(timeout_ms=1000)
    brick.device.run_until(brick.device.cycles + brick.cycles(50))
    computer.write(Session().connected(0.0))


PROGRAMS = [
    Program(
        "costs",
        COSTS,
        {"1": "touch", "2": "light", "3": "sound", "4": "ultrasonic"},
        2_500,
        lambda brick: brick.set(10, "motor.A.hand_angle", 6.0),
    ),
    Program("display_motor_costs", DISPLAY_MOTOR_COSTS, {}, 2_500),
    Program("device_costs", DEVICE_COSTS, {"1": "color"}, 2_500),
    Program("line_costs", LINE_COSTS, {}, 4_500, connect),
    Program(TELEMETRY, TELEMETRY_COSTS, {}, 3_500, listen),
]


def start(program: Program, elf: bytes) -> Brick:
    """A brick with what a program needs around it."""
    sensors = {port: {"kind": kind} for port, kind in program.sensors.items()}
    brick = Brick(virtual_brick.VirtualBrick(json.dumps(bench() | {"sensors": sensors}), elf))
    program.surround(brick)
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


def last_instant(run: Run, thread: int, window: Span) -> int:
    """The end of the last span of a thread that begins in a window."""
    ends = [end for begin, end in run.threads[thread] if window[0] <= begin < window[1]]
    return max(ends, default=window[0])


def longest_masking(program: Program, elf: bytes, window: Span) -> int:
    """Longest time in the beginning of a window in which the kernel holds interrupts back."""
    brick = start(program, elf)
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


def windows(run: Run, count: int) -> list[Span]:
    """The period of each operation: the last release is that of the last one."""
    last = run.releases[-1]
    starts = [last - (count - 1 - place) * PERIOD_CYCLES for place in range(count)]
    return [(begin - 100, begin + PERIOD_CYCLES - 200) for begin in starts]


def longest_job(run: Run, thread: int, period_ms: float, window: Span) -> int:
    """Most cycles that a periodic task takes in one of its periods."""
    period = round(period_ms * CLOCK_NUMERATOR / (CLOCK_DENOMINATOR * 1000))
    return max(thread_cycles(run, thread, (at, at + period)) for at in range(*window, period))


Measured = tuple[list[Operation], list[Interrupt], list[Task]]


def measure(program: Program, elf: bytes) -> Measured:
    """Operations, interrupts and the drivers' own tasks."""
    brick = start(program, elf)
    brick.run(program.end_ms)
    names = ["nothing", *program.operations, "nothing"]
    assert brick.integer("operations") == len(names)
    run = observe(brick)
    spans = windows(run, len(names))
    empty = thread_cycles(run, MAIN, spans[0])
    quiet = last_instant(run, MAIN, spans[0]) - spans[0][0]
    operations = [
        Operation(
            name,
            thread_cycles(run, MAIN, window) - empty,
            handler_cycles(run, window, CAUSED),
            longest_masking(program, elf, window),
            last_instant(run, MAIN, window) - window[0] - quiet,
        )
        for name, window in zip(names, spans, strict=True)
        if name
    ]
    interrupts = []
    for source, name in SOURCES.items():
        own = [cycles for _, _, number, cycles in run.handlers if number == source]
        if own:
            interrupts.append(Interrupt(name, len(own), sum(own) / len(own), max(own)))
    threads = brick.device.thread_names()
    tasks = [
        Task(
            name, period, longest_job(run, threads.index(name), period, (spans[0][0], spans[-1][0]))
        )
        for name, period in TASKS.items()
        if name in threads
    ]
    return operations, interrupts, tasks


def telemetry_memory(elf: bytes) -> list[dict[str, Any]]:
    """Bytes of code and of data of the telemetry's parts, from the sizes of their symbols."""
    symbols = ELFFile(io.BytesIO(elf)).get_section_by_name(".symtab")
    rows = []
    for part, beginnings in TELEMETRY_PARTS.items():
        own = [s for s in symbols.iter_symbols() if s.name.startswith(beginnings)]
        kinds = {"STT_FUNC": 0, "STT_OBJECT": 0}
        for address, size, kind in {
            (s["st_value"], s["st_size"], s["st_info"]["type"]) for s in own
        }:
            if kind in kinds and address:
                kinds[kind] += size
        rows.append(
            {"name": part, "code_bytes": kinds["STT_FUNC"], "data_bytes": kinds["STT_OBJECT"]}
        )
    return rows


def figures(results: Callable[[str], Measured], telemetry_image: bytes) -> dict[str, Any]:
    """All figures by name, in cycles, for programs that reckon with them, from what the runs of the
    programs give."""
    operations: list[Operation] = []
    interrupts: dict[str, Interrupt] = {}
    tasks: dict[str, Task] = {}
    for program in PROGRAMS:
        measured, handlers, own = results(program.name)
        operations += measured[1:-1]
        interrupts = {row.name: row for row in handlers} | interrupts
        tasks = {task.name: task for task in own} | tasks
    return {
        "telemetry": {
            "memory": telemetry_memory(telemetry_image),
            "sample_bytes": {"fixed": SAMPLE_BYTES, "per_value": 4},
        },
        "clock_hz": [CLOCK_NUMERATOR, CLOCK_DENOMINATOR],
        "operations": [
            {
                "name": row.name.replace("`", ""),
                "task_cycles": row.task,
                "interrupt_cycles": row.interrupts,
                "masked_cycles": row.masked,
                "returns_after_cycles": row.returns_after,
            }
            for row in operations
        ],
        "interrupts": [
            {
                "name": row.name,
                "count": row.count,
                "mean_cycles": round(row.mean, 1),
                "longest_cycles": row.longest,
            }
            for row in interrupts.values()
        ],
        "tasks": [
            {"name": row.name, "period_ms": row.period_ms, "longest_cycles": row.longest}
            for row in tasks.values()
        ],
    }


def table(known: dict[str, Any]) -> str:
    """The page."""
    lines = [
        "# Costs of driver operations",
        "",
        "Generated by `make -C drivers costs` from a run on the virtual brick; do not edit. All",
        "figures are cycles of the processor's 48.05 MHz clock, from one run of an image in RAM.",
        "[driver-costs.json](driver-costs.json) has the same figures for programs, such as a",
        "schedulability analysis.",
        "",
        "| Operation | Task | Interrupts caused | Longest masking | Returns after |",
        "|---|---:|---:|---:|---:|",
    ]
    lines += [
        f"| `{row['name'].replace(', ', '`, ', 1)}{'' if ', ' in row['name'] else '`'} "
        f"| {row['task_cycles']} | {row['interrupt_cycles']} | {row['masked_cycles']} "
        f"| {row['returns_after_cycles']} |"
        for row in known["operations"]
    ]
    lines += [
        "",
        "*Task* is the processor time of the calling task beyond that of an empty job; it also",
        "bounds the time for which the operation's protected actions block other tasks.",
        "*Interrupts caused* is the time of the handlers of display, serial line, sound and",
        "sensor buses, at their own priorities, until the effect is complete. *Longest masking*",
        "is the time for which interrupts of some priority are delayed by a protected action, of",
        "the caller or of another task; it does not include the short sections with all",
        "interrupts masked. *Returns after* is the time from the call to the return; for the",
        "difference to *Task* the caller is suspended or interrupted. No operation polls: a test",
        "compares the two. An image in flash is stopped for 6 ms while it programs a page, and",
        "for 3 ms while it sets a bit of the flash memory.",
        "",
        "| Interrupt | Count | Mean | Longest |",
        "|---|---:|---:|---:|",
    ]
    lines += [
        f"| {row['name']} | {row['count']} | {row['mean_cycles']:.0f} | {row['longest_cycles']} |"
        for row in known["interrupts"]
    ]
    lines += [
        "",
        "The time of a handler is measured from its entry in the interrupt controller to its end,",
        "without nested handlers.",
        "",
        "| Task of the drivers | Period, ms | Longest job |",
        "|---|---:|---:|",
    ]
    lines += [
        f"| `{row['name']}` | {row['period_ms']:g} | {row['longest_cycles']} |"
        for row in known["tasks"]
    ]
    return "\n".join([*lines, *telemetry_lines(known["telemetry"]), ""])


def telemetry_lines(known: dict[str, Any]) -> list[str]:
    """The page's part on telemetry."""
    line = known["sample_bytes"]
    rows = [
        f"| {row['name']} | {row['code_bytes']} | {row['data_bytes']} |" for row in known["memory"]
    ]
    return [
        "",
        "`server_task` is the Bluetooth telemetry server, measured while a host receives samples.",
        "",
        "| Telemetry | Code, bytes | Data, bytes |",
        "|---|---:|---:|",
        *rows,
        "",
        "The server's data contains its stack of 2048 bytes. On the line a sample of *n* values",
        f"has {line['fixed']} + {line['per_value']} *n* bytes, including the frame.",
    ]


def main(folder: Path, page: Path) -> None:
    """Write the page, and the figures beside it."""
    programs = {program.name: program for program in PROGRAMS}
    images = {name: (folder / name / "ram" / f"{name}.elf").read_bytes() for name in programs}
    known = figures(lambda name: measure(programs[name], images[name]), images[TELEMETRY])
    page.write_text(table(known), encoding="utf-8")
    text = json.dumps(known, indent=1) + "\n"
    page.with_suffix(".json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
