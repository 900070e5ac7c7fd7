# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A recording as every export needs it: lanes of execution, jobs, series of values, marks.

Instants in files are whole nanoseconds since power-on, rounded down. A cycle is longer than a
nanosecond, so rounding up again (`ceil(ns x hertz / 10^9)`) gives back the exact cycle.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ravenbrick.clock import Clock
from ravenbrick.installation import brick_module
from ravenbrick.trace.interrupts import source_name
from ravenbrick.trace.recording import EventKind, Recording, Screen
from ravenbrick.trace.schedule import (
    IDLE_OWNER,
    INTERRUPT_OWNER,
    KERNEL_OWNER,
    Job,
    all_jobs,
    segments,
)

__all__ = ["Lane", "Series", "Timeline", "nanoseconds", "timeline_of"]

Cycles = NDArray[np.int64]


@dataclass(frozen=True)
class Lane:
    """When the processor did one thing: begins and ends in cycles, shape (n,) each."""

    name: str
    kind: Literal["task", "interrupt", "processor"]
    priority: int | None
    begin_cycles: Cycles
    end_cycles: Cycles
    jobs: tuple[Job, ...] = ()


@dataclass(frozen=True)
class Series:
    """A quantity that holds its value until the next sample; shape (n,) each."""

    name: str
    kind: Literal["signal", "input", "command"]
    unit: str
    cycles: Cycles
    values: NDArray[np.float64]


@dataclass(frozen=True)
class Mark:
    """Something that happened at an instant."""

    at_cycles: int
    text: str


@dataclass(frozen=True)
class Timeline:
    """Everything of a run in the order in which viewers should show it."""

    scenario: str
    digest: str
    clock: Clock
    end_cycles: int
    lanes: tuple[Lane, ...]
    series: tuple[Series, ...]
    marks: tuple[Mark, ...]
    screens: tuple[Screen, ...]


def nanoseconds(clock: Clock, cycles: Iterable[int] | Cycles) -> NDArray[np.int64]:
    """Whole nanoseconds of instants, rounded down; exact, without floating point."""
    scale = 1_000_000_000 / clock.hertz
    exact = np.asarray(cycles).astype(np.int64)
    if exact.size and int(exact.max()) * scale.numerator >= 2**63:
        return np.array([int(c) * scale.numerator // scale.denominator for c in exact], np.int64)
    return exact * scale.numerator // scale.denominator


def _lane(recording: Recording, owner: int, source: int, begin: Cycles, end: Cycles) -> Lane:
    if owner == INTERRUPT_OWNER:
        return Lane(source_name(source), "interrupt", None, begin, end)
    if owner in (KERNEL_OWNER, IDLE_OWNER):
        name = "kernel" if owner == KERNEL_OWNER else "asleep"
        return Lane(name, "processor", None, begin, end)
    thread = recording.threads[owner]
    jobs = tuple(all_jobs(recording)[owner])
    return Lane(thread.name, "task", thread.base_priority, begin, end, jobs)


def _lanes(recording: Recording) -> tuple[Lane, ...]:
    """Interrupts by source, tasks by falling priority, then kernel and sleep."""
    rows = [(s.begin_cycles, s.end_cycles, s.owner, s.source) for s in segments(recording)]
    table = np.array(rows, dtype=np.int64).reshape(-1, 4)
    sources = sorted(set(table[table[:, 2] == INTERRUPT_OWNER, 3].tolist()))
    threads = sorted(
        range(len(recording.threads)), key=lambda i: (-recording.threads[i].base_priority, i)
    )
    order = [(INTERRUPT_OWNER, source) for source in sources]
    order += [(thread, -1) for thread in threads] + [(KERNEL_OWNER, -1), (IDLE_OWNER, -1)]
    lanes = []
    for owner, source in order:
        mine = table[(table[:, 2] == owner) & (table[:, 3] == source)]
        lanes.append(_lane(recording, owner, source, mine[:, 0], mine[:, 1]))
    return tuple(lanes)


def _commands(recording: Recording) -> list[Series]:
    """Duty of each motor as commanded, at the exact instant of the command."""
    events = recording.of_kind(EventKind.MOTOR_COMMAND)
    found = []
    for motor, letter in enumerate("ABC"):
        mine = events[events["subject"] == motor]
        if mine.size:
            duty = (mine["value"] & 0xFF).astype(np.uint8).view(np.int8).astype(np.float64)
            cycles = mine["at_cycles"].astype(np.int64)
            found.append(Series(f"motor.{letter}.command", "command", "%", cycles, duty))
    return found


def _inputs(recording: Recording) -> list[Series]:
    names = sorted({timed.name for timed in recording.inputs})
    found = []
    for name in names:
        mine = [timed for timed in recording.inputs if timed.name == name]
        cycles = np.array([timed.at_cycles for timed in mine], np.int64)
        values = np.array([timed.value for timed in mine], np.float64)
        found.append(Series(name, "input", brick_module().signal_unit(name), cycles, values))
    return found


def _signals(recording: Recording) -> list[Series]:
    return [
        Series(
            name,
            "signal",
            brick_module().signal_unit(name),
            signal.cycles.astype(np.int64),
            signal.values,
        )
        for name, signal in sorted(recording.signals.items())
    ]


def _marks(recording: Recording) -> tuple[Mark, ...]:
    texts = {
        EventKind.DISPLAY_CHANGED: "LCD changed",
        EventKind.POWER_OFF: "power off",
        EventKind.COPROCESSOR_CLICK: "co-processor heard nothing",
    }
    events = recording.of_kind(*texts).tolist()
    return tuple(Mark(at, texts[EventKind(kind)]) for at, kind, _subject, _value in events)


def timeline_of(recording: Recording) -> Timeline:
    """The timeline of a recording."""
    return Timeline(
        scenario=recording.scenario,
        digest=recording.digest,
        clock=recording.clock,
        end_cycles=recording.stop.at_cycles,
        lanes=_lanes(recording),
        series=(*_inputs(recording), *_commands(recording), *_signals(recording)),
        marks=_marks(recording),
        screens=recording.screens,
    )
