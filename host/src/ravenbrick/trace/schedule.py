# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Jobs, response times and the use of the processor, as the compiled module finds them in a run.

Terms as in the glossary: a job's response time runs from its nominal release to its completion;
its release latency from its nominal release to the instant at which it first gets the processor.
The release jitter of a task is the spread (largest less smallest) of its release latencies.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.project.robot import Robot, Task
from ravenbrick.trace.recording import Recording

__all__ = [
    "IDLE_OWNER",
    "INTERRUPT_OWNER",
    "KERNEL_OWNER",
    "Job",
    "Segment",
    "TaskMeasures",
    "Utilization",
    "all_jobs",
    "by_priority",
    "cyclic_begin_cycles",
    "jobs_of",
    "measure_tasks",
    "releases_of",
    "segments",
    "stretches",
    "task_plan",
]

IDLE_OWNER, KERNEL_OWNER, INTERRUPT_OWNER = -1, -2, -3
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Job:
    """One activation of a task; instants in cycles, None for what the run did not reach."""

    release_cycles: int
    start_cycles: int | None
    completion_cycles: int | None

    @property
    def response_time_cycles(self) -> int | None:
        """Nominal release to completion."""
        if self.completion_cycles is None:
            return None
        return self.completion_cycles - self.release_cycles


@dataclass(frozen=True)
class TaskMeasures:
    """What one run shows of one task; times in cycles, None when no job completed."""

    name: str
    releases: int
    completions: int
    response_time_cycles_min: int | None
    response_time_cycles_mean: float | None
    response_time_cycles_max: int | None
    release_jitter_cycles: int | None
    release_latency_cycles_max: int | None
    deadline_cycles: int | None
    deadline_misses: int


@dataclass(frozen=True)
class Segment:
    """An interval in which the processor did one thing: a thread's index or an owner below zero.

    `source` is the interrupt's source while a handler runs, else -1.
    """

    begin_cycles: int
    end_cycles: int
    owner: int
    source: int = -1


@dataclass(frozen=True)
class Utilization:
    """Shares of the whole run, each 0 to 1; `background` is part of `threads`, the rest sum to 1.

    `background` is what background threads took: the processor would otherwise be idle.
    """

    threads: tuple[float, ...]
    interrupts: float
    kernel: float
    idle: float
    background: float = 0.0

    @property
    def busy(self) -> float:
        """Share of tasks, interrupts and kernel, without background threads."""
        return 1.0 - self.idle - self.background


@lru_cache(maxsize=8)
def all_jobs(recording: Recording) -> tuple[list[Job], ...]:
    """Jobs of every thread, by the thread's index, in the order of their releases.

    A completion names the nominal release of its job; the first execution of a job is the first
    selection of the thread after its release event, or the release itself when it already ran.
    """
    return tuple([Job(*row) for row in rows] for rows in recording.native.jobs())


def by_priority(recording: Recording) -> list[int]:
    """Indices of the threads, from high to low base priority."""
    threads = recording.threads
    return sorted(range(len(threads)), key=lambda index: (-threads[index].base_priority, index))


def jobs_of(recording: Recording, thread: int) -> list[Job]:
    """Jobs of one thread."""
    return all_jobs(recording)[thread]


def releases_of(recording: Recording, thread: int) -> Integers:
    """Nominal releases of one thread's jobs, in cycles."""
    return np.array([job.release_cycles for job in jobs_of(recording, thread)], np.int64)


def task_plan(tasks: Iterable[Task]) -> list[dict[str, Any]]:
    """A task set as the compiled module reads it."""
    return [{"name": t.name, "release": t.release, "deadline_us": t.deadline_us} for t in tasks]


def measure_tasks(recording: Recording, tasks: Iterable[Task]) -> tuple[TaskMeasures, ...]:
    """Each thread's measures, from high to low base priority; deadlines come from the task set."""
    measured = recording.native.measure(json.dumps({"tasks": task_plan(tasks)}))
    rows = json.loads(measured.answer("{}"))["measures"]["tasks"]
    return tuple(TaskMeasures(**row) for row in rows)


@lru_cache(maxsize=8)
def segments(recording: Recording) -> list[Segment]:
    """The run cut into intervals with one owner each, without gaps, from cycle 0 to the stop."""
    cut = stretches(recording)
    rows = zip(*(c.tolist() for c in (cut.begin, cut.end, cut.owner, cut.source)), strict=True)
    found = []
    for owner, group in groupby((row for row in rows if row[0] < row[1]), key=lambda row: row[2:]):
        parts = list(group)
        found.append(Segment(parts[0][0], parts[-1][1], *owner))
    return found


@dataclass(frozen=True)
class Stretches:
    """The run cut at its events, from cycle 0 to the stop without gaps; instants in cycles.

    Neighbours may have the same owner, and a stretch may be empty. `source` is as of `Segment`.
    """

    begin: Integers
    end: Integers
    owner: Integers
    source: Integers

    def within(self, begin_cycles: int, end_cycles: int) -> Iterator[tuple[int, int, int]]:
        """Begin, end and owner of what lies between these instants, neighbours joined."""
        first = int(np.searchsorted(self.end, begin_cycles, side="right"))
        last = int(np.searchsorted(self.begin, end_cycles, side="left"))
        columns = (column[first:last].tolist() for column in (self.begin, self.end, self.owner))
        rows = (row for row in zip(*columns, strict=True) if row[0] < row[1])
        for owner, group in groupby(rows, key=lambda row: row[2]):
            parts = list(group)
            yield max(parts[0][0], begin_cycles), min(parts[-1][1], end_cycles), owner


@lru_cache(maxsize=8)
def stretches(recording: Recording) -> Stretches:
    """Whose the processor was, event by event."""
    columns = recording.native.stretches()
    return Stretches(*(np.frombuffer(column, "<i8") for column in columns))


def cyclic_begin_cycles(robot: Robot, recording: Recording) -> int:
    """When the last cyclic task begins its cycle: its first job only waits for that instant."""
    begins = [
        jobs[1].release_cycles
        for thread, jobs in zip(recording.threads, all_jobs(recording), strict=True)
        if len(jobs) > 1 and (task := robot.task(thread.name)) and task.release == "cyclic"
    ]
    return max(begins, default=0)
