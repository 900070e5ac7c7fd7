# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Transactions: tasks that release one another, with one deadline from end to end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal

from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, TaskSet, TaskSetError
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schedule.response_time import response_time_bound

__all__ = ["Assigned", "Chained", "Rule", "Transaction", "assign_deadlines", "chained"]

Rule = Literal["proportional", "hopa"]
RULES: tuple[Rule, ...] = ("proportional", "hopa")
MOST_ROUNDS = 1_000
HOPA_ROUNDS = 12
HOPA_DAMPING = (Fraction(2), Fraction(3), Fraction(3, 2), Fraction(10))
"""Values of k_a tried in turn: the greater, the smaller the steps."""
FINEST = 10**6
"""Largest denominator of an assigned deadline, in parts of the transaction's."""


@dataclass(frozen=True)
class Transaction:
    """Tasks of which each one is released when the one before it ends; the first by its event."""

    name: str
    tasks: tuple[str, ...]
    deadline: Time

    def check(self, task_set: TaskSet) -> None:
        """Refuse tasks that cannot release one another. Raises `TaskSetError`."""
        if not self.tasks or len(set(self.tasks)) < len(self.tasks):
            raise TaskSetError("expected each task once", task=self.name, field="tasks")
        first = task_set.task(self.tasks[0])
        for task in (task_set.task(name) for name in self.tasks):
            if task.frames or task.phase is not None:
                field = "frames" if task.frames else "phase"
                raise TaskSetError("has no meaning in a transaction", task=task.name, field=field)
            if task.period != first.period:
                raise TaskSetError(
                    f"is {task.period}, but '{first.name}', which begins the transaction, has "
                    f"{first.period}",
                    task=task.name,
                    field="period",
                )
            follows = task.name != first.name
            if follows and (task.release != "sporadic" or task.release_jitter):
                raise TaskSetError(
                    "a task that another one releases is 'sporadic' and has no jitter of its own",
                    task=task.name,
                    field="release",
                )


@dataclass(frozen=True)
class Chained:
    """A task set in which the tasks of transactions have the jitter of what releases them.

    A later task's arrival is the earliest end of the one before it, its deadline what is then left
    of the whole one. `responses` are bounds from the event to the end of each transaction, None
    when there is none (then `converged` is False). `earliest` is each one's least time.
    """

    task_set: TaskSet
    responses: Mapping[str, Time | None]
    earliest: Mapping[str, Time]
    converged: bool


def chained(
    task_set: TaskSet, transactions: Sequence[Transaction], overheads: Overheads = NO_OVERHEADS
) -> Chained:
    """Holistic analysis: J of a task is the worst less the least time from the event to the end of
    the one before it, until nothing changes (Tindell, Clark 1994). The least time is the sum of
    `bcet` (Palencia, Gutierrez, Gonzalez Harbour 1998). Raises `TaskSetError`.
    """
    offsets: dict[str, Time] = {}
    earliest: dict[str, Time] = {}
    for transaction in transactions:
        transaction.check(task_set)
        start: Time = 0
        for name in transaction.tasks:
            offsets[name] = start
            start += task_set.task(name).bcet
            deadline = max(exact(transaction.deadline) - offsets[name], exact(Fraction(1, FINEST)))
            task_set = task_set.with_task(replace(task_set.task(name), deadline=deadline))
        earliest[transaction.name] = start
    for _ in range(MOST_ROUNDS):
        changed, responses = _next_round(task_set, transactions, offsets, overheads)
        if None in responses.values():
            break
        if changed == task_set:
            return Chained(task_set, responses, earliest, True)
        task_set = changed
        far = (t for t in transactions if (responses[t.name] or 0) > 100 * t.deadline)
        if any(far):
            break
    return Chained(task_set, dict.fromkeys(responses), earliest, False)


def _next_round(
    task_set: TaskSet,
    transactions: Sequence[Transaction],
    offsets: Mapping[str, Time],
    overheads: Overheads,
) -> tuple[TaskSet, dict[str, Time | None]]:
    """The set with the jitters that follow from the present ones, and each transaction's end."""
    changed = task_set
    responses: dict[str, Time | None] = {}
    for transaction in transactions:
        end: Time | None = None
        for place, name in enumerate(transaction.tasks):
            task = changed.task(name)
            if place:
                if end is None:
                    break
                jitter = exact(end - offsets[name])
                changed = changed.with_task(replace(task, release_jitter=jitter))
            bound = response_time_bound(task_set, task_set.task(name), overheads).bound
            end = None if bound is None else exact(offsets[name] + bound)
        responses[transaction.name] = end
    return changed, responses


