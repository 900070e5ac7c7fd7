# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How far execution times and periods may change before a deadline can be missed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from ravenbrick.schedule.blocking import Blocking
from ravenbrick.schedule.demand import Window, window_of
from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, TaskSet, TaskSetError
from ravenbrick.schedule.quantity import Time, common_multiple, exact
from ravenbrick.schedule.response_time import is_schedulable

__all__ = ["largest_scaling", "largest_wcet", "smallest_period"]


@dataclass(frozen=True)
class ScalingLimit:
    """Largest factor on execution times, and the task whose deadline limits it.

    Below 1 the set is not schedulable as it is. None: no factor helps.
    """

    factor: Time | None
    limited_by: str


@dataclass(frozen=True)
class _Scaled:
    """A window in which the execution of the `names` is scaled."""

    window: Window
    names: frozenset[str]

    def _split(self, name: str, execution: Time, overhead: Time) -> tuple[Time, Time]:
        return (overhead, execution) if name in self.names else (overhead + execution, 0)

    def _blocking(self, blocking: Blocking) -> tuple[Time, Time]:
        scaled = blocking.cause == "section" and blocking.task in self.names
        return (0, blocking.time) if scaled else (blocking.time, 0)

    def utilization(self) -> tuple[Fraction, Fraction]:
        """Fixed and scaled share of the processor."""
        window = self.window
        fixed, scaled = window.clock.utilization, Fraction(0)
        loads = [(window.task, window.own_overhead)]
        loads += [(source.task, source.overhead) for source in window.sources]
        for task, overhead in loads:
            plain, factor = self._split(task.name, task.wcet, overhead)
            fixed += Fraction(plain) / Fraction(task.period)
            scaled += Fraction(factor) / Fraction(task.period)
        return fixed, scaled

    def demand(self, job: int, length: Time) -> tuple[Time, Time]:
        """Fixed and scaled work of jobs 0..`job` and their interference, without blocking."""
        window = self.window
        fixed, scaled = self._split(window.task.name, window.task.wcet, window.own_overhead)
        fixed, scaled = (job + 1) * fixed, (job + 1) * scaled
        for source in window.sources:
            plain, factor = self._split(source.task.name, source.execution, source.overhead)
            count = source.jobs(length)
            fixed, scaled = fixed + count * plain, scaled + count * factor
        return fixed + window.clock.time(length), scaled

    def _rates(self) -> tuple[Fraction, Fraction]:
        """Fixed and scaled work of the interference per time, at least, in any window."""
        fixed, scaled = self.window.clock.utilization, Fraction(0)
        for source in self.window.sources:
            plain, factor = self._split(source.task.name, source.execution, source.overhead)
            fixed, scaled = fixed + source.rate * plain, scaled + source.rate * factor
        return fixed, scaled

    def factor_of_job(self, job: int, enough: Fraction) -> Fraction | None:
        """Largest factor with which the job meets its deadline, or one that is `enough`; None when
        none does.

        The longest window comes first. With no more than the long-term load, the factor falls with
        the window; where even this one is not above the best, no shorter window can be.
        """
        task = self.window.task
        limit = task.deadline + job * task.period - self.window.jitter
        own, own_scaled = self._split(task.name, task.wcet, self.window.own_overhead)
        rate, rate_scaled = self._rates()
        best: Fraction | None = None
        for length in self.window.steps(limit) if limit > 0 else ():
            left = length - length * rate - (job + 1) * own
            needed = length * rate_scaled + (job + 1) * own_scaled
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
    periods = [task.period, *(source.period for source in scaled.window.sources)]
    repetition = common_multiple([*periods, *scaled.window.clock.periods()])
    while True:
        found = scaled.factor_of_job(job, factor)
        if found is None:
            return None
        factor = min(factor, found)
        completion = Fraction(scaled.completion(job, factor, completion))
        if completion + scaled.window.jitter <= (job + 1) * task.period:
            return factor
        job += 1
        if fixed + factor * share == 1 and job * task.period >= repetition:
            return factor


def _limit(task_set: TaskSet, names: frozenset[str], overheads: Overheads) -> ScalingLimit:
    factor, limited_by = _UNLIMITED, ""
    for task in task_set.by_priority():
        found = _lower_factor(_Scaled(window_of(task_set, task, overheads), names), factor)
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
    return _limit(task_set, frozenset(task.name for task in task_set), overheads)


def largest_wcet(
    task_set: TaskSet, name: str, overheads: Overheads = NO_OVERHEADS
) -> tuple[Time | None, str]:
    """Longest execution time of one task, its sections in proportion, that keeps all deadlines.

    Returns it with the task whose deadline limits it; None when none helps. The method is that of
    `largest_scaling`.
    """
    task = task_set.task(name)
    limit = _limit(task_set, frozenset({name}), overheads)
    factor = limit.factor
    return (None if factor is None else exact(factor * task.wcet)), limit.limited_by


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

    def feasible(count: int) -> bool:
        period = count * step
        deadline = period if task.deadline == task.period else task.deadline
        changed = replace(task, period=exact(period), deadline=exact(deadline))
        return is_schedulable(task_set.with_task(changed), overheads)

    low, high = 0, int(task.period // step)
    if not high or not feasible(high):
        return task.period
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if feasible(middle) else (middle, high)
    return exact(high * step)
