# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A task set with servers, transactions and criticalities, analysed as one."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet
from ravenbrick.schedule.offsets import phased_response_time_bounds
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schedule.response_time import ResponseTimeBound
from ravenbrick.schedule.sensitivity import (
    largest_factor,
    largest_scaling,
    largest_wcet,
    scaled,
)
from ravenbrick.schedule.task_models.mixed_criticality import (
    Method,
    MixedCriticalityBound,
    is_mixed,
    mixed_criticality_bounds,
)
from ravenbrick.schedule.task_models.servers import (
    ServedBound,
    Server,
    served_response_time_bounds,
)
from ravenbrick.schedule.task_models.transactions import Chained, Transaction, chained

__all__ = ["Solution", "System"]


@dataclass(frozen=True)
class Solution:
    """All bounds of a system; those of `bounds` are None where chains of releases do not settle."""

    task_set: TaskSet
    bounds: tuple[ResponseTimeBound, ...]
    served: tuple[ServedBound, ...]
    mixed: tuple[MixedCriticalityBound, ...]
    chains: Chained | None

    @property
    def schedulable(self) -> bool:
        """Whether every bound is within its deadline."""
        return (
            all(found.meets_deadline for found in self.bounds)
            and all(found.meets_deadline for found in self.served)
            and all(found.meets_deadline for found in self.mixed)
        )


@dataclass(frozen=True)
class System:
    """`task_set` has the tasks that the processor serves by priority and each server's task."""

    task_set: TaskSet
    overheads: Overheads = NO_OVERHEADS
    servers: tuple[Server, ...] = ()
    transactions: tuple[Transaction, ...] = ()
    method: Method = "amc_max"

    @property
    def is_plain(self) -> bool:
        """Whether the system is a task set and nothing else."""
        return not (self.servers or self.transactions or is_mixed(self.task_set))

    @cached_property
    def solution(self) -> Solution:
        """All bounds. Raises `TaskSetError` for models that do not go together."""
        task_set, chains = self.task_set, None
        if self.transactions:
            chains = chained(task_set, self.transactions, self.overheads)
            task_set = chains.task_set
        bounds = phased_response_time_bounds(task_set, self.overheads)
        if chains is not None and not chains.converged:
            bounds = tuple(ResponseTimeBound(found.task, None) for found in bounds)
        served = tuple(
            found
            for server in self.servers
            for found in served_response_time_bounds(task_set, server, self.overheads)
        )
        mixed: tuple[MixedCriticalityBound, ...] = ()
        if is_mixed(task_set):
            mixed = mixed_criticality_bounds(task_set, self.overheads, self.method)
        return Solution(task_set, bounds, served, mixed, chains)

    def scaled(self, factor: Fraction, names: Collection[str] | None = None) -> System:
        """The system with the execution times of some tasks (or of all, but not the capacities of
        servers) multiplied; a server that is named has its capacity multiplied."""
        server_names = {server.name for server in self.servers}

        def changed(task: Task) -> Task:
            named = task.name not in server_names if names is None else task.name in names
            return scaled(task, factor) if named else task

        servers = []
        tasks = {task.name: changed(task) for task in self.task_set}
        for server in self.servers:
            served = tuple(changed(task) for task in server.served)
            server = replace(server, served=served)
            if names is not None and server.name in names:
                server = replace(server, capacity=exact(server.capacity * factor))
                priority = self.task_set.task(server.name).priority
                tasks[server.name] = replace(server.task, priority=priority)
            servers.append(server)
        return replace(self, task_set=TaskSet(tuple(tasks.values())), servers=tuple(servers))

    def largest_factor(self, names: Collection[str] | None = None) -> Time | None:
        """Largest factor on execution times with which all deadlines are met, in steps of 1/1024.

        By bisection, since bounds never fall when execution times grow. None when none helps.
        """
        return largest_factor(lambda factor: self.scaled(factor, names).feasible)

    @property
    def feasible(self) -> bool:
        """Whether the system is schedulable; one that cannot be built is not."""
        if any(server.capacity > server.period for server in self.servers):
            return False
        return self.solution.schedulable

    def scaling(self) -> tuple[Time | None, str]:
        """Largest factor on all execution times, and the task that limits it ("" if unknown)."""
        if self.is_plain:
            limit = largest_scaling(self.task_set, self.overheads)
            return limit.factor, limit.limited_by
        return self.largest_factor(), ""

    def longest_execution(self, task: Task) -> tuple[Time | None, str]:
        """Longest execution time of one task, and the task that limits it ("" if unknown)."""
        if self.is_plain:
            return largest_wcet(self.task_set, task.name, self.overheads)
        factor = self.largest_factor({task.name})
        return (None if factor is None else exact(factor * task.wcet)), ""
