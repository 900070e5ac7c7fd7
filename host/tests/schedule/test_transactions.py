# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Transactions: end-to-end bounds beside random runs, deadlines beside all orders of priorities."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import pytest
from verification.support.timing.unit_steps import chain_ends

from ravenbrick.schedule import Task, TaskSet, TaskSetError, is_schedulable, response_time_bounds
from ravenbrick.schedule.model import Release
from ravenbrick.schedule.task_models.transactions import (
    RULES,
    Assigned,
    Transaction,
    assign_deadlines,
    chained,
)


def three_steps() -> tuple[TaskSet, list[Transaction]]:
    """Sense, compute and act, and a faster task between them."""
    steps = [
        Task("sense", 20, 2, 4),
        Task("compute", 20, 4, 2, release="sporadic", bcet=1),
        Task("act", 20, 1, 1, release="sporadic"),
    ]
    chain = Transaction("steer", ("sense", "compute", "act"), 20)
    return TaskSet((*steps, Task("other", 5, 1, 3))), [chain]


def test_each_step_gets_the_jitter_of_the_step_before() -> None:
    """sense 2; compute from 2: 2 + (4 + 2) = 8; act: 8 + 1 + 1 (the fast task) = 10, all from the
    event, since the chain's own steps do not overlap it."""
    task_set, chains = three_steps()
    found = chained(task_set, chains)
    assert found.converged
    jitters = [found.task_set.task(name).release_jitter for name in chains[0].tasks]
    responses = [each.bound for each in response_time_bounds(found.task_set)]
    assert jitters[0] == 0 and jitters[1] == 2
    assert found.responses["steer"] == responses[-1] + 1
    assert found.earliest == {"steer": 1}


def random_chains(seed: int) -> tuple[TaskSet, list[Transaction]]:
    """One or two transactions of two or three tasks beside one or two other tasks."""
    dice = random.Random(seed)
    while True:
        tasks: list[Task] = []
        chains = []
        for place in range(dice.randint(1, 2)):
            period = dice.choice((12, 20, 30))
            names = []
            for step in range(dice.randint(2, 3)):
                name = f"c{place}{step}"
                names.append(name)
                wcet = dice.randint(1, 4)
                release: Release = "sporadic" if step else "cyclic"
                tasks.append(Task(name, period, wcet, release=release, bcet=dice.randint(0, wcet)))
            chains.append(Transaction(f"c{place}", tuple(names), dice.randint(period // 2, period)))
        for place in range(dice.randint(1, 2)):
            period = dice.choice((5, 8, 15))
            wcet = dice.randint(1, period // 3)
            tasks.append(Task(f"t{place}", period, wcet, deadline=dice.randint(wcet, period)))
        order = [task.name for task in tasks]
        dice.shuffle(order)
        task_set = TaskSet(tuple(tasks)).with_priorities(order)
        if task_set.utilization < 1 and len(tasks) <= 6:
            return task_set, chains


def test_no_run_of_random_chains_exceeds_a_bound() -> None:
    """Random phases, execution times between least and longest. The longest responses are half
    of the bounds in the mean, which let the steps of a chain delay each other.
    """
    seen, promised = 0.0, 0.0
    for seed in range(60):
        task_set, chains = random_chains(seed)
        found = chained(task_set, chains)
        if not found.converged:
            continue
        worst = dict.fromkeys(found.responses, 0)
        least = dict.fromkeys(found.responses, 10**9)
        dice = random.Random(seed)
        for _ in range(40):
            for steps, time in chain_ends(task_set, [c.tasks for c in chains], dice, 240):
                chain = next(c.name for c in chains if c.tasks == steps)
                worst[chain] = max(worst[chain], time)
                least[chain] = min(least[chain], time)
        for name, bound in found.responses.items():
            assert bound is not None and worst[name] <= bound, (seed, name)
            assert least[name] >= found.earliest[name]
            seen, promised = seen + worst[name], promised + float(bound)
    assert seen > 0.5 * promised, (seen, promised)


def feasible_orders(task_set: TaskSet, chains: list[Transaction]) -> Iterator[tuple[str, ...]]:
    for order in itertools.permutations(task.name for task in task_set):
        found = chained(task_set.with_priorities(order), chains)
        if found.converged and is_schedulable(found.task_set):
            yield order


def test_deadlines_assigned_beside_every_order_of_priorities() -> None:
    """Of the random systems that some order makes schedulable, proportional deadlines find one for
    most and HOPA for 9 of 10 or more; neither claims one that is none.
    """
    found = {"any": 0, "proportional": 0, "hopa": 0}
    for seed in range(60):
        task_set, chains = random_chains(seed)
        if len(task_set) > 4:
            continue
        exists = next(feasible_orders(task_set, chains), None) is not None
        found["any"] += exists
        for rule in RULES:
            assigned = assign_deadlines(task_set, chains, rule)
            assert not assigned.schedulable or exists
            assert not assigned.schedulable or met(assigned, chains)
            found[rule] += assigned.schedulable
    assert found["hopa"] >= found["proportional"]
    assert found["hopa"] >= 0.9 * found["any"] > 0, found


def test_hopa_finds_an_order_that_proportional_deadlines_miss() -> None:
    """ "second" gets 19/5 of 19 for its 1 of 5, less than the 4 within which both others have to
    end, and so comes first. All feasible orders begin with these two."""
    chain = Transaction("chain", ("first", "second"), 19)
    steps = (Task("first", 20, 4, bcet=3), Task("second", 20, 1, release="sporadic"))
    others = (Task("long", 15, 3, deadline=4), Task("short", 5, 1, deadline=4))
    task_set = TaskSet((*steps, *others))
    orders = list(feasible_orders(task_set, [chain]))
    assert orders and all({*order[:2]} == {"long", "short"} for order in orders)
    proportional, hopa = (assign_deadlines(task_set, [chain], rule) for rule in RULES)
    assert not proportional.schedulable and proportional.deadlines["second"] == Fraction(19, 5)
    assert hopa.schedulable and met(hopa, [chain])


def met(assigned: Assigned, chains: list[Transaction]) -> bool:
    """Whether the assigned priorities meet all deadlines, and the shares add up to the whole."""
    for chain in chains:
        assert sum(assigned.deadlines[name] for name in chain.tasks) == chain.deadline
    return is_schedulable(chained(assigned.task_set, chains).task_set)


def test_proportional_deadlines_share_the_whole_by_execution_times() -> None:
    """D C_i / sum of C: 2, 4, 1 of 7 parts of 14."""
    task_set, _ = three_steps()
    chain = Transaction("steer", ("sense", "compute", "act"), 14)
    deadlines = assign_deadlines(task_set, [chain], "proportional").deadlines
    assert deadlines == {"sense": 4, "compute": 8, "act": 2}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"period": 21},
            "compute.period: is 21, but 'sense', which begins the transaction, has 20",
        ),
        ({"release": "cyclic"}, "compute.release: a task that another one releases is 'sporadic'"),
        ({"release_jitter": 1}, "compute.release: a task that another one releases"),
    ],
)
def test_tasks_that_cannot_release_one_another_are_refused(
    change: dict[str, object], message: str
) -> None:
    task_set, chains = three_steps()
    changed = replace(task_set.task("compute"), **change)  # type: ignore[arg-type]
    with pytest.raises(TaskSetError, match=message):
        chained(task_set.with_task(changed), chains)
