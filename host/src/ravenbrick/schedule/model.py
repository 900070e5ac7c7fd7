# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Task sets as schedulability theory sees them.

All times are in one unit of the user's choice and exact. A greater priority number is more
urgent, as in Ada. Tasks of equal priority are served first in, first out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from typing import Literal

from ravenbrick.errors import ExitCode, RavenbrickError
from ravenbrick.schedule.quantity import Time, common_multiple, exact

__all__ = [
    "NO_OVERHEADS",
    "CriticalSection",
    "Frame",
    "Overheads",
    "Task",
    "TaskSet",
    "TaskSetError",
]

Release = Literal["cyclic", "sporadic", "interrupt"]
RELEASES: tuple[Release, ...] = ("cyclic", "sporadic", "interrupt")


class TaskSetError(RavenbrickError):
    """A task set that means nothing; `task` and `field` say where (empty if not in one task)."""

    exit_code = ExitCode.PROJECT_FILE

    def __init__(self, problem: str, *, task: str = "", field: str = "") -> None:
        place = ".".join(part for part in (task, field) if part)
        super().__init__(f"{place}: {problem}" if place else problem)
        self.problem = problem
        self.task = task
        self.field = field


def _time(value: object, task: str, name: str, *, positive: bool) -> Time:
    try:
        time = exact(value)
    except ValueError as error:
        raise TaskSetError(f"{error}; write a time", task=task, field=name) from None
    if time < 0 or (positive and time == 0):
        limit = "more than 0" if positive else "at least 0"
        raise TaskSetError(f"is {value}; expected {limit}", task=task, field=name)
    return time


def _limit(share: object, span: object, late: object = 0) -> tuple[Time, Time, Time]:
    return exact(share), exact(span), exact(late)


@dataclass(frozen=True)
class CriticalSection:
    """Use of a protected object for `duration`, after `start` of the job's own execution."""

    resource: str
    duration: Time
    start: Time = 0

    @property
    def end(self) -> Time:
        """Own execution at which the object is released."""
        return self.start + self.duration


@dataclass(frozen=True)
class Frame:
    """One job of a multiframe task: its execution time, its deadline relative to its arrival, and
    the least time from its arrival to that of the next job."""

    wcet: Time
    separation: Time
    deadline: Time


