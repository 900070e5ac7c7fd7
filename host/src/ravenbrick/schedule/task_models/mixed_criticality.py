# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Adaptive mixed criticality: tasks of low criticality stop when one of high criticality takes
longer than its ordinary execution time (Baruah, Burns, Davis 2011)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from ravenbrick.schedule.demand import STEP_LIMIT, AnalysisLimitError, Source, Window, window_of
from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet, TaskSetError
from ravenbrick.schedule.quantity import Time, ceiling, exact
from ravenbrick.schedule.response_time import response_time_bound

__all__ = [
    "Method",
    "MixedCriticalityBound",
    "is_mixed",
    "meets_deadlines",
    "mixed_criticality_bounds",
]

Method = Literal["amc_max", "amc_rtb"]
METHODS: tuple[Method, ...] = ("amc_max", "amc_rtb")


@dataclass(frozen=True)
class MixedCriticalityBound:
    """Response-time bounds of a task: `low` while all keep to their `wcet`, `high` in any case.

    `high` is None for a task of low criticality, which then may be stopped. `low` or `high` of a
    task that can miss its deadline is None.
    """

    task: Task
    low: Time | None
    high: Time | None
    method: Method

    @property
    def meets_deadline(self) -> bool:
        """Whether the task is in time in each mode in which it has to be."""
        return self.low is not None and (self.task.wcet_high is None or self.high is not None)


def is_mixed(task_set: TaskSet) -> bool:
    """Whether a task is of high criticality."""
    return any(task.wcet_high is not None for task in task_set)


def _check(task_set: TaskSet) -> None:
    for task in task_set:
        if task.deadline > task.period:
            raise TaskSetError(
                f"is {task.deadline}, longer than the period; mixed criticality needs D <= T",
                task=task.name,
                field="deadline",
            )
        for field in ("frames", "limits"):
            if getattr(task, field):
                raise TaskSetError(
                    "does not go with tasks of high criticality", task=task.name, field=field
                )


@dataclass(frozen=True)
class _HighMode:
    """The window of a task of high criticality in which the mode changes."""

    window: Window
    low_window: Time

    def _split(self) -> tuple[list[Source], list[Source]]:
        high = [source for source in self.window.sources if source.task.wcet_high is not None]
        return high, [source for source in self.window.sources if source not in high]

    def _fixed(self) -> Time:
        wcet_high = self.window.task.wcet_high or 0
        return self.window.blocking.time + wcet_high + self.window.own_overhead

    def _completion(self, interference: Callable[[Time], Time]) -> Time | None:
        """End of the job, None when it is beyond the deadline."""
        limit = self.window.task.deadline - self.window.jitter
        fixed = self._fixed()
        length = fixed
        for _ in range(STEP_LIMIT):
            if length > limit:
                return None
            following = fixed + interference(length) + self.window.clock.time(length)
            if following <= length:
                return length
            length = following
        raise AnalysisLimitError(f"'{self.window.task.name}' takes more than {STEP_LIMIT} steps")

    def response_time_bound(self) -> Time | None:
        """AMC-rtb: less critical tasks interfere until the task's response time in the low mode."""
        high, low = self._split()
        until_change = sum(
            source.work(self.low_window)[0] * (source.execution + source.overhead) for source in low
        )
        return self._completion(
            lambda length: (
                until_change
                + sum(
                    source.work(length)[0] * ((source.task.wcet_high or 0) + source.overhead)
                    for source in high
                )
            )
        )

    def largest_over_changes(self) -> Time | None:
        """AMC-max: the longest of the responses for a change of mode at each instant at which it
        can matter, the releases of less critical tasks."""
        high, low = self._split()
        changes: set[Time] = {0}
        for source in low:
            first = ceiling(source.jitter, source.period)
            last = ceiling(self.low_window + source.jitter, source.period)
            changes |= {k * source.period - source.jitter for k in range(first, last)}
        found = [self._with_change(high, low, change) for change in sorted(changes)]
        times = [time for time in found if time is not None]
        return max(times) if len(times) == len(found) else None

    def _with_change(self, high: list[Source], low: list[Source], change: Time) -> Time | None:
        until_change: Time = 0
        for source in low:
            jobs = (change + source.jitter) // source.period + 1
            until_change += jobs * (source.execution + source.overhead)

        def interference(length: Time) -> Time:
            total = until_change
            for source in high:
                jobs, execution = source.work(length)
                task = source.task
                long = ceiling(length - change - (task.period - task.deadline), task.period) + 1
                longer = min(max(long, 0), jobs) * ((task.wcet_high or 0) - source.execution)
                total += execution + jobs * source.overhead + longer
            return total

        return self._completion(interference)


def _bound(
    task_set: TaskSet, task: Task, overheads: Overheads, method: Method
) -> MixedCriticalityBound:
    found = response_time_bound(task_set, task, overheads)
    low = found.bound if found.meets_deadline else None
    if low is None or task.wcet_high is None:
        return MixedCriticalityBound(task, low, None, method)
    window = window_of(task_set, task, overheads)
    mode = _HighMode(window, low - window.jitter)
    length = mode.response_time_bound() if method == "amc_rtb" else mode.largest_over_changes()
    high = None if length is None else exact(max(length + window.jitter, low))
    return MixedCriticalityBound(task, low, high, method)


def meets_deadlines(method: Method) -> Callable[[TaskSet, Task, Overheads], bool]:
    """Test of one task for Audsley's assignment, in each mode in which it has to be in time."""

    def test(task_set: TaskSet, task: Task, overheads: Overheads) -> bool:
        return _bound(task_set, task, overheads, method).meets_deadline

    return test


def mixed_criticality_bounds(
    task_set: TaskSet, overheads: Overheads = NO_OVERHEADS, method: Method = "amc_max"
) -> tuple[MixedCriticalityBound, ...]:
    """Bounds of all tasks, most urgent first, for D <= T.

    In the low mode all tasks execute for at most `wcet`. If one of high criticality takes longer,
    releases of the others are dropped and those of high criticality take up to `wcet_high`. For an
    interval t in which the mode changes at s, AMC-max counts (floor((s + J) / T) + 1) C of the less
    critical tasks, and M C(HI) + (n - M) C(LO) of the others, with n = ceil((t + J) / T) and M =
    min(ceil((t - s - (T - D)) / T) + 1, n); AMC-rtb counts the less critical tasks up to the
    response time in the low mode, and all jobs of the others with C(HI) (Baruah, Burns, Davis
    2011). Blocking and costs of the run-time are the same in both modes. Raises `TaskSetError`.
    """
    _check(task_set)
    return tuple(_bound(task_set, task, overheads, method) for task in task_set.by_priority())
