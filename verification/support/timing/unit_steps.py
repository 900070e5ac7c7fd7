# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Schedules in steps of one unit: servers, modes of criticality and chains as they are defined.

Independent of `ravenbrick.schedule.simulation` and of every formula; times are whole numbers.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ravenbrick.schedule import Task, TaskSet
from ravenbrick.schedule.task_models.servers import Server

__all__ = ["Finished", "Request", "chain_ends", "served", "with_modes"]


@dataclass
class Request:
    """A job: `execution` that arrives at `arrival`; `limit` is the budget of its ordinary mode."""

    task: str
    arrival: int
    execution: int
    priority: int
    critical: bool = True
    limit: int = 0
    done: int = 0


@dataclass(frozen=True)
class Finished:
    """A job that ended, and whether it ended before any change of mode."""

    task: str
    arrival: int
    end: int
    ordinary: bool = True


@dataclass
class _Budget:
    """What a server may use, by its author's rules."""

    server: Server
    left: int = 0
    returns: list[tuple[int, int]] = field(default_factory=list)
    active_since: int | None = None
    used: int = 0

    def begin(self, now: int, waiting: bool) -> None:
        """Replenish at the beginning of a step."""
        server = self.server
        if server.kind != "sporadic":
            if now % server.period == 0:
                self.left = int(server.capacity)
        else:
            self.left += sum(amount for instant, amount in self.returns if instant == now)
        if server.kind == "polling" and not waiting:
            self.left = 0

    def note(self, now: int, active: bool) -> None:
        """A sporadic server becomes active or idle (Sprunt, Sha, Lehoczky 1989)."""
        if self.active_since is not None and (not active or self.left == 0):
            self.returns.append((self.active_since + int(self.server.period), self.used))
            self.active_since, self.used = None, 0
        if active and self.active_since is None and self.left > 0:
            self.active_since = now

    def use(self) -> None:
        self.left -= 1
        self.used += 1


def served(
    server: Server,
    tasks: Sequence[Task],
    requests: Sequence[Request],
    end: int,
    phases: Mapping[str, int],
) -> tuple[list[Finished], _Budget]:
    """Ends of requests to a server and of jobs of periodic tasks; the server's budget at last."""
    budget = _Budget(server)
    if server.kind == "sporadic":
        budget.left = int(server.capacity)
    pending: list[Request] = []
    ready: list[Request] = []
    finished = []
    for now in range(end):
        for task in tasks:
            since = now - phases.get(task.name, 0)
            if since >= 0 and since % task.period == 0:
                ready.append(Request(task.name, now, int(task.wcet), task.priority))
        pending += [request for request in requests if request.arrival == now]
        budget.begin(now, bool(pending))
        urgent = max(ready, key=lambda job: (job.priority, -job.arrival), default=None)
        own = bool(pending) and budget.left > 0
        own = own and (urgent is None or urgent.priority < server.priority)
        above = urgent is not None and urgent.priority > server.priority
        if server.kind == "sporadic":
            budget.note(now, own or above)
        if own:
            job = max(pending, key=lambda one: (one.priority, -one.arrival))
            budget.use()
        elif urgent is None:
            continue
        else:
            job = urgent
        job.done += 1
        if job.done == job.execution:
            (pending if own else ready).remove(job)
            finished.append(Finished(job.task, job.arrival, now + 1))
        if own and server.kind == "polling" and not pending:
            budget.left = 0
    return finished, budget


def with_modes(jobs: Sequence[Request], end: int) -> list[Finished]:
    """Ends of jobs under adaptive mixed criticality.

    Once a job has executed for its `limit` without ending, jobs that are not critical and arrive
    from then on are dropped, until the processor is idle.
    """
    waiting = sorted(jobs, key=lambda job: job.arrival)
    ready: list[Request] = []
    finished = []
    ordinary = True
    for now in range(end):
        while waiting and waiting[0].arrival == now:
            job = waiting.pop(0)
            if ordinary or job.critical:
                ready.append(job)
        if not ready:
            ordinary = True
            continue
        job = max(ready, key=lambda one: (one.priority, -one.arrival))
        job.done += 1
        if job.done == job.execution:
            ready.remove(job)
            finished.append(Finished(job.task, job.arrival, now + 1, ordinary))
        elif job.done == job.limit:
            ordinary = False
    return finished


def chain_ends(
    task_set: TaskSet, chains: Sequence[tuple[str, ...]], dice: random.Random, end: int
) -> list[tuple[tuple[str, ...], int]]:
    """Each chain with its response times, where the end of a task releases the next one.

    Phases are random or all 0; execution times lie between least and longest. What is released at
    an instant competes in the step that begins there.
    """
    together = dice.random() < 0.5
    following = {chain[k]: chain[k + 1] for chain in chains for k in range(len(chain) - 1)}
    chain_of = {name: chain for chain in chains for name in chain}
    later = {name for chain in chains for name in chain[1:]}
    longest = dice.random() < 0.5
    phases = {t.name: 0 if together else dice.randrange(int(t.period)) for t in task_set}
    ready: list[Request] = []
    ends = []

    def release(name: str, event: int) -> None:
        task = task_set.task(name)
        least = max(1, int(task.bcet))
        execution = int(task.wcet) if longest else dice.randint(least, int(task.wcet))
        ready.append(Request(name, event, execution, task.priority))

    for now in range(end):
        for task in task_set:
            since = now - phases[task.name]
            if task.name not in later and since >= 0 and since % task.period == 0:
                release(task.name, now)
        if not ready:
            continue
        job = max(ready, key=lambda one: (one.priority, -one.arrival))
        job.done += 1
        if job.done == job.execution:
            ready.remove(job)
            if job.task in following:
                release(following[job.task], job.arrival)
            elif job.task in chain_of:
                ends.append((chain_of[job.task], now + 1 - job.arrival))
    return ends
