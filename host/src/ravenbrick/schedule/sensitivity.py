# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How far execution times and periods may change before a deadline can be missed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from ravenbrick.schedule.blocking import Blocking, time_on
from ravenbrick.schedule.demand import Window, window_of
from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet, TaskSetError
from ravenbrick.schedule.multiframe import least_span, most_execution
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schedule.response_time import is_schedulable

__all__ = [
    "ScalingLimit",
    "largest_factor",
    "largest_scaling",
    "largest_section_scaling",
    "largest_wcet",
    "least_period",
    "scaled",
    "slack_percent",
    "smallest_period",
    "with_period",
]

FINENESS = 1024
"""Parts of the present execution time in which slack is searched where no formula gives it."""
MOST_TIMES = 1_000
"""The search for slack ends at this many times the present execution time."""


@dataclass(frozen=True)
class ScalingLimit:
    """Largest factor on execution times, and the task whose deadline limits it.

    Below 1 the set is not schedulable as it is. None: no factor helps.
    """

    factor: Time | None
    limited_by: str


@dataclass(frozen=True)
class _Scaled:
    """A window in which the execution of some tasks is scaled: all of it, or (a time per job) their
    sections on one object."""

    window: Window
    parts: Mapping[str, Time | None]
    resource: str = ""

    def _split(self, task: Task, jobs: Time, work: Time, overhead: Time) -> tuple[Time, Time]:
        """Fixed and scaled part of the work of some jobs, each with its overhead."""
        part = self.parts.get(task.name, 0)
        scaled = work if part is None else jobs * part
        return jobs * overhead + work - scaled, scaled

    def _blocking(self, blocking: Blocking) -> tuple[Time, Time]:
        """A section scales with its task, or by what it has of the scaled object's sections."""
        if blocking.cause != "section" or blocking.task not in self.parts:
            return blocking.time, 0
        scaled = blocking.time if not self.resource else blocking.time_on(self.resource)
        return blocking.time - scaled, scaled

    def utilization(self) -> tuple[Fraction, Fraction]:
        """Fixed and scaled share of the processor."""
        window = self.window
        fixed, scaled = window.clock.utilization, Fraction(0)
        loads = [(window.task, window.own_overhead)]
        loads += [(source.task, source.overhead) for source in window.sources]
        for task, overhead in loads:
            jobs = Fraction(len(task.frames) or 1) / Fraction(task.cycle)
            plain, factor = self._split(task, jobs, task.utilization, overhead)
            fixed, scaled = fixed + plain, scaled + factor
        return fixed, scaled

    def demand(self, job: int, length: Time) -> tuple[Time, Time]:
        """Fixed and scaled work of jobs 0..`job` and their interference, without blocking."""
        window = self.window
        fixed, scaled = self._own(job)
        for source in window.sources:
            jobs, execution = source.work(length)
            plain, factor = self._split(source.task, jobs, execution, source.overhead)
            fixed, scaled = fixed + plain, scaled + factor
        return fixed + window.clock.time(length), scaled

    def _own(self, job: int) -> tuple[Time, Time]:
        """Fixed and scaled work of the task's own jobs 0..`job`."""
        task, jobs = self.window.task, job + 1
        return self._split(task, jobs, most_execution(task, jobs), self.window.own_overhead)

    def _rates(self) -> tuple[Fraction, Fraction]:
        """Fixed and scaled work of the interference per time, at least, in any window."""
        fixed, scaled = self.window.clock.utilization, Fraction(0)
        for source in self.window.sources:
            task, rate = source.task, source.rate
            execution = task.utilization if task.frames else rate * source.execution
            plain, factor = self._split(task, rate, execution, source.overhead)
            fixed, scaled = fixed + plain, scaled + factor
        return fixed, scaled

    def factor_of_job(self, job: int, enough: Fraction) -> Fraction | None:
        """Largest factor with which the job meets its deadline, or one that is `enough`; None when
        none does.

        The longest window comes first. With no more than the long-term load, the factor falls with
        the window; where even this one is not above the best, no shorter window can be.
        """
        task = self.window.task
        limit = task.deadline + least_span(task, job) - self.window.jitter
        own, own_scaled = self._own(job)
        rate, rate_scaled = self._rates()
        best: Fraction | None = None
        for length in self.window.steps(limit) if limit > 0 else ():
            left = length - length * rate - own
            needed = length * rate_scaled + own_scaled
            if left < 0 or (best is not None and (best >= enough or left <= best * needed)):
                break
            fixed, scaled = self.demand(job, length)
            found = None
            for blocking in self.window.blockings:
                plain, factor = self._blocking(blocking)
                room = length - fixed - plain
                if room < 0 or (scaled + factor == 0):
                    value = Fraction(-1) if room < 0 else _UNLIMITED
                else:
                    value = Fraction(room) / Fraction(scaled + factor)
                found = value if found is None else min(found, value)
            if found is not None and found >= 0 and (best is None or found > best):
                best = found
        return best

    def completion(self, job: int, factor: Fraction, start: Time) -> Time:
        """End of the job in the busy period with this factor."""
        length = max(start, self._work(job, factor, start))
        while (following := self._work(job, factor, length)) > length:
            length = following
        return length

    def _work(self, job: int, factor: Fraction, length: Time) -> Time:
        fixed, scaled = self.demand(job, length)
        blockings = (self._blocking(blocking) for blocking in self.window.blockings)
        return fixed + factor * scaled + max(plain + factor * more for plain, more in blockings)


