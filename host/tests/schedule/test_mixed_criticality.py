# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Adaptive mixed criticality: the sample set of the literature, and random runs in unit steps."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction

import pytest
from verification.support.timing.unit_steps import Request, with_modes

from ravenbrick.schedule import Task, TaskSet, TaskSetError, is_schedulable
from ravenbrick.schedule.model import Overheads
from ravenbrick.schedule.task_models.mixed_criticality import Method, mixed_criticality_bounds


def sample_set() -> TaskSet:
    """C, T = 1, 2 (low); 1 or 5, 10; 20, 100: the sample set of Baruah, Burns, Davis 2011."""
    return TaskSet(
        (
            Task("t1", 2, 1, 3),
            Task("t2", 10, 1, 2, wcet_high=5),
            Task("t3", 100, 20, 1, wcet_high=20),
        )
    )


def test_the_sample_set_is_schedulable_because_low_tasks_stop() -> None:
    """R(LO) = 1, 2, 50; AMC-rtb gives 20 + 9 * 5 + 25 = 90 for the last. With the low task going
    on, as in static mixed criticality, the processor would be overloaded."""
    found = mixed_criticality_bounds(sample_set(), method="amc_rtb")
    assert [(each.low, each.high) for each in found] == [(1, None), (2, 6), (50, 90)]
    assert all(each.meets_deadline for each in found)
    going_on = TaskSet(tuple(replace(t, wcet=t.wcet_high or t.wcet) for t in sample_set()))
    assert not is_schedulable(going_on)


def random_mixed_set(seed: int) -> TaskSet:
    """3 to 5 tasks; at least one of each criticality; U(LO) and U(HI) at most 1."""
    dice = random.Random(seed)
    while True:
        tasks = []
        count = dice.randint(3, 5)
        for index in range(count):
            period = dice.choice((5, 6, 8, 10, 12, 15, 20, 30))
            wcet = dice.randint(1, max(1, period // 3))
            high = dice.randint(wcet, min(period, 2 * wcet)) if dice.random() < 0.6 else None
            deadline = dice.randint(max(wcet, high or 0, period * 2 // 3), period)
            tasks.append(Task(f"t{index}", period, wcet, count - index, deadline, wcet_high=high))
        highs = sum(task.wcet_high / task.period for task in tasks if task.wcet_high is not None)
        mixed = 0 < sum(task.wcet_high is not None for task in tasks) < count
        if mixed and highs <= 1 and TaskSet(tuple(tasks)).utilization <= 1:
            return TaskSet(tuple(tasks))


def random_jobs(task_set: TaskSet, dice: random.Random, end: int) -> list[Request]:
    """Jobs of a run; each critical one may take longer from an instant of its own on."""
    jobs = []
    late = {task.name: dice.randrange(end) // 2 for task in task_set}
    together = dice.random() < 0.5
    for task in task_set:
        arrival = 0 if together else dice.randrange(int(task.period))
        while arrival < end - 100:
            longest = int(task.wcet)
            if task.wcet_high is not None and arrival >= late[task.name]:
                longest = int(task.wcet_high)
            jobs.append(
                Request(
                    task.name,
                    arrival,
                    longest,
                    task.priority,
                    critical=task.wcet_high is not None,
                    limit=int(task.wcet),
                )
            )
            arrival += int(task.period) + (dice.random() < 0.1) * dice.randrange(3)
    return jobs


@pytest.mark.parametrize("method", ["amc_rtb", "amc_max"])
def test_no_run_in_unit_steps_exceeds_a_bound(method: Method) -> None:
    """Random sets and runs; more than 95 of 100 bounds of high criticality are reached."""
    reached = total = 0
    for seed in range(200):
        task_set = random_mixed_set(seed)
        bounds = mixed_criticality_bounds(task_set, method=method)
        if not all(found.meets_deadline for found in bounds):
            continue
        worst = dict.fromkeys((task.name for task in task_set), 0)
        dice = random.Random(seed)
        for _ in range(60):
            for job in with_modes(random_jobs(task_set, dice, 300), 300):
                found = next(each for each in bounds if each.task.name == job.task)
                time = job.end - job.arrival
                limit = found.low if job.ordinary else found.high
                assert limit is None or time <= limit, (seed, job, limit)
                worst[job.task] = max(worst[job.task], time)
        for found in bounds:
            if found.high is not None:
                reached += worst[found.task.name] == found.high
                total += 1
    assert total > 80 and reached > 0.95 * total, (reached, total)


@pytest.mark.parametrize("method", ["amc_rtb", "amc_max"])
def test_switches_count_as_if_each_job_executed_longer(method: Method) -> None:
    """In both modes (Burns, Tindell, Wellings 1995): 1/4 in and 1/2 out of every job."""
    high = 0
    for seed in range(60):
        task_set = random_mixed_set(seed)
        longer = TaskSet(
            tuple(
                replace(
                    task,
                    wcet=task.wcet + Fraction(3, 4),
                    wcet_high=None if task.wcet_high is None else task.wcet_high + Fraction(3, 4),
                )
                for task in task_set
            )
        )
        costs = Overheads(switch_in=Fraction(1, 4), switch_out=Fraction(1, 2))
        charged = mixed_criticality_bounds(task_set, costs, method)
        expected = mixed_criticality_bounds(longer, method=method)
        times = [(found.low, found.high) for found in charged]
        assert times == [(found.low, found.high) for found in expected]
        high += sum(found.high is not None for found in charged)
    assert high > 20, high


@pytest.mark.parametrize("seed", range(100))
def test_amc_max_is_never_above_amc_rtb(seed: int) -> None:
    """It dominates (theorem 3 of the paper), and a set without high tasks has only low bounds."""
    task_set = random_mixed_set(seed)
    rtb = mixed_criticality_bounds(task_set, method="amc_rtb")
    longest = mixed_criticality_bounds(task_set, method="amc_max")
    for one, other in zip(longest, rtb, strict=True):
        assert one.low == other.low
        if other.high is not None:
            assert one.high is not None and one.high <= other.high
    plain = TaskSet(tuple(replace(task, wcet_high=None) for task in task_set))
    assert all(found.high is None for found in mixed_criticality_bounds(plain))


def test_deadlines_beyond_the_period_are_refused() -> None:
    task_set = TaskSet((Task("a", 5, 1, 1, deadline=6, wcet_high=2),))
    with pytest.raises(TaskSetError, match=r"a\.deadline: is 6, longer than the period"):
        mixed_criticality_bounds(task_set)
