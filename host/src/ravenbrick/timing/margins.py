# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How far execution times and periods may change before a bound exceeds its deadline.

The bounds are those of the analysis, computed anew for each change, so a bound and its margin never
contradict. What is searched by bisection is a change with which all bounds meet their deadlines:
bounds that fell where execution grows would only make the margin smaller than it might be.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.schedule.model import Task
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schedule.sensitivity import (
    ScalingLimit,
    largest_factor,
    least_period,
    scaled,
    with_period,
)
from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.task_set.scheduled_tasks import Change

__all__ = ["largest_scaling", "longest_execution", "smallest_period"]

# Parts of the present execution time, and multiples of 0.1 ms, in which margins are searched.
FINENESS = 128
STEP = exact(MASTER_CLOCK.hertz / 10_000)


def _misses(analysis: Analysis, change: Change) -> list[str]:
    bounds = analysis.changed_bounds(change)
    return [name for name, bound in bounds.items() if not bound.meets_deadline]


def _of(name: str, change: Change) -> Change:
    return lambda task: change(task) if task.name == name else task


def _limit(analysis: Analysis, change: Callable[[Fraction], Change]) -> ScalingLimit:
    """Largest factor with whose change all deadlines are met."""
    missing: dict[Fraction, list[str]] = {}

    def feasible(factor: Fraction) -> bool:
        missing[factor] = _misses(analysis, change(factor))
        return not missing[factor]

    factor = largest_factor(feasible, FINENESS)
    above = Fraction(factor or 0) + Fraction(1, FINENESS)
    if above not in missing:
        feasible(above)
    return ScalingLimit(factor, next(iter(missing[above]), ""))


def largest_scaling(analysis: Analysis) -> ScalingLimit:
    """Largest factor on all execution times but those of the run-time."""
    return _limit(analysis, lambda factor: lambda task: scaled(task, factor))


def longest_execution(analysis: Analysis, name: str) -> tuple[Time | None, str]:
    """Longest execution of a job, suspensions included, and the task that limits it. What a job has
    more comes to each kind of its jobs; what it has less shortens the longest ones."""
    longest = analysis.task_set.task(name).wcet
    own = next(t.job.cycles for t in analysis.tasks if t.task.name == name)

    def change(factor: Fraction) -> Change:
        def longer(task: Task) -> Task:
            more = (factor - 1) * own
            return replace(
                task, wcet=task.wcet + more if more > 0 else min(task.wcet, longest + more)
            )

        return _of(name, longer)

    found = _limit(analysis, change)
    factor = found.factor
    return None if factor is None else longest + (factor - 1) * own, found.limited_by


def smallest_period(analysis: Analysis, name: str) -> Time | None:
    """Smallest multiple of 0.1 ms as period of a task with which all deadlines are met; with
    another period than its own it keeps no common release. None when one can be missed as it is."""
    if not analysis.schedulable:
        return None

    def feasible(period: Time) -> bool:
        changed = _of(name, lambda task: replace(with_period(task, period), phase=None))
        return not _misses(analysis, changed)

    return least_period(feasible, analysis.task_set.task(name).period, STEP)