@dataclass(frozen=True)
class Task:
    """One task.

    `period` is the minimum inter-release time of sporadic tasks and interrupts. `deadline` is
    relative to the arrival and defaults to the period. `release_jitter` is the longest delay from
    arrival to release. `phase` is the first arrival; None means that nothing is known about it.
    `blocking` is a bound stated by the user; it holds besides what the sections give. A job may
    stand for a burst of several: `limits` then says how little of its execution can come in a
    shorter window, as (share of the job, length of any window), or with a third time as a share
    each such length that may come late by it (periodic with jitter; Richter 2005). The jobs of a
    multiframe task take its `frames` in turn, from any one on (Mok, Chen 1997; Baruah, Chen,
    Gorinsky, Mok 1999); `wcet` is then the longest, `period` the least separation and `deadline`
    the shortest one, so what does not know of frames is pessimistic. `bcet` is the least execution
    time of a job, `wcet_high` the longest one of a task of high criticality when it takes longer
    than `wcet`. If the jobs of a task with a phase take different times in turn, `turns` are the
    longest of each, the one at the phase first; what does not know of them takes `wcet`.
    """

    name: str
    period: Time
    wcet: Time
    priority: int = 0
    deadline: Time = -1
    release_jitter: Time = 0
    phase: Time | None = None
    release: Release = "cyclic"
    sections: tuple[CriticalSection, ...] = ()
    blocking: Time = 0
    limits: tuple[tuple[Time, ...], ...] = ()
    frames: tuple[Frame, ...] = ()
    bcet: Time = 0
    wcet_high: Time | None = None
    turns: tuple[Time, ...] = ()

    def __post_init__(self) -> None:
        """Make the times exact and refuse what means nothing."""
        for name in ("period", "wcet"):
            self._set(name, _time(getattr(self, name), self.name, name, positive=True))
        self._check_frames()
        if self.deadline == -1:
            self._set("deadline", self.period)
        self._set("deadline", _time(self.deadline, self.name, "deadline", positive=True))
        for name in ("release_jitter", "blocking", "bcet"):
            self._set(name, _time(getattr(self, name), self.name, name, positive=False))
        if self.bcet > min([self.wcet, *(frame.wcet for frame in self.frames)]):
            self._refuse("bcet", f"is {self.bcet}, more than the execution time of a job")
        if max(self.turns, default=0) > self.wcet:
            self._refuse("turns", f"has {max(self.turns)}, more than the execution time of a job")
        if self.wcet_high is not None:
            self._set("wcet_high", _time(self.wcet_high, self.name, "wcet_high", positive=True))
            if self.wcet_high < self.wcet:
                self._refuse("wcet_high", f"is {self.wcet_high}; expected at least {self.wcet}")
        if self.phase is not None:
            self._set("phase", _time(self.phase, self.name, "phase", positive=False))
        if self.release not in RELEASES:
            self._refuse("release", f"is '{self.release}'; expected one of {', '.join(RELEASES)}")
        if self.phase is not None and self.release != "cyclic":
            self._refuse("phase", f"has no meaning for a task released as '{self.release}'")
        self._set("limits", tuple(_limit(*limit) for limit in self.limits))
        if any(share <= 0 or span <= 0 or late < 0 for share, span, late in self.limits):
            self._refuse("limits", "has a share or a window that is not more than 0")
        self._set("sections", tuple(self._section(section) for section in self.sections))
        self._check_nesting()

    def _check_frames(self) -> None:
        """Execution time, separation and deadline are the longest, least and shortest frame's."""
        if not self.frames:
            return
        for frame in self.frames:
            for name in ("wcet", "separation", "deadline"):
                _time(getattr(frame, name), self.name, "frames", positive=True)
        if self.limits:
            self._refuse("frames", "does not go with 'limits'; leave one of them out")
        self._set("wcet", max(frame.wcet for frame in self.frames))
        self._set("period", min(frame.separation for frame in self.frames))
        self._set("deadline", min(frame.deadline for frame in self.frames))

    def frame(self, number: int) -> Frame:
        """What job `number` from the first frame on is."""
        if not self.frames:
            return Frame(self.wcet, self.period, self.deadline)
        return self.frames[number % len(self.frames)]

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _refuse(self, name: str, problem: str) -> None:
        raise TaskSetError(problem, task=self.name, field=name)

    def _section(self, section: CriticalSection) -> CriticalSection:
        duration = _time(section.duration, self.name, "sections", positive=True)
        start = _time(section.start, self.name, "sections", positive=False)
        if start + duration > self.wcet:
            self._refuse(
                "sections",
                f"'{section.resource}' ends after {start + duration} of the job's execution, "
                f"but the wcet is {self.wcet}",
            )
        return CriticalSection(section.resource, duration, start)

    def _check_nesting(self) -> None:
        for first in self.sections:
            for second in self.sections:
                if first.start < second.start < first.end < second.end:
                    self._refuse(
                        "sections",
                        f"'{second.resource}' begins inside '{first.resource}' and ends after it; "
                        "sections must nest or follow each other",
                    )
                inner = first is not second and first.resource == second.resource
                if inner and first.start <= second.start < first.end:
                    self._refuse("sections", f"'{first.resource}' is taken while it is held")

    @property
    def utilization(self) -> Time:
        """C / T; of a multiframe task, sum of C / sum of T of its frames."""
        if self.frames:
            span = sum((Fraction(frame.separation) for frame in self.frames), Fraction(0))
            return exact(sum(frame.wcet for frame in self.frames) / span)
        return exact(Fraction(self.wcet) / Fraction(self.period))

    @property
    def cycle(self) -> Time:
        """Time after which the jobs repeat: the period, or the sum of the frames' separations."""
        return exact(sum(frame.separation for frame in self.frames)) if self.frames else self.period

    @property
    def programs_alarm(self) -> bool:
        """Whether the clock releases the task."""
        return self.release == "cyclic"


