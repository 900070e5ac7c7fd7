# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""End-to-end delays along chains of tasks that pass data on."""

from __future__ import annotations

from collections.abc import Sequence

from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, TaskSet, TaskSetError
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schedule.response_time import response_time_bound

__all__ = ["sampled_chain_bound"]


def sampled_chain_bound(
    task_set: TaskSet, names: Sequence[str], overheads: Overheads = NO_OVERHEADS
) -> Time | None:
    """Bound of the delay from a change at the chain's input to its first effect at the output.

    Each task reads the latest value when it starts and writes when it ends. Every stage waits at
    most one period for its next arrival and then responds: the sum of T + R (Davare, Zhu, Di
    Natale, Pinello, Kanajan, Sangiovanni-Vincentelli 2007). None when a response time has no
    bound. For sporadic tasks T would have to be the longest separation, so they are refused.
    """
    if not names:
        raise TaskSetError("the chain is empty; name at least one task")
    total: Time = 0
    for name in names:
        task = task_set.task(name)
        if task.release != "cyclic":
            raise TaskSetError(
                f"is '{task.release}'; a sampled chain needs cyclic tasks",
                task=name,
                field="release",
            )
        found = response_time_bound(task_set, task, overheads)
        if found.bound is None:
            return None
        total += task.period + found.bound
    return exact(total)
