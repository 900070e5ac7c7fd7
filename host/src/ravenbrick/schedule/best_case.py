# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Best-case response times under preemptive fixed priorities, and the jitter of outputs."""

from __future__ import annotations

from dataclasses import dataclass

from ravenbrick.schedule.demand import STEP_LIMIT, AnalysisLimitError
from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet
from ravenbrick.schedule.quantity import Time, ceiling, exact
from ravenbrick.schedule.response_time import response_time_bound

__all__ = ["OutputJitter", "best_case_response_time", "output_jitter"]


@dataclass(frozen=True)
class OutputJitter:
    """Least and longest response time of a task from the arrival; None when there is no bound."""

    task: Task
    best: Time
    worst: Time | None

    @property
    def jitter(self) -> Time | None:
        """How far the ends of two jobs can lie apart, each from its arrival."""
        return None if self.worst is None else exact(self.worst - self.best)


def _ahead(task_set: TaskSet, task: Task) -> list[Task]:
    """The tasks that must run ahead of `task`: cyclic ones of a higher priority. Others may stay
    away, and one of the same priority need not be ahead in the queue."""
    return [
        other
        for other in task_set
        if other.priority > task.priority and other.release == "cyclic" and not other.frames
    ]


def best_case_response_time(
    task_set: TaskSet, task: Task, overheads: Overheads = NO_OVERHEADS
) -> Time:
    """Least response time of `task` from its arrival, with the least execution times `bcet`.

    The largest R = C + sum over the more urgent cyclic tasks j of max(0, ceil((R - J_j) / T_j) - 1)
    C_j, found from above: the job ends as all of them are released again, after their longest
    jitter (Redell, Sanfridson 2002; Bril, Steffens, Verhaegh 2004). Exact for independent cyclic
    tasks with unknown phases that end before their next arrival, once all tasks run: a job before
    may be shorter. A task that may end later counts with its least execution time alone, which is
    never too long. Overheads are left out, since they only delay.
    """
    worst = response_time_bound(task_set, task, overheads).bound
    if worst is None or worst > task.period:
        return task.bcet
    ahead = _ahead(task_set, task)
    response = worst
    for _ in range(STEP_LIMIT):
        following = task.bcet
        for other in ahead:
            jobs = max(0, ceiling(response - overheads.jitter(other), other.period) - 1)
            following += jobs * other.bcet
        if following == response:
            return exact(response)
        response = following
    raise AnalysisLimitError(f"the best case of '{task.name}' takes more than {STEP_LIMIT} steps")


def output_jitter(
    task_set: TaskSet, overheads: Overheads = NO_OVERHEADS
) -> tuple[OutputJitter, ...]:
    """Best and worst response time of each task, most urgent first."""
    found = []
    for task in task_set.by_priority():
        worst = response_time_bound(task_set, task, overheads).bound
        found.append(OutputJitter(task, best_case_response_time(task_set, task, overheads), worst))
    return tuple(found)
