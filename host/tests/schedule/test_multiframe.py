# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Multiframe tasks: published cases, and every start of every task by simulation."""

from __future__ import annotations

import itertools
import random
from dataclasses import replace

import pytest

from ravenbrick.schedule import Frame, Task, TaskSet, TaskSetError, simulate
from ravenbrick.schedule.bounds import liu_layland_bound
from ravenbrick.schedule.multiframe import multiframe_utilization_bound
from ravenbrick.schedule.releases import critical_instant
from ravenbrick.schedule.response_time import is_schedulable, response_time_bounds
from ravenbrick.schedule.sensitivity import largest_scaling, largest_wcet


def equal_frames(*wcets: int, period: int) -> tuple[Frame, ...]:
    return tuple(Frame(wcet, period, period) for wcet in wcets)


def rotated(task: Task, first: int) -> Task:
    return replace(task, frames=task.frames[first:] + task.frames[:first])


def worst_simulated(task_set: TaskSet, end: int) -> dict[str, int]:
    """Longest response from the critical instant, over all first frames of all tasks."""
    worst = dict.fromkeys((task.name for task in task_set), 0)
    for starts in itertools.product(*(range(len(task.frames) or 1) for task in task_set)):
        tasks = (rotated(task, first) for task, first in zip(task_set, starts, strict=True))
        run = simulate(TaskSet(tuple(tasks)), end, releases=critical_instant)
        for name, time in worst.items():
            worst[name] = max(time, int(run.response_time_max(name) or 0))
    return worst


