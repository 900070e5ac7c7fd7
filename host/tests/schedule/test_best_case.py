# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Best-case response times: the published example, and every phase of small sets."""

from __future__ import annotations

import itertools
import random
from dataclasses import replace

import pytest
from verification.support.timing.random_task_sets import random_releases

from ravenbrick.schedule import Task, TaskSet, TaskSetError, simulate
from ravenbrick.schedule.best_case import best_case_response_time, output_jitter
from ravenbrick.schedule.model import Release
from ravenbrick.schedule.quantity import Time

SETTLED = 150


def exact_times(task_set: TaskSet) -> TaskSet:
    """Least execution times that equal the longest."""
    return TaskSet(tuple(replace(task, bcet=task.wcet) for task in task_set))


def test_example_of_bril_steffens_and_verhaegh() -> None:
    """T = 10, 19, 56 and C = 3, 11, 5: worst 3, 17, 56, best 3, 14, 22 (Journal of Scheduling 7,
    2004; the parameters as usually quoted)."""
    found = output_jitter(exact_times(TaskSet.of((3, 10), (11, 19), (5, 56))))
    assert [each.worst for each in found] == [3, 17, 56]
    assert [each.best for each in found] == [3, 14, 22]
    assert [each.jitter for each in found] == [0, 3, 34]


def least_simulated(task_set: TaskSet, name: str) -> int:
    """Least response of a task over all phases of the tasks, once all of them run; execution times
    at their longest."""
    least = 10**9
    settled = int(max(task.period for task in task_set) + task_set.hyperperiod)
    for phases in itertools.product(*(range(int(task.period)) for task in task_set.tasks[1:])):
        tasks = (replace(t, phase=p) for t, p in zip(task_set, (0, *phases), strict=True))
        for job in simulate(TaskSet(tuple(tasks)), 3 * int(task_set.hyperperiod)).jobs_of(name):
            if job.response_time is not None and job.arrival >= settled:
                least = min(least, int(job.response_time))
    return least


def test_every_phase_of_small_sets_gives_exactly_the_best_case() -> None:
    """Whole phases are enough: the best one lets the job end at a release of the others. Before
    all tasks have run for a while, a job may be shorter, since earlier jobs of others are missing.
    """
    dice = random.Random(5)
    checked = 0
    while checked < 12:
        periods = dice.sample((4, 5, 6, 8, 10, 12), 3)
        rows = [(dice.randint(1, period // 2), period) for period in sorted(periods)]
        task_set = exact_times(TaskSet.of(*rows))
        last = task_set.tasks[-1]
        found = output_jitter(task_set)
        if task_set.utilization > 1 or any((f.worst or 10**9) > f.task.period for f in found):
            continue
        if task_set.hyperperiod > 60:
            continue
        assert best_case_response_time(task_set, last) == least_simulated(task_set, last.name)
        checked += 1


@pytest.mark.parametrize("seed", range(80))
def test_no_random_run_is_shorter_than_the_best_case(seed: int) -> None:
    """With jitter, sporadic tasks, equal priorities and long deadlines too."""
    dice = random.Random(seed)
    tasks = []
    for index in range(dice.randint(2, 5)):
        period = dice.choice((5, 8, 10, 12, 20, 30))
        wcet = dice.randint(1, period // 2)
        jitter = dice.choice((0, 0, dice.randint(0, period)))
        release: Release = dice.choice(("cyclic", "cyclic", "sporadic"))
        least = wcet if seed % 2 else dice.randint(0, wcet)
        tasks.append(
            Task(f"t{index}", period, wcet, dice.randint(1, 4), 3 * period, jitter, None, release)
        )
        tasks[-1] = replace(tasks[-1], bcet=least)
    task_set = TaskSet(tuple(tasks))
    best = {found.task.name: found.best for found in output_jitter(task_set)}
    for number in range(8):
        choice = random.Random(number)

        def taken(task: Task, _: int, choice: random.Random = choice) -> Time:
            return max(task.bcet, choice.choice((1, task.wcet)))

        pattern = random_releases(seed * 100 + number)
        for job in simulate(task_set, 500, releases=pattern, execution_time=taken).jobs:
            if job.response_time is not None and job.arrival >= SETTLED:
                assert job.response_time >= best[job.task.name]


def test_a_least_execution_time_above_the_longest_is_refused() -> None:
    with pytest.raises(TaskSetError, match=r"a\.bcet: is 3, more than the execution time"):
        Task("a", 5, 2, bcet=3)