@dataclass(frozen=True)
class Assigned:
    """Priorities by the deadlines that were assigned to the tasks, and whether all are then met."""

    task_set: TaskSet
    deadlines: Mapping[str, Time]
    schedulable: bool


def _proportional(task_set: TaskSet, transaction: Transaction) -> dict[str, Time]:
    """The whole deadline in proportion to the execution times."""
    total = sum(task_set.task(name).wcet for name in transaction.tasks)
    return {
        name: exact(Fraction(transaction.deadline) * Fraction(task_set.task(name).wcet) / total)
        for name in transaction.tasks
    }


def _by_deadline(task_set: TaskSet, deadlines: Mapping[str, Time]) -> TaskSet:
    """Shorter deadline, higher priority; interrupts stay on top."""
    order = list(task_set.by_priority())
    interrupts = [task for task in order if task.release == "interrupt"]
    others = [task for task in task_set if task.release != "interrupt"]
    others.sort(key=lambda task: deadlines.get(task.name, task.deadline - task.release_jitter))
    return task_set.with_priorities([task.name for task in (*interrupts, *others)])


def _meets(found: Chained, overheads: Overheads) -> bool:
    return found.converged and all(
        response_time_bound(found.task_set, task, overheads).meets_deadline
        for task in found.task_set
    )


def _redistributed(
    transaction: Transaction,
    deadlines: Mapping[str, Time],
    excess: Mapping[str, Fraction],
    damping: Fraction,
) -> dict[str, Time]:
    """Deadlines moved towards the tasks that exceed theirs; their sum stays the whole one."""
    largest = max((abs(value) for value in excess.values()), default=Fraction(0)) or Fraction(1)
    moved = {
        name: Fraction(deadlines[name]) * (1 + excess[name] / (damping * largest))
        for name in transaction.tasks
    }
    total = sum(moved.values())
    return {
        name: exact((value / total).limit_denominator(FINEST) * Fraction(transaction.deadline))
        for name, value in moved.items()
    }


def _excess(
    found: Chained, transaction: Transaction, deadlines: Mapping[str, Time], overheads: Overheads
) -> dict[str, Fraction]:
    """(r - d) R / D of each task: its own response less its deadline, times the whole's ratio."""
    response = found.responses[transaction.name]
    whole = Fraction(2) if response is None else Fraction(response) / Fraction(transaction.deadline)
    excess = {}
    for name in transaction.tasks:
        task = found.task_set.task(name)
        bound = response_time_bound(found.task_set, task, overheads).bound
        own = 2 * task.period if bound is None else bound - task.release_jitter
        excess[name] = (Fraction(own) - Fraction(deadlines[name])) * whole
    return excess


def assign_deadlines(
    task_set: TaskSet,
    transactions: Sequence[Transaction],
    rule: Rule,
    overheads: Overheads = NO_OVERHEADS,
) -> Assigned:
    """Each transaction's deadline shared among its tasks, and priorities by these deadlines.

    `proportional` shares it by execution times. `hopa` begins with that and moves deadlines to the
    tasks that exceed theirs, d (1 + e / (k max e)) with e = (r - d) R / D, until all deadlines are
    met or it has tried enough (Gutierrez Garcia, Gonzalez Harbour 1995, for one processor).
    Raises `TaskSetError`.
    """
    start: dict[str, Time] = {}
    for transaction in transactions:
        transaction.check(task_set)
        start |= _proportional(task_set, transaction)
    first = _tried(task_set, transactions, start, overheads)
    if first.schedulable or rule == "proportional":
        return first
    for damping in HOPA_DAMPING:
        deadlines = dict(start)
        for _ in range(HOPA_ROUNDS):
            ordered = _by_deadline(task_set, deadlines)
            found = chained(ordered, transactions, overheads)
            if _meets(found, overheads):
                return Assigned(ordered, deadlines, True)
            for transaction in transactions:
                excess = _excess(found, transaction, deadlines, overheads)
                deadlines |= _redistributed(transaction, deadlines, excess, damping)
    return first


def _tried(
    task_set: TaskSet,
    transactions: Sequence[Transaction],
    deadlines: Mapping[str, Time],
    overheads: Overheads,
) -> Assigned:
    ordered = _by_deadline(task_set, deadlines)
    met = _meets(chained(ordered, transactions, overheads), overheads)
    return Assigned(ordered, deadlines, met)
