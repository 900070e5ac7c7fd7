# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Jobs, response times and the use of the processor, from the events of a run.

Terms as in the glossary: a job's response time runs from its nominal release to its completion;
its release latency from its nominal release to the instant at which it first gets the processor.
The release jitter of a task is the spread (largest less smallest) of its release latencies.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from ravenbrick.project.robot import Robot, Task
from ravenbrick.trace.recording import IDLE, EventKind, Recording

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
    "measure_task",
    "segments",
    "stretches",
    "utilization",
]

IDLE_OWNER, KERNEL_OWNER, INTERRUPT_OWNER = -1, -2, -3
OWNING = (
    EventKind.THREAD_RUNNING,
    EventKind.INTERRUPT_ENTERED,
    EventKind.INTERRUPT_LEFT,
    EventKind.PROCESSOR_STOPPED,
    EventKind.PROCESSOR_RESUMED,
)
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


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

    @property
    def release_latency_cycles(self) -> int | None:
        """Nominal release to first execution."""
        return None if self.start_cycles is None else self.start_cycles - self.release_cycles


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


class _JobBuilder:
    """Jobs of one thread, event by event."""

    def __init__(self) -> None:
        self._starts: dict[int, int] = {}
        self._ends: dict[int, int] = {}
        self._releases: list[int] = []
        self._pending: int | None = None

    def select(self, at: int) -> None:
        """The thread gets the processor."""
        if self._pending is not None:
            self._starts[self._pending], self._pending = at, None

    def release(self, at: int, nominal: int, running: bool) -> None:
        """A job is released; when the thread is running already, it starts at once."""
        self._releases.append(nominal)
        if running:
            self._starts[nominal] = max(at, nominal)
        else:
            self._pending = nominal

    def complete(self, at: int, nominal: int) -> None:
        """The job of this nominal release is done."""
        self._ends[nominal] = at

    def jobs(self) -> list[Job]:
        """All jobs in the order of their releases."""
        return [Job(r, self._starts.get(r), self._ends.get(r)) for r in self._releases]


@lru_cache(maxsize=8)
def all_jobs(recording: Recording) -> tuple[list[Job], ...]:
    """Jobs of every thread, by the thread's index, in the order of their releases.

    A completion names the nominal release of its job; the first execution of a job is the first
    selection of the thread after its release event, or the release itself when it already ran.
    """
    builders = [_JobBuilder() for _ in recording.threads]
    kinds = (EventKind.THREAD_RUNNING, EventKind.RELEASE, EventKind.COMPLETION)
    running = IDLE
    for at, kind, subject, value in recording.of_kind(*kinds).tolist():
        if kind == EventKind.THREAD_RUNNING:
            running = subject
            if subject != IDLE:
                builders[subject].select(at)
        elif kind == EventKind.RELEASE:
            builders[subject].release(at, value, running == subject)
        else:
            builders[subject].complete(at, value)
    return tuple(builder.jobs() for builder in builders)


def by_priority(recording: Recording) -> list[int]:
    """Indices of the threads, from high to low base priority."""
    threads = recording.threads
    return sorted(range(len(threads)), key=lambda index: (-threads[index].base_priority, index))


def jobs_of(recording: Recording, thread: int) -> list[Job]:
    """Jobs of one thread."""
    return all_jobs(recording)[thread]


def _misses(jobs: list[Job], deadline_cycles: int | None, end_cycles: int) -> int:
    if deadline_cycles is None:
        return 0
    missed = 0
    for job in jobs:
        completion = end_cycles if job.completion_cycles is None else job.completion_cycles
        missed += completion - job.release_cycles > deadline_cycles
    return missed


def measure_task(recording: Recording, thread: int, task: Task | None) -> TaskMeasures:
    """Measures of one thread; its deadline comes from the task set (None: no deadline)."""
    jobs = jobs_of(recording, thread)
    responses = [r for job in jobs if (r := job.response_time_cycles) is not None]
    latencies = [late for job in jobs if (late := job.release_latency_cycles) is not None]
    deadline = None
    if task is not None and task.deadline_us is not None:
        deadline = int(task.deadline_us * recording.clock.hertz / 1_000_000)
    return TaskMeasures(
        name=recording.threads[thread].name,
        releases=len(jobs),
        completions=len(responses),
        response_time_cycles_min=min(responses, default=None),
        response_time_cycles_mean=float(np.mean(responses)) if responses else None,
        response_time_cycles_max=max(responses, default=None),
        release_jitter_cycles=max(latencies) - min(latencies) if latencies else None,
        release_latency_cycles_max=max(latencies, default=None),
        deadline_cycles=deadline,
        deadline_misses=_misses(jobs, deadline, recording.stop.at_cycles),
    )