def random_multiframe_set(seed: int, *, general: bool) -> TaskSet:
    """2 or 3 tasks of 1 to 4 frames; `general` ones have separations and deadlines of their own."""
    dice = random.Random(seed)
    while True:
        tasks = []
        count = dice.randint(2, 3)
        for index in range(count):
            period = dice.choice((4, 6, 8, 12, 20))
            frames = []
            for _ in range(dice.randint(1, 4)):
                separation = dice.randint(period, 2 * period) if general else period
                wcet = dice.randint(1, max(1, period * 2 // 3))
                deadline = dice.randint(wcet, 2 * separation) if general else period
                frames.append(Frame(wcet, separation, deadline))
            jitter = dice.randint(0, period) if dice.random() < 0.3 else 0
            name = f"t{index}"
            tasks.append(
                Task(name, 1, 1, count - index, release_jitter=jitter, frames=tuple(frames))
            )
        task_set = TaskSet(tuple(tasks))
        if task_set.utilization < 1:
            return task_set


def test_a_set_of_mok_and_chen_s_model_is_schedulable_though_its_longest_frames_overload() -> None:
    """((2, 1), 3) and (3, 7): 2/3 + 3/7 is above 1, yet the responses are 2 and 6."""
    often = Task("often", 3, 2, 2, frames=equal_frames(2, 1, period=3))
    task_set = TaskSet((often, Task("seldom", 7, 3, 1)))
    assert task_set.without_frames().utilization > 1
    assert [found.bound for found in response_time_bounds(task_set)] == [2, 6]
    assert [found.bound for found in response_time_bounds(task_set.without_frames())] == [2, None]


def test_the_utilisation_bound_of_mok_and_chen_holds_that_of_liu_and_layland() -> None:
    """r n ((1 + 1/r)^(1/n) - 1): r = 1 is the classical bound, and a greater r only adds to it."""
    for count in (1, 2, 3, 10):
        assert multiframe_utilization_bound(1, count) == pytest.approx(liu_layland_bound(count))
        assert multiframe_utilization_bound(2, count) >= liu_layland_bound(count)
    assert round(multiframe_utilization_bound(2, 2), 4) == 0.899
    with pytest.raises(TaskSetError):
        multiframe_utilization_bound(0.5, 2)


@pytest.mark.parametrize("seed", range(100))
def test_sets_below_the_multiframe_utilisation_bound_are_schedulable(seed: int) -> None:
    """Two frames a task, the first `ratio` times the second or more, up to the bound."""
    dice = random.Random(seed)
    count, ratio = dice.randint(2, 4), dice.choice((1, 2, 4))
    share = multiframe_utilization_bound(ratio, count) / count
    tasks = []
    for index, period in enumerate(sorted(dice.sample(range(1000, 5000), count))):
        longest = int(share * period)
        frames = equal_frames(longest, longest // ratio, period=period)
        tasks.append(Task(f"t{index}", 1, 1, count - index, frames=frames))
    assert is_schedulable(TaskSet(tuple(tasks)))


@pytest.mark.parametrize("general", [False, True])
def test_no_start_of_any_task_exceeds_a_bound_and_most_reach_it(general: bool) -> None:
    """Random sets from every combination of first frames, released at once and late by jitter.

    94 of 100 bounds (98 with equal separations) are reached; the others add frames of several tasks
    that are the worst in windows of different lengths.
    """
    reached = total = 0
    for seed in range(60):
        task_set = random_multiframe_set(seed, general=general)
        bounds = response_time_bounds(task_set)
        end = max(int(found.busy_period or 0) for found in bounds) + 1
        worst = worst_simulated(task_set, end)
        for found in bounds:
            assert found.bound is not None and worst[found.task.name] <= found.bound
            assert found.terms is not None and found.terms.total == found.bound
            reached += worst[found.task.name] == found.bound
            total += 1
    assert reached >= (0.94 if general else 0.98) * total, (reached, total)


@pytest.mark.parametrize("seed", range(40))
def test_later_arrivals_of_general_frames_stay_below_the_bounds(seed: int) -> None:
    """Any phases, any first frame, any additional separation."""
    task_set = random_multiframe_set(seed, general=True)
    bounds = {found.task.name: found for found in response_time_bounds(task_set)}
    dice = random.Random(seed)
    for _ in range(20):
        tasks = tuple(
            replace(rotated(t, dice.randrange(4)), phase=dice.randrange(20)) for t in task_set
        )
        for job in simulate(TaskSet(tasks), 300).jobs:
            bound = bounds[job.task.name].bound
            assert bound is not None and (job.response_time or 0) <= bound


@pytest.mark.parametrize("seed", range(40))
def test_frames_that_are_all_alike_are_a_plain_task(seed: int) -> None:
    """The same bounds and the same sensitivity."""
    dice = random.Random(seed)
    rows = [(dice.randint(1, 4), dice.choice((12, 15, 20))) for _ in range(3)]
    plain = TaskSet.of(*rows)
    framed = TaskSet(
        tuple(
            replace(t, frames=equal_frames(*[int(t.wcet)] * 3, period=int(t.period))) for t in plain
        )
    )
    for one, other in zip(response_time_bounds(plain), response_time_bounds(framed), strict=True):
        assert (one.bound, one.busy_period) == (other.bound, other.busy_period)
    assert largest_scaling(plain) == largest_scaling(framed)
    assert largest_wcet(plain, "t2") == largest_wcet(framed, "t2")


@pytest.mark.parametrize("seed", range(40))
def test_scaling_of_multiframe_tasks_is_the_largest_that_stays_schedulable(seed: int) -> None:
    task_set = random_multiframe_set(seed, general=False)
    factor = largest_scaling(task_set).factor
    if factor is None:
        return

    def scaled(by: object) -> TaskSet:
        return TaskSet(
            tuple(
                replace(
                    task,
                    frames=tuple(replace(frame, wcet=frame.wcet * by) for frame in task.frames),
                )
                for task in task_set
            )
        )

    assert is_schedulable(scaled(factor))
    assert not is_schedulable(scaled(factor * (1 + type(factor)(1) / 10**6)))


def test_a_task_of_frames_is_as_demanding_as_the_worst_of_them_together() -> None:
    """Whoever knows of no frames sees the longest execution, least separation, nearest deadline."""
    frames = (Frame(4, 20, 18), Frame(1, 10, 9), Frame(2, 30, 40))
    task = Task("a", 99, 1, frames=frames)
    assert (task.wcet, task.period, task.deadline) == (4, 10, 9)
    (plain,) = TaskSet((task,)).without_frames()
    assert plain == Task("a", 10, 4, deadline=9)


def test_frames_do_not_go_with_limits_or_times_that_mean_nothing() -> None:
    with pytest.raises(TaskSetError, match="does not go with 'limits'"):
        Task("a", 3, 1, frames=equal_frames(1, 2, period=3), limits=((1, 2),))
    with pytest.raises(TaskSetError, match="expected more than 0"):
        Task("a", 3, 1, frames=(Frame(0, 3, 3),))
