# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Exact discrete-event simulation of a task set on one processor."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Literal, get_args

from ravenbrick.schedule.blocking import ceilings
from ravenbrick.schedule.demand import AnalysisLimitError
from ravenbrick.schedule.model import Task, TaskSet, TaskSetError
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schedule.releases import ReleasePattern, periodic

__all__ = ["Interval", "Job", "Protocol", "Scheduler", "Simulation", "simulate"]

Scheduler = Literal["fixed_priority", "earliest_deadline"]
Protocol = Literal["none", "inheritance", "ceiling", "immediate_ceiling"]
JOB_LIMIT = 2_000_000


@dataclass(frozen=True)
class Job:
    """One job; `completion` is None when the simulation ended before.

    `response_time` counts from the arrival, as the bounds do.
    """

    task: Task
    number: int
    arrival: Time
    release: Time
    start: Time | None
    completion: Time | None

    @property
    def absolute_deadline(self) -> Time:
        """Arrival plus relative deadline, of the frame if there are several."""
        return self.arrival + self.task.frame(self.number).deadline

    @property
    def response_time(self) -> Time | None:
        """Completion minus arrival."""
        return None if self.completion is None else exact(self.completion - self.arrival)


@dataclass(frozen=True)
class Interval:
    """The processor serves one job, with the same objects held, from `begin` to `end`."""

    begin: Time
    end: Time
    task: str
    job: int
    held: tuple[str, ...] = ()


@dataclass(frozen=True)
class Simulation:
    """What happened up to `until`. `deadlock` is the instant at which only blocked jobs were left.

    `jobs` are in the order of release, `intervals` are the Gantt chart.
    """

    jobs: tuple[Job, ...]
    intervals: tuple[Interval, ...]
    until: Time
    deadlock: Time | None

    def jobs_of(self, task: str) -> tuple[Job, ...]:
        """Jobs of one task in the order of release."""
        return tuple(job for job in self.jobs if job.task.name == task)

    def response_time_max(self, task: str) -> Time | None:
        """Longest response time among the completed jobs of a task."""
        times = [job.response_time for job in self.jobs_of(task)]
        return max((time for time in times if time is not None), default=None)

    @property
    def deadline_misses(self) -> tuple[Job, ...]:
        """Jobs not completed at their absolute deadline."""
        return tuple(
            job
            for job in self.jobs
            if (self.until if job.completion is None else job.completion) > job.absolute_deadline
        )

    @property
    def idle(self) -> Time:
        """Time without any job."""
        return exact(self.until - sum(part.end - part.begin for part in self.intervals))


@dataclass(eq=False)
class _Running:
    """A job under way: `boundary` is the next entry of the job's list of locks and unlocks."""

    task: Task
    number: int
    arrival: Time
    release: Time
    rank: int
    execution: Time
    boundaries: list[tuple[Time, str, bool]]
    executed: Time = 0
    boundary: int = 0
    start: Time | None = None
    completion: Time | None = None
    held: list[str] = field(default_factory=list)
    waits_for: str = ""

    @property
    def deadline(self) -> Time:
        return self.arrival + self.task.frame(self.number).deadline

    @property
    def order(self) -> tuple[Time, int, int]:
        """First in, first out; then the user's order of tasks."""
        return (self.release, self.rank, self.number)

    def next_boundary(self) -> Time:
        """Own execution up to which the job can run without lock or unlock."""
        if self.boundary < len(self.boundaries):
            return min(self.boundaries[self.boundary][0], self.execution)
        return self.execution

    def result(self) -> Job:
        return Job(self.task, self.number, self.arrival, self.release, self.start, self.completion)


def _by_deadline(job: _Running) -> tuple[Time, tuple[Time, int, int]]:
    return job.deadline, job.order


def _boundaries(task: Task) -> list[tuple[Time, str, bool]]:
    """Locks (True) and unlocks by own execution; unlocks first, inner before outer."""
    events: list[tuple[tuple[Time, int, Time], str, bool]] = []
    for section in task.sections:
        events.append(((section.start, 1, -section.duration), section.resource, True))
        events.append(((section.end, 0, section.duration), section.resource, False))
    events.sort(key=lambda event: event[0])
    return [(key[0], resource, lock) for key, resource, lock in events]


