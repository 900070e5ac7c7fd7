# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Quick tests by utilisation."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

from ravenbrick.schedule.model import TaskSet, TaskSetError
from ravenbrick.schedule.quantity import Time, exact

__all__ = [
    "hyperbolic_product",
    "liu_layland_bound",
    "passes_hyperbolic_bound",
    "passes_liu_layland_bound",
]


def liu_layland_bound(count: int) -> float:
    """n (2^(1/n) - 1), the least upper bound of utilisation of rate monotonic (Liu, Layland 1973).

    Raises `TaskSetError` for less than one task.
    """
    if count < 1:
        raise TaskSetError(f"a bound for {count} tasks does not exist; give at least 1")
    return float(count * math.expm1(math.log(2) / count))


def hyperbolic_product(task_set: TaskSet) -> Time:
    """Product of U_i + 1 (Bini, Buttazzo, Buttazzo 2003)."""
    return exact(
        math.prod((Fraction(task.utilization) + 1 for task in task_set), start=Fraction(1))
    )


def _needs_plain_rate_monotonic(task_set: TaskSet) -> bool:
    plain = all(
        task.deadline >= task.period
        and not task.release_jitter
        and not task.blocking
        and not task.sections
        and not task.frames
        for task in task_set
    )
    order = task_set.by_priority()
    return plain and all(a.period <= b.period for a, b in itertools.pairwise(order))


def passes_liu_layland_bound(task_set: TaskSet) -> bool:
    """Whether the set is schedulable by U <= n (2^(1/n) - 1); False proves nothing.

    Sufficient for independent tasks with D >= T under rate monotonic priorities (Liu, Layland
    1973); other sets never pass. The comparison is exact: (U / n + 1)^n <= 2.
    """
    count = len(task_set)
    mean = Fraction(task_set.utilization) / count
    return _needs_plain_rate_monotonic(task_set) and (1 + mean) ** count <= 2


def passes_hyperbolic_bound(task_set: TaskSet) -> bool:
    """Whether the set is schedulable by the product of U_i + 1 <= 2; False proves nothing.

    Sufficient under the conditions of `passes_liu_layland_bound` and never worse (Bini, Buttazzo,
    Buttazzo 2003).
    """
    return _needs_plain_rate_monotonic(task_set) and hyperbolic_product(task_set) <= 2