@dataclass(frozen=True)
class Overheads:
    """What the run-time and the processor cost, in the unit of the task set.

    `switch_in` and `switch_out` are charged to each job of a task, `interrupt_entry` to each job
    of an interrupt. Released by alarms, each release of a cyclic task costs `alarm` at the top
    priority, a further one at the same instant, where phases are known, `alarm_further` (as `alarm`
    unless given). A call of the alarm that comes early and releases nobody costs `alarm_early`:
    there is at most one before each instant of release, and one each `alarm_early_period`, which
    is also the shortest time that it comes after the release before. Released by a periodic tick,
    each `tick_period` costs `tick`, the first release found by a tick `tick_first` and each further
    one `tick_further`. `masked_section` is the longest time for which the run-time masks
    interrupts; `clock_resolution` the largest delay of a release by the clock's grain.
    """

    switch_in: Time = 0
    switch_out: Time = 0
    interrupt_entry: Time = 0
    alarm: Time = 0
    alarm_further: Time = -1
    alarm_early: Time = 0
    alarm_early_period: Time = 0
    tick_period: Time = 0
    tick: Time = 0
    tick_first: Time = 0
    tick_further: Time = 0
    masked_section: Time = 0
    clock_resolution: Time = 0

    def __post_init__(self) -> None:
        """Make the times exact and refuse what means nothing."""
        if self.alarm_further == -1:
            object.__setattr__(self, "alarm_further", self.alarm)
        for item in fields(self):
            value = _time(getattr(self, item.name), "overheads", item.name, positive=False)
            object.__setattr__(self, item.name, value)
        if self.alarm_further > self.alarm:
            raise TaskSetError(
                f"is {self.alarm_further}; expected at most 'alarm' ({self.alarm})",
                task="overheads",
                field="alarm_further",
            )
        if self.tick_period == 0 and self.tick + self.tick_first + self.tick_further > 0:
            raise TaskSetError(
                "is missing; costs of a tick need it", task="overheads", field="tick_period"
            )
        if self.tick_first < self.tick_further:
            raise TaskSetError(
                f"is {self.tick_further}; expected at most 'tick_first' ({self.tick_first})",
                task="overheads",
                field="tick_further",
            )

    def per_job(self, task: Task) -> Time:
        """What each job of the task costs besides its own execution and the clock's work."""
        if task.release == "interrupt":
            return self.interrupt_entry
        return self.switch_in + self.switch_out

    def jitter(self, task: Task) -> Time:
        """Release jitter of the task, with the clock's grain for cyclic tasks."""
        return task.release_jitter + (self.clock_resolution if task.programs_alarm else 0)


NO_OVERHEADS = Overheads()


@dataclass(frozen=True)
class TaskSet:
    """Tasks in the user's order; names are unique."""

    tasks: tuple[Task, ...]

    def __post_init__(self) -> None:
        """Refuse an empty set and names used twice."""
        object.__setattr__(self, "tasks", tuple(self.tasks))
        if not self.tasks:
            raise TaskSetError("there is no task; add one", field="tasks")
        seen: set[str] = set()
        for task in self.tasks:
            if task.name in seen:
                raise TaskSetError("is defined twice; rename one", task=task.name, field="name")
            seen.add(task.name)

    @classmethod
    def of(cls, *rows: Sequence[object]) -> TaskSet:
        """Set from rows (C, T) or (C, T, D), most urgent first, named t1, t2, ..."""
        tasks = []
        for index, (wcet, period, *deadline) in enumerate(rows):
            task = Task(
                f"t{index + 1}",
                exact(period),
                exact(wcet),
                len(rows) - index,
                exact(deadline[0]) if deadline else -1,
            )
            tasks.append(task)
        return cls(tuple(tasks))

    def __iter__(self) -> Iterator[Task]:
        return iter(self.tasks)

    def __len__(self) -> int:
        return len(self.tasks)

    def task(self, name: str) -> Task:
        """The task of this name; raises `TaskSetError`."""
        for task in self.tasks:
            if task.name == name:
                return task
        known = ", ".join(task.name for task in self.tasks)
        raise TaskSetError(f"there is no task '{name}'; there are: {known}")

    def by_priority(self) -> tuple[Task, ...]:
        """Most urgent first; equal priorities in the user's order."""
        return tuple(sorted(self.tasks, key=lambda task: -task.priority))

    def interfering(self, task: Task) -> tuple[Task, ...]:
        """The other tasks of at least the priority of `task`."""
        return tuple(
            other
            for other in self.by_priority()
            if other.priority >= task.priority and other.name != task.name
        )

    def lower(self, task: Task) -> tuple[Task, ...]:
        """The tasks of a lower priority than `task`."""
        return tuple(other for other in self.by_priority() if other.priority < task.priority)

    def with_task(self, changed: Task) -> TaskSet:
        """The set with the task of the same name exchanged."""
        tasks = (changed if task.name == changed.name else task for task in self.tasks)
        return TaskSet(tuple(tasks))

    def without_frames(self) -> TaskSet:
        """The set with each multiframe task as a plain one of its longest frame."""
        return TaskSet(tuple(replace(task, frames=()) for task in self.tasks))

    def with_priorities(self, most_urgent_first: Iterable[str]) -> TaskSet:
        """The set with distinct priorities in this order of names; n is the most urgent."""
        order = list(most_urgent_first)
        if sorted(order) != sorted(task.name for task in self.tasks):
            raise TaskSetError("the order of priorities must name each task once")
        rank = {name: len(order) - index for index, name in enumerate(order)}
        return TaskSet(tuple(replace(task, priority=rank[task.name]) for task in self.tasks))

    @property
    def utilization(self) -> Time:
        """Sum of C / T."""
        return exact(sum((Fraction(task.utilization) for task in self.tasks), Fraction(0)))

    @property
    def hyperperiod(self) -> Time:
        """Least common multiple of the periods, of multiframe tasks of their cycles."""
        return common_multiple(task.cycle for task in self.tasks)