class _Processor:
    """Who has the processor, event by event."""

    def __init__(self, stops: bool) -> None:
        self.stops = stops
        self.stopped = False
        self.handlers: list[int] = []
        self.running = IDLE

    def owner(self) -> tuple[int, int]:
        """Owner of the next cycles, and source of the innermost handler.

        Without stop events, the idle thread counts as idle.
        """
        if self.stopped:
            return IDLE_OWNER, -1
        if self.handlers:
            return INTERRUPT_OWNER, self.handlers[-1]
        if self.running != IDLE:
            return self.running, -1
        return (KERNEL_OWNER if self.stops else IDLE_OWNER), -1

    def apply(self, kind: int, subject: int) -> None:
        """Take one event into account."""
        if kind == EventKind.THREAD_RUNNING:
            self.running = subject
        elif kind == EventKind.INTERRUPT_ENTERED:
            self.handlers.append(subject)
        elif kind == EventKind.INTERRUPT_LEFT:
            del self.handlers[-1:]
        else:
            self.stopped = kind == EventKind.PROCESSOR_STOPPED


@lru_cache(maxsize=8)
def segments(recording: Recording) -> list[Segment]:
    """The run cut into intervals with one owner each, without gaps, from cycle 0 to the stop."""
    events = recording.of_kind(*OWNING)
    processor = _Processor(bool(np.any(events["kind"] == EventKind.PROCESSOR_STOPPED)))
    result: list[Segment] = []
    begin, owner = 0, processor.owner()
    if processor.stops:
        owner = KERNEL_OWNER, -1
    for at, kind, subject, _value in events.tolist():
        processor.apply(kind, subject)
        if processor.owner() != owner:
            if at > begin:
                result.append(Segment(begin, at, *owner))
            begin, owner = max(at, begin), processor.owner()
    if recording.stop.at_cycles > begin:
        result.append(Segment(begin, recording.stop.at_cycles, *owner))
    return result


def _latest(where: Mask, values: Integers, before: int) -> Integers:
    """At each place the value at the last place of the mask, `before` where there is none yet."""
    last = np.maximum.accumulate(np.where(where, np.arange(where.size), -1))
    return np.where(last < 0, before, values[last])


def _owners(kinds: Integers, subjects: Integers, stops: bool) -> Integers:
    """Whose the processor is after each event, as `_Processor` says it, of all at once."""
    entered, left = kinds == EventKind.INTERRUPT_ENTERED, kinds == EventKind.INTERRUPT_LEFT
    depth = np.cumsum(entered.astype(np.int64) - left)
    depth -= np.minimum.accumulate(np.minimum(depth, 0))
    runs = kinds == EventKind.THREAD_RUNNING
    running = _latest(runs, subjects, IDLE)
    sleep = kinds == EventKind.PROCESSOR_STOPPED
    stopped = _latest(sleep | (kinds == EventKind.PROCESSOR_RESUMED), sleep.astype(np.int64), 0)
    running = np.where(running == IDLE, KERNEL_OWNER if stops else IDLE_OWNER, running)
    return np.where(stopped, IDLE_OWNER, np.where(depth > 0, INTERRUPT_OWNER, running))


@dataclass(frozen=True)
class Stretches:
    """The run cut at its events, from cycle 0 to the stop without gaps; instants in cycles.

    Neighbours may have the same owner, and a stretch may be empty.
    """

    begin: Integers
    end: Integers
    owner: Integers

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
    """Whose the processor was, as `segments`, without the sources of interrupts."""
    events = recording.of_kind(*OWNING)
    kinds, subjects = (events[name].astype(np.int64) for name in ("kind", "subject"))
    stops = bool(np.any(kinds == EventKind.PROCESSOR_STOPPED))
    begin = np.maximum.accumulate(np.append(0, events["at_cycles"].astype(np.int64)))
    end = np.append(begin[1:], max(recording.stop.at_cycles, int(begin[-1])))
    first = KERNEL_OWNER if stops else IDLE_OWNER
    return Stretches(begin, end, np.append(first, _owners(kinds, subjects, stops)))


def utilization(recording: Recording, background: Collection[str] = ()) -> Utilization:
    """Shares of the processor over the whole run; `background` names background threads."""
    found = stretches(recording)
    lengths = found.end - found.begin
    total = max(int(lengths.sum()), 1)

    def share(owner: int) -> float:
        return int(lengths[found.owner == owner].sum()) / total

    threads = tuple(share(index) for index in range(len(recording.threads)))
    aside = (t.name in background for t in recording.threads)
    return Utilization(
        threads=threads,
        background=sum(part for part, is_aside in zip(threads, aside, strict=True) if is_aside),
        interrupts=share(INTERRUPT_OWNER),
        kernel=share(KERNEL_OWNER),
        idle=share(IDLE_OWNER),
    )


def cyclic_begin_cycles(robot: Robot, recording: Recording) -> int:
    """When the last cyclic task begins its cycle: its first job only waits for that instant."""
    begins = [
        jobs[1].release_cycles
        for thread, jobs in zip(recording.threads, all_jobs(recording), strict=True)
        if len(jobs) > 1 and (task := robot.task(thread.name)) and task.release == "cyclic"
    ]
    return max(begins, default=0)
