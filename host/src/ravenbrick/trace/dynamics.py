# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What happens inside jobs and handlers: preemption, blocking, interference, distributions.

A job runs from its nominal release to its completion. In this time the processor is either the
task's own (execution), or with tasks of higher base priority (interference), with tasks of lower
base priority (blocking: ceilings, masked interrupts, and the kernel's switch, which is counted
for the task that is left), or with interrupt handlers, or with the kernel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.project.robot import Robot
from ravenbrick.trace.interrupts import source_name
from ravenbrick.trace.recording import IDLE, EventKind, Recording
from ravenbrick.trace.schedule import (
    INTERRUPT_OWNER,
    by_priority,
    jobs_of,
    measure_tasks,
    stretches,
)

__all__ = [
    "HandlerDynamics",
    "TaskDynamics",
    "dynamics_summary",
    "handler_dynamics",
    "histogram",
    "task_dynamics",
]

Cycles = NDArray[np.int64]
BINS = 40


@dataclass(frozen=True)
class Histogram:
    """Counts of values between whole edges (cycles), shapes (n,) and (n + 1,).

    The last bin holds its upper edge.
    """

    counts: Cycles
    edges_cycles: Cycles


@dataclass(frozen=True)
class TaskDynamics:
    """Completed jobs of one task, in the order of their releases; cycles, shape (n,) each."""

    name: str
    priority: int
    response_time_cycles: Cycles
    release_latency_cycles: Cycles
    execution_cycles: Cycles
    interference_cycles: Cycles
    blocking_cycles: Cycles
    interrupt_cycles: Cycles
    preemptions: Cycles
    deadline_cycles: int | None
    deadline_misses: int


@dataclass(frozen=True)
class HandlerDynamics:
    """Calls of the handlers of one interrupt source; cycles.

    `duration_cycles`, shape (n,), is the time in which the processor was this handler's own;
    `interval_cycles`, shape (n - 1,), lies between entries.
    """

    name: str
    source: int
    duration_cycles: Cycles
    interval_cycles: Cycles

    @property
    def interval_jitter_cycles(self) -> int | None:
        """Largest less smallest interval; None with fewer than two."""
        return int(np.ptp(self.interval_cycles)) if self.interval_cycles.size else None