class _Machine:
    """State of the simulation."""

    def __init__(
        self,
        task_set: TaskSet,
        scheduler: Scheduler,
        protocol: Protocol,
        execution_time: Callable[[Task, int], Time],
    ) -> None:
        self.ceiling_of = ceilings(task_set)
        self.scheduler = scheduler
        self.protocol = protocol
        self.execution_time = execution_time
        self.boundaries = {task.name: _boundaries(task) for task in task_set}
        self.level_of = _preemption_levels(task_set)
        self.resource_level = _resource_levels(task_set, self.level_of)
        self.ready: list[_Running] = []
        self.owner: dict[str, _Running] = {}
        self.all: list[_Running] = []
        self.intervals: list[Interval] = []

    def release(self, task: Task, rank: int, number: int, arrival: Time, release: Time) -> None:
        execution = exact(self.execution_time(task, number))
        if not 0 < execution <= task.wcet:
            raise TaskSetError(
                f"a job executes for {execution}; expected more than 0 and at most {task.wcet}",
                task=task.name,
                field="wcet",
            )
        job = _Running(task, number, arrival, release, rank, execution, self.boundaries[task.name])
        self.ready.append(job)
        self.all.append(job)

    def active_priority(self, job: _Running) -> int:
        """Base priority, raised as the protocol says."""
        priority = job.task.priority
        if self.protocol == "immediate_ceiling":
            return max([priority, *(self.ceiling_of[name] for name in job.held)])
        if self.protocol in ("inheritance", "ceiling"):
            for other in self.ready:
                if other.waits_for and self.owner.get(other.waits_for) is job:
                    priority = max(priority, self.active_priority(other))
        return priority

    def choose(self) -> _Running | None:
        """The job to serve next; it may still have to take an object."""
        for job in self.ready:
            job.waits_for = job.waits_for if job.waits_for in self.owner else ""
        able = [job for job in self.ready if not job.waits_for]
        if not able:
            return None
        if self.scheduler == "earliest_deadline":
            return self._earliest_deadline(able)
        return min(able, key=lambda job: (-self.active_priority(job), job.order))

    def _earliest_deadline(self, able: list[_Running]) -> _Running:
        """Stack resource policy: a job may start only above the levels of the objects held."""
        started = [job for job in able if job.start is not None]
        waiting = [job for job in able if job.start is None]
        current = min(started, key=_by_deadline, default=None)
        newcomer = min(waiting, key=_by_deadline, default=None)
        if current is None or newcomer is None:
            return current or newcomer or able[0]
        level = max((self.resource_level[name] for name in self.owner), default=0)
        permitted = self.protocol == "none" or self.level_of[newcomer.task.name] > level
        return newcomer if newcomer.deadline < current.deadline and permitted else current

    def may_lock(self, job: _Running, resource: str) -> bool:
        """Whether the job gets the object now; otherwise it waits for the one in its way."""
        if resource in self.owner:
            job.waits_for = resource
            return False
        if self.protocol == "ceiling" and self.scheduler == "fixed_priority":
            others = [name for name, owner in self.owner.items() if owner is not job]
            barrier = max(others, key=lambda name: self.ceiling_of[name], default="")
            if barrier and self.ceiling_of[barrier] >= self.active_priority(job):
                job.waits_for = barrier
                return False
        return True

    def cross_boundaries(self, job: _Running, *, locks: bool) -> bool:
        """Unlock, and lock if `locks`, at the job's position; False when it has to wait."""
        while job.boundary < len(job.boundaries):
            position, resource, lock = job.boundaries[job.boundary]
            if position != job.executed or (lock and not locks):
                return True
            if lock:
                if not self.may_lock(job, resource):
                    return False
                self.owner[resource] = job
                job.held.append(resource)
            else:
                job.held.remove(resource)
                del self.owner[resource]
            job.boundary += 1
        return True

    def serve(self, job: _Running, now: Time, until: Time) -> Time:
        """Execute the job up to its next boundary or `until`; returns the new instant."""
        if job.start is None:
            job.start = now
        step = min(job.next_boundary() - job.executed, until - now)
        end = now + step
        self._note(Interval(now, end, job.task.name, job.number, tuple(job.held)))
        job.executed += step
        self.cross_boundaries(job, locks=False)
        if job.executed == job.execution:
            for resource in job.held:
                del self.owner[resource]
            job.completion = exact(end)
            self.ready.remove(job)
        return end

    def _note(self, part: Interval) -> None:
        last = self.intervals[-1] if self.intervals else None
        same = last and (last.end, last.task, last.job, last.held) == (
            part.begin,
            part.task,
            part.job,
            part.held,
        )
        if last and same:
            self.intervals[-1] = Interval(last.begin, part.end, part.task, part.job, part.held)
        else:
            self.intervals.append(part)


