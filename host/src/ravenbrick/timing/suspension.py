# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Self-suspension inside jobs: where a job may wait, and for how long by the facts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import Task
from ravenbrick.timing.bounds import Bound, ExecutionTimeError
from ravenbrick.timing.facts import Facts, Operation, Suspension, annotations_of
from ravenbrick.timing.kernel import DELAY_UNTIL, ENTRY_CALL, SUSPEND

__all__ = ["suspension_of", "waits_inside", "with_operations"]

# Cycles that stand for one wait where waits are counted: more than any job takes.
WAIT = 10**12

Jobs = Sequence[tuple[Task, Bound]]


def waits_inside(job: Bound) -> frozenset[str]:
    """Where a job may wait before its end, without operations whose suspension is a fact."""
    return job.reached_inside & {ENTRY_CALL, SUSPEND, DELAY_UNTIL}


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
