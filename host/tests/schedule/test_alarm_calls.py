# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Calls of the alarm: shared by releases at one instant, and early ones that release nobody."""

from __future__ import annotations

from dataclasses import replace

import pytest

from ravenbrick.schedule.model import Overheads, Task, TaskSet, TaskSetError
from ravenbrick.schedule.offsets import phased_response_time_bounds, synchronous_bound
from ravenbrick.schedule.response_time import response_time_bounds

SLOW = Task("slow", 1_000, 200, 1)
FAST = Task("fast", 100, 20, 2)
COSTS = Overheads(alarm=10, alarm_further=3)


def _bound(tasks: tuple[Task, ...], costs: Overheads, *, phases: tuple[int, ...] | None) -> object:
    if phases is None:
        found = response_time_bounds(TaskSet(tasks), costs)
    else:
        known = zip(tasks, phases, strict=True)
        phased = TaskSet(tuple(replace(task, phase=phase) for task, phase in known))
        found = phased_response_time_bounds(phased, costs)
    return {each.task.name: each.bound for each in found}["slow"]


def test_releases_at_the_same_instant_cost_one_call_and_a_further_release() -> None:
    both = 200 + 3 * 20
    assert _bound((SLOW, FAST), COSTS, phases=(0, 0)) == both + 3 * 10 + 3
    assert _bound((SLOW, FAST), COSTS, phases=(10, 0)) == 200 + 2 * 20 + 10 + 3 * 10 + 10
    assert _bound((SLOW, FAST), COSTS, phases=None) == both + 4 * 10


def test_an_early_call_comes_at_most_once_before_each_release_and_once_in_its_period() -> None:
    early = Overheads(alarm=10, alarm_early=5)
    assert _bound((SLOW, FAST), early, phases=None) == 200 + 4 * 20 + 5 * 10 + 6 * 5
    seldom = replace(early, alarm_early_period=150)
    assert _bound((SLOW, FAST), seldom, phases=None) == 200 + 4 * 20 + 5 * 10 + 3 * 5
    assert _bound((SLOW, FAST), seldom, phases=(0, 0)) == 200 + 4 * 20 + 5 * 10 + 5


def test_the_release_of_all_together_is_the_first_of_all_starts() -> None:
    tasks = tuple(replace(task, phase=0) for task in (SLOW, FAST))
    found = synchronous_bound(TaskSet(tasks), tasks[0], COSTS)
    assert found.bound == found.terms.total == 200 + 3 * 20 + 3 * 10 + 3


def test_a_further_release_that_costs_more_than_a_call_is_refused() -> None:
    with pytest.raises(TaskSetError, match="alarm_further: is 11; expected at most 'alarm'"):
        Overheads(alarm=10, alarm_further=11)