def _preemption_levels(task_set: TaskSet) -> dict[str, int]:
    """Levels by relative deadline: the shorter, the higher (Baker 1991)."""
    deadlines = sorted({task.deadline for task in task_set}, reverse=True)
    return {task.name: deadlines.index(task.deadline) + 1 for task in task_set}


def _resource_levels(task_set: TaskSet, levels: dict[str, int]) -> dict[str, int]:
    found: dict[str, int] = {}
    for task in task_set:
        for section in task.sections:
            found[section.resource] = max(found.get(section.resource, 0), levels[task.name])
    return found


def _releases(
    task_set: TaskSet, pattern: ReleasePattern
) -> Iterator[tuple[Time, int, int, Time, Task]]:
    """(release, rank, number, arrival, task) of all tasks in the order of time."""
    heap = []
    streams = [pattern(task) for task in task_set]
    for rank, stream in enumerate(streams):
        arrival, release = next(stream)
        heap.append((release, rank, 0, arrival))
    heapq.heapify(heap)
    while heap:
        release, rank, number, arrival = heapq.heappop(heap)
        yield release, rank, number, arrival, task_set.tasks[rank]
        arrival, release = next(streams[rank])
        heapq.heappush(heap, (release, rank, number + 1, arrival))


def _default_end(task_set: TaskSet) -> Time:
    phase = max(task.phase or 0 for task in task_set)
    return phase + task_set.hyperperiod * (2 if phase else 1)


def simulate(
    task_set: TaskSet,
    until: Time | None = None,
    *,
    scheduler: Scheduler = "fixed_priority",
    protocol: Protocol = "immediate_ceiling",
    releases: ReleasePattern = periodic,
    execution_time: Callable[[Task, int], Time] = lambda task, number: task.frame(number).wcet,
) -> Simulation:
    """Serve the jobs released before `until`, up to `until`.

    Fixed priorities are preemptive and first in, first out among equals; earliest deadline first
    prefers the job under way among equals, and its protocol is Baker's stack resource policy
    unless `protocol` is "none". `until` defaults to the hyperperiod, with phases to the largest
    phase plus two of them (Leung, Merrill 1980). Raises `AnalysisLimitError` when that is too far,
    and `ValueError` for an unknown scheduler or protocol.
    """
    for name, kinds in (("scheduler", Scheduler), ("protocol", Protocol)):
        value = scheduler if name == "scheduler" else protocol
        if value not in get_args(kinds):
            expected = ", ".join(get_args(kinds))
            raise ValueError(f"{name} is {value!r}; expected one of {expected}")
    end = exact(_default_end(task_set) if until is None else until)
    count = sum(end // task.period + 1 for task in task_set)
    if count > JOB_LIMIT:
        raise AnalysisLimitError(
            f"{count} jobs up to {end} are too many to simulate; give an earlier 'until'"
        )
    machine = _Machine(task_set, scheduler, protocol, execution_time)
    now: Time = 0
    deadlock: Time | None = None
    pending = _releases(task_set, releases)
    upcoming = next(pending)
    while now < end:
        while upcoming[0] <= now:
            machine.release(upcoming[4], upcoming[1], upcoming[2], upcoming[3], upcoming[0])
            upcoming = next(pending)
        horizon = min(end, upcoming[0])
        job = machine.choose()
        if job is None:
            deadlock = now if machine.ready and deadlock is None else deadlock
            now = horizon
        elif machine.cross_boundaries(job, locks=True):
            now = machine.serve(job, now, horizon)
    jobs = tuple(job.result() for job in machine.all)
    return Simulation(jobs, tuple(machine.intervals), end, deadlock)