_UNLIMITED = Fraction(10**9)


def _lower_factor(scaled: _Scaled, factor: Fraction) -> Fraction | None:
    """The largest factor up to `factor` with which the window's task meets its deadline."""
    task = scaled.window.task
    fixed, share = scaled.utilization()
    if fixed > 1 or (fixed == 1 and share):
        return None
    if share:
        factor = min(factor, (1 - fixed) / share)
    job, completion = 0, Fraction(0)
    repetition = scaled.window.repetition
    while True:
        found = scaled.factor_of_job(job, factor)
        if found is None:
            return None
        factor = min(factor, found)
        completion = Fraction(scaled.completion(job, factor, completion))
        job += 1
        if completion + scaled.window.jitter <= least_span(task, job):
            return factor
        if fixed + factor * share == 1 and least_span(task, job) >= repetition:
            return factor


def _limit(
    task_set: TaskSet, parts: Mapping[str, Time | None], overheads: Overheads, resource: str = ""
) -> ScalingLimit:
    factor, limited_by = _UNLIMITED, ""
    for task in task_set.by_priority():
        window = window_of(task_set, task, overheads)
        found = _lower_factor(_Scaled(window, parts, resource), factor)
        if found is None:
            return ScalingLimit(None, task.name)
        if found < factor:
            factor, limited_by = found, task.name
    return ScalingLimit(exact(factor), limited_by)


def largest_scaling(task_set: TaskSet, overheads: Overheads = NO_OVERHEADS) -> ScalingLimit:
    """Largest factor on all execution times with which all deadlines are met, exactly.

    Found at the scheduling points of each job of the busy period: the critical scaling factor of
    Lehoczky, Sha, Ding 1989 and Bini, Di Natale, Buttazzo 2008, with jitter, blocking (sections
    scale with their task) and overheads, which do not scale.
    """
    return _limit(task_set, dict.fromkeys(task.name for task in task_set), overheads)


def largest_wcet(
    task_set: TaskSet, name: str, overheads: Overheads = NO_OVERHEADS
) -> tuple[Time | None, str]:
    """Longest execution time of one task, its sections in proportion, that keeps all deadlines.

    Returns it with the task whose deadline limits it; None when none helps. The method is that of
    `largest_scaling`.
    """
    task = task_set.task(name)
    limit = _limit(task_set, {name: None}, overheads)
    factor = limit.factor
    return (None if factor is None else exact(factor * task.wcet)), limit.limited_by


