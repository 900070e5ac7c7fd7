# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Earliest deadline first, for comparison: processor demand and response times."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ravenbrick.schedule.demand import STEP_LIMIT, AnalysisLimitError
from ravenbrick.schedule.model import Task, TaskSet
from ravenbrick.schedule.quantity import Time, ceiling, exact

__all__ = ["earliest_deadline_bounds", "processor_demand", "processor_demand_test"]


@dataclass(frozen=True)
class DemandTest:
    """Result of the processor-demand test.

    Unless schedulable, `demand` (with `blocking`) exceeds the window `instant`; both are None when
    the utilisation is above 1. `checked` counts the instants looked at up to `limit`.
    """

    schedulable: bool
    checked: int
    limit: Time
    instant: Time | None = None
    demand: Time | None = None
    blocking: Time = 0


@dataclass(frozen=True)
class EarliestDeadlineBound:
    """Worst response time under earliest deadline first; None when there is no bound."""

    task: Task
    bound: Time | None

    @property
    def meets_deadline(self) -> bool:
        """Whether the bound is within the deadline."""
        return self.bound is not None and self.bound <= self.task.deadline


def _jobs_due(task: Task, instant: Time) -> int:
    """Jobs that arrive from -J on and are due at `instant` or earlier."""
    return max(0, (instant - task.deadline + task.release_jitter) // task.period + 1)


def processor_demand(task_set: TaskSet, instant: Time) -> Time:
    """Execution of all jobs that are released and due within a window of this length.

    h(t) = sum of max(0, floor((t - D + J) / T) + 1) C (Baruah, Rosier, Howell 1990).
    """
    return exact(sum(_jobs_due(task, instant) * task.wcet for task in task_set))


def stack_policy_blocking(task_set: TaskSet, instant: Time) -> Time:
    """Longest blocking of jobs due within `instant` under the stack resource policy.

    A section blocks if its task's deadline is beyond the window and its object is used at the
    preemption level, by relative deadline, of a task due within it or at a higher one (Baruah
    2006). Stated blocking counts for tasks due within it.
    """
    served = [task for task in task_set if task.deadline - task.release_jitter <= instant]
    level = max((task.deadline for task in served), default=-1)
    users = {s.resource for task in task_set if task.deadline <= level for s in task.sections}
    lengths = [task.blocking for task in served]
    lengths += [
        section.duration
        for task in task_set
        if task.deadline > instant
        for section in task.sections
        if section.resource in users
    ]
    return max(lengths, default=0)


def _busy_period(task_set: TaskSet, extra: Time = 0) -> Time:
    window: Time = extra + sum(task.wcet for task in task_set)
    for _ in range(STEP_LIMIT):
        following: Time = extra
        for task in task_set:
            following += ceiling(window + task.release_jitter, task.period) * task.wcet
        if following == window:
            return window
        window = following
    raise AnalysisLimitError(
        f"the busy period takes more than {STEP_LIMIT} steps; the utilisation is too close to 1"
    )


def _limit(task_set: TaskSet) -> Time:
    """Window beyond which a first overload cannot lie."""
    utilization = Fraction(task_set.utilization)
    longest = max(task.deadline - task.release_jitter for task in task_set)
    if utilization == 1:
        return exact(task_set.hyperperiod + max(longest, 0))
    excess = sum(
        (task.period - task.deadline + task.release_jitter) * Fraction(task.utilization)
        for task in task_set
    )
    return exact(min(max(longest, excess / (1 - utilization)), _busy_period(task_set)))


def _latest_due_before(task_set: TaskSet, instant: Time) -> Time | None:
    """Latest absolute deadline of a synchronous pattern strictly before `instant`."""
    found = [
        first + (ceiling(instant - first, task.period) - 1) * task.period
        for task in task_set
        if (first := task.deadline - task.release_jitter) < instant
    ]
    return max(found, default=None)


def _blocked(task_set: TaskSet) -> DemandTest | None:
    """The first overload among windows shorter than the longest deadline, with blocking."""
    longest = max(task.deadline for task in task_set)
    instants = set()
    for task in task_set:
        first = task.deadline - task.release_jitter
        if (longest - first) // task.period > STEP_LIMIT:
            raise AnalysisLimitError("deadlines and periods lie too far apart for this test")
        instants |= {first + k * task.period for k in range(int((longest - first) // task.period))}
        instants.add(first)
    for count, instant in enumerate(sorted(instants), 1):
        demand = processor_demand(task_set, instant)
        blocking = stack_policy_blocking(task_set, instant)
        if demand + blocking > instant:
            return DemandTest(False, count, exact(longest), exact(instant), demand, blocking)
    return None


def processor_demand_test(task_set: TaskSet) -> DemandTest:
    """Whether earliest deadline first meets all deadlines: h(t) <= t for all t.

    Exact for independent sporadic tasks; the windows are searched backwards by quick
    processor-demand analysis (Zhang, Burns 2009). With shared objects h(t) + B(t) <= t is
    sufficient (Baruah 2006). Each job of a multiframe task counts as its longest.
    """
    task_set = task_set.without_frames()
    if task_set.utilization > 1:
        return DemandTest(False, 0, 0)
    if any(task.sections or task.blocking for task in task_set):
        overload = _blocked(task_set)
        if overload is not None:
            return overload
    limit = _limit(task_set)
    earliest = min(task.deadline - task.release_jitter for task in task_set)
    instant = _latest_due_before(task_set, limit)
    if instant is None or instant < earliest:
        instant = earliest
    for checked in range(1, STEP_LIMIT):
        demand = processor_demand(task_set, instant)
        if demand > instant:
            return DemandTest(False, checked, limit, exact(instant), demand)
        if demand <= earliest:
            return DemandTest(True, checked, limit)
        if demand < instant:
            instant = demand
        else:
            before = _latest_due_before(task_set, instant)
            if before is None:
                return DemandTest(True, checked, limit)
            instant = before
    raise AnalysisLimitError(f"the demand test takes more than {STEP_LIMIT} steps")


def earliest_deadline_bounds(task_set: TaskSet) -> tuple[EarliestDeadlineBound, ...]:
    """Worst response time of each task, in the user's order.

    Deadline busy periods with every candidate arrival (Spuri 1996), with release jitter, and with
    the blocking of the stack resource policy. Exact for independent sporadic tasks without jitter.
    Each job of a multiframe task counts as its longest.
    """
    task_set = task_set.without_frames()
    utilization = task_set.utilization
    if utilization > 1:
        return tuple(EarliestDeadlineBound(task, None) for task in task_set)
    delayed = any(task.release_jitter or task.sections or task.blocking for task in task_set)
    if utilization == 1 and delayed:
        raise AnalysisLimitError(
            "the utilisation is 1 and there is jitter or blocking: the busy period never ends; "
            "reduce an execution time"
        )
    lengths = [section.duration for task in task_set for section in task.sections]
    lengths += [task.blocking for task in task_set]
    longest = _busy_period(task_set, max(lengths, default=0))
    return tuple(_earliest_deadline_bound(task_set, task, longest) for task in task_set)


def _candidates(task_set: TaskSet, task: Task, longest: Time) -> list[Time]:
    """Arrivals of the job under analysis at which its deadline meets another one."""
    found: set[Time] = set()
    for other in task_set:
        first = other.deadline - other.release_jitter - task.deadline
        earliest = max(0, ceiling(-task.release_jitter - first, other.period))
        latest = ceiling(longest - first, other.period)
        if latest - earliest > STEP_LIMIT:
            raise AnalysisLimitError("the busy period has too many jobs; reduce an execution time")
        found |= {first + k * other.period for k in range(earliest, latest)}
    return sorted(found)


def _earliest_deadline_bound(task_set: TaskSet, task: Task, longest: Time) -> EarliestDeadlineBound:
    others = [other for other in task_set if other.name != task.name]
    blocked = any(other.sections or other.blocking for other in task_set)
    worst: Time = task.wcet + task.release_jitter
    window: Time = 0
    for arrival in _candidates(task_set, task, longest):
        due = arrival + task.deadline
        jobs = (arrival + task.release_jitter) // task.period + 1
        blocking = stack_policy_blocking(task_set, due) if blocked else 0
        limits = [(other, _jobs_due(other, due)) for other in others]
        # Without blocking the window grows with the arrival: climb on from the last one.
        window = max(jobs * task.wcet, 0 if blocked else window)
        while True:
            following = blocking + jobs * task.wcet
            for other, limit in limits:
                released = ceiling(window + other.release_jitter, other.period)
                following += min(released, limit) * other.wcet
            if following <= window:
                break
            window = following
        worst = max(worst, window - arrival)
    return EarliestDeadlineBound(task, exact(worst))
