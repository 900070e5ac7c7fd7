# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Servers: a budget each period for tasks whose requests come as they like.

To all other tasks a server is one periodic task. The tasks that it serves share its budget by
their own priorities.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from ravenbrick.schedule.demand import STEP_LIMIT, AnalysisLimitError, Window, window_of
from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet, TaskSetError
from ravenbrick.schedule.quantity import Time, ceiling, exact

__all__ = ["ServedBound", "Server", "largest_server_utilization", "served_response_time_bounds"]

Kind = Literal["polling", "deferrable", "sporadic"]
KINDS: tuple[Kind, ...] = ("polling", "deferrable", "sporadic")


@dataclass(frozen=True)
class Server:
    """A budget of `capacity` each `period`, used at `priority` by the `served` tasks.

    A polling server loses what is not asked for at its release. A deferrable server keeps its
    budget until the next period (Lehoczky, Sha, Strosnider 1987). A sporadic server gets what it
    used back one period after it became active (Sprunt, Sha, Lehoczky 1989).
    """

    name: str
    kind: Kind
    period: Time
    capacity: Time
    priority: int
    served: tuple[Task, ...] = ()

    def __post_init__(self) -> None:
        """Refuse what means nothing."""
        if self.kind not in KINDS:
            raise TaskSetError(
                f"is '{self.kind}'; expected one of {', '.join(KINDS)}",
                task=self.name,
                field="kind",
            )
        if exact(self.capacity) > exact(self.period):
            raise TaskSetError(
                f"is {self.capacity}, more than the period", task=self.name, field="capacity"
            )
        for task in self.served:
            for field in ("sections", "frames", "limits", "phase", "wcet_high"):
                if getattr(task, field):
                    raise TaskSetError(
                        "has no meaning for a task of a server", task=task.name, field=field
                    )

    @property
    def task(self) -> Task:
        """The server as others see it: a deferrable one may use the budget of two periods in a row,
        which is a release jitter of T - C (Strosnider, Lehoczky, Sha 1995; Bernat, Burns 1999)."""
        jitter = exact(self.period) - exact(self.capacity) if self.kind == "deferrable" else 0
        deadline = exact(self.period) + jitter
        return Task(
            self.name, self.period, self.capacity, self.priority, deadline, jitter,
            release="sporadic",
        )  # fmt: skip

    @property
    def pause(self) -> Time:
        """Longest time without budget for a request that comes at the worst instant."""
        period = exact(self.period)
        return period if self.kind == "polling" else exact(period - exact(self.capacity))


@dataclass(frozen=True)
class ServedBound:
    """Bound of the response time of a served task from its arrival; None when there is none."""

    task: Task
    server: str
    bound: Time | None

    @property
    def meets_deadline(self) -> bool:
        """Whether the bound is within the deadline."""
        return self.bound is not None and self.bound <= self.task.deadline


def _chunk(window: Window, execution: Time) -> Time:
    """Longest time from a replenishment until this much of the budget is used."""
    fixed = window.blocking.time + execution + window.own_overhead
    length = fixed
    for _ in range(STEP_LIMIT):
        following = fixed + window.interference(length)
        if following <= length:
            return length
        length = following
    raise AnalysisLimitError(f"'{window.task.name}' takes more than {STEP_LIMIT} steps")


def _served(server: Server, window: Window, task: Task, overheads: Overheads) -> Time | None:
    """Response-time bound of one of the server's tasks."""
    ahead = [t for t in server.served if t.name != task.name and t.priority >= task.priority]
    costs = {t.name: t.wcet + overheads.per_job(t) for t in (task, *ahead)}
    rate = sum(Fraction(costs[t.name]) / Fraction(t.period) for t in (task, *ahead))
    if rate >= Fraction(server.capacity) / Fraction(server.period):
        return None
    worst: Time = 0
    length: Time = 0
    for job in range(STEP_LIMIT):
        length = _completion(server, window, (task, job), ahead, costs, overheads, length)
        jitter = overheads.jitter(task)
        worst = max(worst, length - job * task.period + jitter)
        if length + jitter <= (job + 1) * task.period:
            return exact(worst)
    raise AnalysisLimitError(f"'{task.name}' takes more than {STEP_LIMIT} jobs of its server")


def _completion(
    server: Server,
    window: Window,
    job: tuple[Task, int],
    ahead: Sequence[Task],
    costs: dict[str, Time],
    overheads: Overheads,
    start: Time,
) -> Time:
    """End of a task's job, from the instant at which the budget is used up and all arrive."""
    task, number = job
    length = start
    for _ in range(STEP_LIMIT):
        work = (number + 1) * costs[task.name]
        for other in ahead:
            jobs = ceiling(max(length, 1) + overheads.jitter(other), other.period)
            work += jobs * costs[other.name]
        full = ceiling(work, server.capacity) - 1
        rest = exact(work - full * server.capacity)
        following = server.pause + full * server.period + _chunk(window, rest)
        if following <= length:
            return length
        length = exact(following)
    raise AnalysisLimitError(f"'{task.name}' takes more than {STEP_LIMIT} steps in its server")


def served_response_time_bounds(
    task_set: TaskSet, server: Server, overheads: Overheads = NO_OVERHEADS
) -> tuple[ServedBound, ...]:
    """Bounds of the server's tasks; `task_set` has all others and `server.task`.

    Work of L needs n = ceil(L / C) budgets. The first comes after the longest pause, T - C (T for a
    polling server), the next ones T apart, and the last one, of L - (n - 1) C, takes as long as
    more urgent tasks let it (Davis, Burns 2005, with each last budget at its own critical instant).
    Costs of switches are part of a served job. None where the budget does not suffice or is not
    always used up within its period. Raises `TaskSetError` for a sporadic server that can be
    blocked, since its budget may come in pieces, each of which is blocked.
    """
    window = window_of(task_set, task_set.task(server.name), overheads)
    if server.kind == "sporadic" and window.blocking.time:
        raise TaskSetError(
            f"can be blocked for {window.blocking.time}, again for each piece of its budget; "
            "use a deferrable server, or keep its priority above the ceilings",
            task=server.name,
            field="kind",
        )
    fits = window.utilization <= 1 and _chunk(window, server.capacity) <= server.period
    return tuple(
        ServedBound(task, server.name, _served(server, window, task, overheads) if fits else None)
        for task in sorted(server.served, key=lambda task: -task.priority)
    )


def largest_server_utilization(kind: Kind, task_set: TaskSet) -> float:
    """Utilisation of a server up to which rate monotonic priorities are safe with these tasks.

    With P the product of U_i + 1: (2 - P) / P for polling and sporadic servers, (2 - P) / (2 P - 1)
    for a deferrable one with the highest priority (hyperbolic bounds: Bini, Buttazzo, Buttazzo
    2003; Buttazzo 2011, equations 5.8, 5.15 and 5.24). 0 where nothing is left.
    """
    product = math.prod(Fraction(task.utilization) + 1 for task in task_set)
    left = (2 - product) / (2 * product - 1 if kind == "deferrable" else product)
    return float(max(left, Fraction(0)))