def largest_section_scaling(
    task_set: TaskSet, resource: str, overheads: Overheads = NO_OVERHEADS
) -> ScalingLimit:
    """Largest factor on all sections on one object with which all deadlines are met, exactly.

    Each user's execution time and each blocking that contains such a section grow with it. The
    factor is `largest_scaling`'s for these parts (the slack of an operation in MAST). Raises
    `TaskSetError` for an object on which no task has a section.
    """
    parts = {
        task.name: time_on(task.sections, resource)
        for task in task_set
        if any(section.resource == resource for section in task.sections)
    }
    if not parts:
        known = sorted({section.resource for task in task_set for section in task.sections})
        raise TaskSetError(
            f"no task has a section on '{resource}'; sections are on: {', '.join(known) or 'none'}"
        )
    return _limit(task_set, parts, overheads, resource)


def slack_percent(limit: ScalingLimit) -> Time | None:
    """By how many percent the scaled execution may grow; negative below the present."""
    return None if limit.factor is None else exact((limit.factor - 1) * 100)


def smallest_period(
    task_set: TaskSet, name: str, step: Time, overheads: Overheads = NO_OVERHEADS
) -> Time | None:
    """Smallest multiple of `step` as period of one task that keeps all deadlines.

    A deadline equal to the period follows it. None when the set is not schedulable with the
    period as it is. Found by bisection, since response times never grow with a period
    (sustainability: Baruah, Burns 2006). Raises `TaskSetError` for a step that is not positive.
    """
    if step <= 0:
        raise TaskSetError(f"the step is {step}; expected more than 0", task=name, field="period")
    task = task_set.task(name)
    if not is_schedulable(task_set, overheads):
        return None

    return least_period(
        lambda period: is_schedulable(task_set.with_task(with_period(task, period)), overheads),
        task.period,
        step,
    )


def with_period(task: Task, period: Time) -> Task:
    """The task with another period, which a deadline equal to the period follows."""
    deadline = period if task.deadline == task.period else task.deadline
    return replace(task, period=exact(period), deadline=exact(deadline))


def least_period(feasible: Callable[[Time], bool], period: Time, step: Time) -> Time:
    """Smallest multiple of `step` that is feasible, by bisection; the present one if none below
    it is."""
    low, high = 0, int(period // step)
    if not high or not feasible(high * step):
        return period
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if feasible(middle * step) else (middle, high)
    return exact(high * step)


def scaled(task: Task, factor: Fraction) -> Task:
    """The task with its execution times and sections multiplied; its least time stays."""
    sections = tuple(
        replace(s, duration=s.duration * factor, start=s.start * factor) for s in task.sections
    )
    frames = tuple(replace(frame, wcet=exact(frame.wcet * factor)) for frame in task.frames)
    high = None if task.wcet_high is None else exact(task.wcet_high * factor)
    wcet = exact(task.wcet * factor)
    least = min(task.bcet, wcet, *(frame.wcet for frame in frames))
    return replace(
        task, wcet=wcet, wcet_high=high, sections=sections, frames=frames, bcet=least
    )  # fmt: skip


def largest_factor(feasible: Callable[[Fraction], bool], fineness: int = FINENESS) -> Time | None:
    """Largest factor that is feasible, a multiple of 1/`fineness`, by bisection, given that no
    factor is feasible above one that is not. None when none is."""
    low, high = 0, fineness
    while feasible(Fraction(high, fineness)):
        low, high = high, 2 * high
        if high > MOST_TIMES * fineness:
            return exact(Fraction(low, fineness))
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if feasible(Fraction(middle, fineness)) else (low, middle)
    return exact(Fraction(low, fineness)) if low else None
