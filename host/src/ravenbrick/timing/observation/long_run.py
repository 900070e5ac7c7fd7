# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Hours of virtual time: a scenario over and over, its inputs at other phases each time, and
statistics that do not grow with the length of the run."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.brick.protocol import Progress, no_progress
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.timing.observation.job_facts import have_deadline
from ravenbrick.trace.interrupts import source_name
from ravenbrick.trace.recording import IDLE, EventKind, decode_events

__all__ = ["cyclic_begin", "long_run"]

Cycles = NDArray[np.int64]
PIECE_MS = 5_000
BIN_CYCLES = 48
SIGNAL_PERIOD_US = 100_000


@dataclass
class Spread:
    """Statistics of values: count, sum, extremes, and a histogram in bins of a microsecond."""

    count: int = 0
    total: int = 0
    least: int | None = None
    most: int | None = None
    bins: Counter[int] = field(default_factory=Counter)

    def add(self, values: Cycles) -> None:
        """Take in some values, shape (n,), cycles."""
        if not values.size:
            return
        low, high = int(values.min()), int(values.max())
        self.count += int(values.size)
        self.total += int(values.sum())
        self.least = low if self.least is None else min(self.least, low)
        self.most = high if self.most is None else max(self.most, high)
        places, counts = np.unique(values // BIN_CYCLES, return_counts=True)
        self.bins.update(dict(zip(places.tolist(), counts.tolist(), strict=True)))

    def plain(self) -> dict[str, Any]:
        """For JSON; cycles, and bins as [lower edge, count]."""
        return {
            "count": self.count,
            "min": self.least,
            "mean": self.total / self.count if self.count else None,
            "max": self.most,
            "bins": [[place * BIN_CYCLES, count] for place, count in sorted(self.bins.items())],
        }


@dataclass
class _TaskFigures:
    response: Spread = field(default_factory=Spread)
    latency: Spread = field(default_factory=Spread)
    misses: int = 0


@dataclass
class LongRun:
    """Observations of a long run, by the names of tasks and of interrupt sources. Jobs without a
    deadline, of tasks in `outside`, are left out."""

    seconds: float = 0.0
    repetitions: int = 0
    events: int = 0
    tasks: dict[str, _TaskFigures] = field(default_factory=dict)
    intervals: dict[str, Spread] = field(default_factory=dict)
    outside: frozenset[str] = frozenset()
    _last_entry: dict[int, int] = field(default_factory=dict)

    def plain(self) -> dict[str, Any]:
        """For JSON; cycles."""
        tasks = {
            name: {
                "response_time_cycles": found.response.plain(),
                "release_latency_cycles": found.latency.plain(),
                "deadline_misses": found.misses,
            }
            for name, found in self.tasks.items()
        }
        return {
            "seconds": self.seconds,
            "repetitions": self.repetitions,
            "events": self.events,
            "tasks": tasks,
            "interrupt_interval_cycles": {n: s.plain() for n, s in self.intervals.items()},
        }

    def take(self, events: NDArray[np.void], names: list[str], robot: Robot, since: int) -> None:
        """Statistics of a piece in which every job that begins also ends."""
        self.events += int(events.size)
        at = events["at_cycles"].astype(np.int64)
        kind, subject = events["kind"], events["subject"].astype(np.int64)
        value = events["value"].astype(np.int64)
        chosen = kind == int(EventKind.THREAD_RUNNING)
        running_at, running = at[chosen], subject[chosen]
        for index, name in enumerate(names):
            task = robot.task(name)
            if task is None:
                continue
            figures = self.tasks.setdefault(task.name, _TaskFigures())
            done = (kind == int(EventKind.COMPLETION)) & (subject == index) & (value >= since)
            responses = (at[done] - value[done])[have_deadline(task, value[done], self.outside)]
            figures.response.add(responses)
            deadline = task.deadline_us or task.period_us
            if deadline is not None:
                limit = MASTER_CLOCK.cycles_of_us(deadline)
                figures.misses += int(np.count_nonzero(responses > limit))
            released = (kind == int(EventKind.RELEASE)) & (subject == index) & (value >= since)
            figures.latency.add(
                _latencies(at[released], value[released], running_at[running == index])
            )
        self._take_interrupts(at, kind, subject)

    def _take_interrupts(self, at: Cycles, kind: Any, subject: Cycles) -> None:
        entered = kind == int(EventKind.INTERRUPT_ENTERED)
        for source in np.unique(subject[entered]).tolist():
            instants = at[entered & (subject == source)]
            before = self._last_entry.get(source)
            if before is not None:
                instants = np.concatenate(([before], instants))
            self._last_entry[source] = int(instants[-1])
            spread = self.intervals.setdefault(source_name(source), Spread())
            spread.add(np.diff(instants))


def _latencies(released: Cycles, nominal: Cycles, selected: Cycles) -> Cycles:
    """From nominal releases to the next time the task gets the processor."""
    place = np.searchsorted(selected, released)
    known = place < selected.size
    return np.asarray(np.maximum(selected[place[known]] - nominal[known], 0), np.int64)


def _last_idle(events: NDArray[np.void]) -> int:
    """Position of the last instant at which nobody runs: a piece can end there."""
    running = events["kind"] == int(EventKind.THREAD_RUNNING)
    idle = np.flatnonzero(running & (events["subject"] == IDLE))
    return int(idle[-1]) if idle.size else 0


def _pieces(
    brick: Any, scenario: Scenario, begin: int, repetitions: int, rng: random.Random
) -> Iterator[tuple[bytes, bool]]:
    """Events piece by piece, and whether the brick goes on."""
    inputs, length = scenario.timed_inputs(), MASTER_CLOCK.cycles_of_ms(scenario.duration_ms)
    piece = MASTER_CLOCK.cycles_of_ms(PIECE_MS)
    for repetition in range(repetitions):
        start = begin + repetition * length
        phase = rng.randrange(MASTER_CLOCK.cycles_of_ms(10))
        for timed in inputs:
            brick.schedule_input(start + phase + timed.at_cycles, timed.name, timed.value)
        for end in (*range(start + piece, start + length, piece), start + length):
            stop = brick.run_until(end)
            goes_on = stop.reason == "reached"
            yield brick.take_events(), goes_on
            if not goes_on:
                return


def long_run(
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    seconds: float,
    progress: Progress = no_progress,
    seed: int = 1,
    target: VirtualTarget | None = None,
    outside: Collection[str] = (),
) -> LongRun:
    """Play a scenario over and over for this long; a brick that went off is switched on again."""
    result, rng = LongRun(outside=frozenset(outside)), random.Random(seed)
    plain = (target or VirtualTarget()).without_counts()
    quiet = replace(scenario, inputs=(), stimuli=(), signal_period_us=SIGNAL_PERIOD_US)
    wanted = max(1, round(seconds * 1000 / scenario.duration_ms))
    while result.repetitions < wanted:
        brick = plain.prepare(robot, quiet, image)
        before = brick.cycles
        rest = np.zeros(0, decode_events(b"").dtype)
        since = None
        for content, _ in _pieces(brick, scenario, before, wanted - result.repetitions, rng):
            events = np.concatenate([rest, decode_events(content)])
            names = [thread.name.lower() for thread in brick.threads()]
            if since is None:
                since = cyclic_begin(events, names, robot)
            place = _last_idle(events)
            result.take(events[:place], names, robot, since)
            rest = events[place:]
            done = (brick.cycles - before) / MASTER_CLOCK.cycles_of_ms(scenario.duration_ms)
            progress(min(1.0, (result.repetitions + done) / wanted))
        result.seconds += float(MASTER_CLOCK.seconds(brick.cycles - before))
        result.repetitions += max(1, round(done))
        result._last_entry.clear()
    return result


def cyclic_begin(events: NDArray[np.void], names: list[str], robot: Robot) -> int:
    """When the last cyclic task begins its cycle: its second release."""
    begins = []
    releases = events[events["kind"] == int(EventKind.RELEASE)]
    for index, name in enumerate(names):
        task = robot.task(name)
        nominal = releases["value"][releases["subject"] == index]
        if task is not None and task.release == "cyclic" and nominal.size > 1:
            begins.append(int(nominal[1]))
    return max(begins, default=0)