def histogram(values: Cycles, bins: int = BINS) -> Histogram:
    """At most `bins` bins of equal whole width over the values; none for no values."""
    if not values.size:
        return Histogram(np.zeros(0, np.int64), np.zeros(1, np.int64))
    low, high = int(values.min()), int(values.max())
    width = max(-(-(high - low + 1) // bins), 1)
    count = (high - low) // width + 1
    edges = low + width * np.arange(count + 1, dtype=np.int64)
    counts = np.bincount((values - low) // width, minlength=count).astype(np.int64)
    return Histogram(counts, edges)


class _Shares:
    """How long each owner had the processor, up to any instant."""

    def __init__(self, recording: Recording) -> None:
        self._all = stretches(recording)

    def of(self, owners: Sequence[int], begin: Cycles, end: Cycles) -> Cycles:
        """Cycles of these owners within [begin, end), for many intervals at once."""
        mine = np.isin(self._all.owner, owners)
        first, last = self._all.begin[mine], self._all.end[mine]
        before = np.concatenate(([0], np.cumsum(last - first)))

        def until(instants: Cycles) -> Cycles:
            place = np.searchsorted(first, instants, side="right")
            inside = np.concatenate(([0], last))[place]
            return np.asarray(before[place] - np.maximum(inside - instants, 0), np.int64)

        return until(end) - until(begin)


def _preemptions(recording: Recording, thread: int, release: Cycles, end: Cycles) -> Cycles:
    """How often each job lost the processor to another task before it completed."""
    events = recording.of_kind(EventKind.THREAD_RUNNING)
    selected = events["subject"].astype(np.int64)
    before = np.concatenate(([IDLE], selected[:-1]))
    lost = (before == thread) & (selected != thread) & (selected != IDLE)
    instants = events["at_cycles"].astype(np.int64)[lost]
    job = np.searchsorted(end, instants, side="right")
    inside = job < end.size
    inside[inside] &= release[job[inside]] <= instants[inside]
    return np.bincount(job[inside], minlength=end.size).astype(np.int64)


def task_dynamics(robot: Robot, recording: Recording) -> tuple[TaskDynamics, ...]:
    """All tasks that completed a job, from high to low base priority."""
    shares = _Shares(recording)
    threads = recording.threads
    found = []
    tasks = measure_tasks(recording, robot.tasks)
    for index, measured in zip(by_priority(recording), tasks, strict=True):
        done = [
            (job.release_cycles, job.start_cycles, job.completion_cycles)
            for job in jobs_of(recording, index)
            if job.start_cycles is not None and job.completion_cycles is not None
        ]
        if not done:
            continue
        release, start, end = np.array(done, dtype=np.int64).T
        priority = threads[index].base_priority
        others = [i for i in range(len(threads)) if i != index]
        higher = [i for i in others if threads[i].base_priority >= priority]
        lower = [i for i in others if threads[i].base_priority < priority]
        found.append(
            TaskDynamics(
                name=threads[index].name,
                priority=priority,
                response_time_cycles=end - release,
                release_latency_cycles=start - release,
                execution_cycles=shares.of([index], release, end),
                interference_cycles=shares.of(higher, release, end),
                blocking_cycles=shares.of(lower, release, end),
                interrupt_cycles=shares.of([INTERRUPT_OWNER], release, end),
                preemptions=_preemptions(recording, index, release, end),
                deadline_cycles=measured.deadline_cycles,
                deadline_misses=measured.deadline_misses,
            )
        )
    return tuple(found)


def handler_dynamics(recording: Recording) -> tuple[HandlerDynamics, ...]:
    """All interrupt sources that were served, by their numbers."""
    calls: dict[int, list[tuple[int, int]]] = {}
    nested: list[tuple[int, int, int]] = []
    kinds = (EventKind.INTERRUPT_ENTERED, EventKind.INTERRUPT_LEFT)
    for at, kind, source, _value in recording.of_kind(*kinds).tolist():
        if kind == EventKind.INTERRUPT_ENTERED:
            nested.append((source, at, 0))
        elif nested:
            served, begin, inner = nested.pop()
            calls.setdefault(served, []).append((begin, at - begin - inner))
            if nested:
                outer, outer_begin, outer_inner = nested[-1]
                nested[-1] = (outer, outer_begin, outer_inner + at - begin)
    found = []
    for source, pairs in sorted(calls.items()):
        table = np.array(sorted(pairs), dtype=np.int64)
        intervals = np.diff(table[:, 0])
        found.append(HandlerDynamics(source_name(source), source, table[:, 1], intervals))
    return tuple(found)


def _spread(values: Cycles) -> dict[str, Any]:
    if not values.size:
        return {"min": None, "mean": None, "max": None}
    return {"min": int(values.min()), "mean": float(values.mean()), "max": int(values.max())}


def dynamics_summary(
    dynamics: Sequence[TaskDynamics], handlers: Sequence[HandlerDynamics]
) -> dict[str, Any]:
    """Figures of all tasks and handlers with plain types; cycles."""
    tasks = {
        task.name: {
            "jobs": int(task.response_time_cycles.size),
            "preemptions": int(task.preemptions.sum()),
            "preemptions_per_job_max": int(task.preemptions.max()),
            "response_time_cycles": _spread(task.response_time_cycles),
            "release_latency_cycles": _spread(task.release_latency_cycles),
            "execution_cycles": _spread(task.execution_cycles),
            "interference_cycles": _spread(task.interference_cycles),
            "blocking_cycles": _spread(task.blocking_cycles),
            "interrupt_cycles": _spread(task.interrupt_cycles),
            "deadline_misses": task.deadline_misses,
        }
        for task in dynamics
    }
    interrupts = {
        handler.name: {
            "source": handler.source,
            "calls": int(handler.duration_cycles.size),
            "duration_cycles": _spread(handler.duration_cycles),
            "interval_cycles": _spread(handler.interval_cycles),
            "interval_jitter_cycles": handler.interval_jitter_cycles,
        }
        for handler in handlers
    }
    return {"tasks": tasks, "interrupts": interrupts}
