# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Self-suspension inside jobs: where a job may wait, and for how long by the facts.

A sporadic task that waits in its own loop for an entry or suspension object and for a time is
released by both. It is judged by the longest execution from any of these waits to the next one of
the same kind, and taken to be released at most twice in each period, which every run checks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import Task
from ravenbrick.timing.bounds import Bound, ExecutionTimeError, JobQuestion
from ravenbrick.timing.facts.facts import Facts, Operation, Suspension, annotations_of
from ravenbrick.timing.kernel import DELAY_UNTIL, ENTRY_CALL, SUSPEND

__all__ = ["joined_releases", "suspension_of", "waits_inside", "with_operations"]

# Cycles that stand for one wait where waits are counted: more than any job takes.
WAIT = 10**12

Jobs = Sequence[tuple[Task, Bound]]


def waits_inside(job: Bound) -> frozenset[str]:
    """Where a job may wait before its end, without operations whose suspension is a fact."""
    return job.reached_inside & {ENTRY_CALL, SUSPEND, DELAY_UNTIL}


def joined_releases(
    task: Task, job: Bound, body: str, asked: Callable[[JobQuestion], Bound]
) -> Bound:
    """The job of a sporadic task that a delay in its own loop releases too; other jobs as they are.

    `asked` bounds the jobs of a question.
    """
    if task.release != "sporadic" or DELAY_UNTIL not in job.reached_inside:
        return job
    try:
        timed = asked((body, (DELAY_UNTIL,), ()))
    except ExecutionTimeError:
        return job
    urgencies = dict(sorted((*job.critical_sections, *timed.critical_sections)))
    longer = timed if timed.cycles > job.cycles else job
    return replace(
        longer,
        critical_sections=tuple(urgencies.items()),
        reached=job.reached | timed.reached,
        reached_inside=(job.reached_inside - {DELAY_UNTIL})
        | (timed.reached_inside - job.released_by),
        released_by=job.released_by | timed.released_by,
    )


def suspension_of(facts: Facts, task: Task, job: Bound) -> tuple[int, int]:
    """Longest suspension of a job in cycles, and how often it waits.

    Raises `ExecutionTimeError` for a job that may wait when no fact says for how long.
    """
    stated = facts.suspension(task.name)
    if stated is not None:
        return MASTER_CLOCK.cycles_of_us(stated.longest_us), stated.count
    waiting = sorted(waits_inside(job))
    if waiting:
        raise ExecutionTimeError(
            f"a job of '{task.name}' may wait in {waiting[0]}; say in {facts.name} for how long at "
            f'most: [[suspension]] task = "{task.name}", longest_us = ..., reason = "..."'
        )
    return 0, 0


def _added(operations: Sequence[Operation], cycles: Callable[[Operation], int]) -> str:
    rows = [{"symbol": one.symbol, "added_cycles": cycles(one)} for one in operations]
    return annotations_of({"cost": rows})


def with_operations(
    facts: Facts, jobs: Jobs, bounded: Callable[[Sequence[tuple[str, str]]], Jobs]
) -> Facts:
    """The facts with the suspension of each job that calls waiting operations.

    A job is bounded again with the time of each wait added to the calls, and with a number that
    counts them, so each is the largest sum over the paths of the job; `jobs` are those without.
    """
    names = {one.symbol for one in facts.operations}
    if not any(names & job.reached for _, job in jobs):
        return facts
    long = bounded(
        [
            (
                "suspensions",
                _added(facts.operations, lambda one: MASTER_CLOCK.cycles_of_us(one.longest_us)),
            )
        ]
    )
    counted = bounded([("waits", _added(facts.operations, lambda one: one.count * WAIT))])
    found = []
    for (task, job), (_, longer), (_, waits) in zip(jobs, long, counted, strict=True):
        suspended_us = (longer.cycles - job.cycles) * 1_000_000 / MASTER_CLOCK.hertz
        if names & job.reached and not waits_inside(waits):
            count = waits.cycles // WAIT
            reason = "the operations that it calls"
            found.append(Suspension(task.name, count, math.ceil(suspended_us), reason))
    return replace(facts, suspensions=(*facts.suspensions, *found))
