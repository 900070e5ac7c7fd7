# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Assignment of fixed priorities. Each function returns a set with priorities n (top) to 1.

Interrupts keep their order above all tasks, since no task can be above them.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum

from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet
from ravenbrick.schedule.response_time import response_time_bound

__all__ = ["Rule", "audsley", "deadline_monotonic", "rate_monotonic"]


class Rule(StrEnum):
    """How priorities are assigned."""

    DECLARED = "declared"
    RATE_MONOTONIC = "rate_monotonic"
    DEADLINE_MONOTONIC = "deadline_monotonic"
    AUDSLEY = "audsley"


def _names(tasks: list[Task]) -> list[str]:
    return [task.name for task in tasks]


def _assigned(task_set: TaskSet, tasks: list[Task]) -> TaskSet:
    interrupts = [task for task in task_set.by_priority() if task.release == "interrupt"]
    return task_set.with_priorities(_names([*interrupts, *tasks]))


def _tasks(task_set: TaskSet) -> list[Task]:
    return [task for task in task_set if task.release != "interrupt"]


def rate_monotonic(task_set: TaskSet) -> TaskSet:
    """Shorter period, higher priority; equal periods in the user's order.

    Optimal for independent synchronous tasks with D = T (Liu, Layland 1973).
    """
    return _assigned(task_set, sorted(_tasks(task_set), key=lambda task: task.period))


def deadline_monotonic(task_set: TaskSet) -> TaskSet:
    """Shorter deadline less release jitter, higher priority; equal ones in the user's order.

    Optimal for D <= T without jitter (Leung, Whitehead 1982), and by D - J with jitter (Zuhily,
    Burns 2007). Not optimal for D > T: use `audsley`.
    """
    order = sorted(_tasks(task_set), key=lambda task: task.deadline - task.release_jitter)
    return _assigned(task_set, order)


Test = Callable[[TaskSet, Task, Overheads], bool]


def _meets_deadline(task_set: TaskSet, task: Task, overheads: Overheads) -> bool:
    return response_time_bound(task_set, task, overheads).meets_deadline


def audsley(
    task_set: TaskSet, overheads: Overheads = NO_OVERHEADS, test: Test = _meets_deadline
) -> TaskSet | None:
    """A feasible assignment by `test` (`response_time_bound`) if there is one, otherwise None.

    Fills the priorities from the bottom with the first task, latest deadline first, that meets
    its deadline there. Optimal because the bound depends on which tasks are more urgent, not on
    their order (Audsley 1991).
    """
    unassigned = _tasks(task_set)
    unassigned.sort(key=lambda task: -(task.deadline - task.release_jitter))
    assigned: list[Task] = []
    while unassigned:
        for candidate in unassigned:
            others = [task for task in unassigned if task.name != candidate.name]
            trial = _assigned(task_set, [*others, candidate, *assigned])
            if test(trial, trial.task(candidate.name), overheads):
                assigned.insert(0, candidate)
                unassigned = others
                break
        else:
            return None
    return _assigned(task_set, assigned)
