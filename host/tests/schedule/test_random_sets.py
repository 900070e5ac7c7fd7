# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The analysis beside the exact simulator on random sets: never below, and equal where exact."""

from __future__ import annotations

import itertools
import random
from dataclasses import replace
from fractions import Fraction

import pytest
from verification.support.timing.random_task_sets import (
    random_releases,
    random_task_set,
    with_jitter,
    with_phases,
    with_sections,
)

from ravenbrick.schedule.assignment import audsley
from ravenbrick.schedule.bounds import passes_hyperbolic_bound, passes_liu_layland_bound
from ravenbrick.schedule.edf import (
    earliest_deadline_bounds,
    processor_demand,
    processor_demand_test,
)
from ravenbrick.schedule.model import Overheads, Task, TaskSet
from ravenbrick.schedule.offsets import phased_response_time_bounds
from ravenbrick.schedule.quantity import Time
from ravenbrick.schedule.releases import critical_instant
from ravenbrick.schedule.response_time import (
    is_schedulable,
    response_time_bound,
    response_time_bounds,
)
from ravenbrick.schedule.sensitivity import largest_scaling, largest_wcet, smallest_period
from ravenbrick.schedule.simulation import simulate
from ravenbrick.schedule.task_models.sampled_chains import sampled_chain_bound

SEEDS = range(60)
ABOVE = Fraction(1_000_001, 1_000_000)


@pytest.mark.parametrize("seed", SEEDS)
def test_synchronous_release_reaches_each_bound_exactly(seed: int) -> None:
    """Without jitter the simulated worst response time of a hyperperiod equals the bound."""
    task_set = random_task_set(seed, longest=2.0)
    run = simulate(task_set)
    for found in response_time_bounds(task_set):
        if found.busy_period is not None:
            assert run.response_time_max(found.task.name) == found.bound


@pytest.mark.parametrize("seed", SEEDS)
def test_jittered_critical_instant_reaches_each_bound_exactly(seed: int) -> None:
    """Released late by their jitter at once, the tasks respond as slowly as the bound says."""
    task_set = with_jitter(random_task_set(seed), seed)
    for found in response_time_bounds(task_set):
        if found.busy_period is not None:
            run = simulate(task_set, found.busy_period + 1, releases=critical_instant)
            assert run.response_time_max(found.task.name) == found.bound


@pytest.mark.parametrize("seed", SEEDS)
def test_no_random_pattern_with_sections_and_jitter_exceeds_a_bound(seed: int) -> None:
    """Under immediate ceilings, whatever the phases, jitter and separations."""
    task_set = with_sections(with_jitter(random_task_set(seed), seed), seed)
    if seed % 2:
        first, *others = task_set
        task_set = TaskSet((replace(first, release="sporadic"), *others))
    run = simulate(task_set, 400, releases=random_releases(seed))
    assert run.deadlock is None
    for found in response_time_bounds(task_set):
        observed = run.response_time_max(found.task.name)
        assert found.bound is not None and (observed is None or observed <= found.bound)


@pytest.mark.parametrize("seed", SEEDS)
def test_no_random_pattern_exceeds_an_earliest_deadline_bound(seed: int) -> None:
    """Under the stack resource policy, for sets below full utilisation."""
    task_set = with_sections(with_jitter(random_task_set(seed, longest=1.5), seed), seed)
    if task_set.utilization == 1:
        task_set = TaskSet((*task_set.tasks[:-1], replace(task_set.tasks[-1], period=10**4)))
    pattern = random_releases(seed)
    run = simulate(task_set, 400, scheduler="earliest_deadline", releases=pattern)
    for found in earliest_deadline_bounds(task_set):
        observed = run.response_time_max(found.task.name)
        assert found.bound is not None and (observed is None or observed <= found.bound)


@pytest.mark.parametrize("seed", SEEDS)
def test_earliest_deadline_bound_is_reached_by_some_phases(seed: int) -> None:
    """For two tasks, trying all phases of one finds the bound of both, exactly."""
    task_set = TaskSet(random_task_set(seed).tasks[:2])
    first, second = task_set
    worst: dict[str, Time] = {first.name: 0, second.name: 0}
    for shift in range(-int(second.period), int(first.period)):
        phased = TaskSet(
            (replace(first, phase=max(0, -shift)), replace(second, phase=max(0, shift)))
        )
        run = simulate(phased, scheduler="earliest_deadline")
        for name in worst:
            worst[name] = max(worst[name], run.response_time_max(name) or 0)
    bounds = {found.task.name: found.bound for found in earliest_deadline_bounds(task_set)}
    assert all(worst[name] <= bounds[name] for name in worst)
    assert sum(worst[name] == bounds[name] for name in worst) >= 1


@pytest.mark.parametrize("seed", SEEDS)
def test_demand_test_agrees_with_earliest_deadline_simulation(seed: int) -> None:
    """Synchronous release misses a deadline exactly when the test finds an overload."""
    task_set = random_task_set(seed)
    found = processor_demand_test(task_set)
    run = simulate(task_set, 2 * task_set.hyperperiod, scheduler="earliest_deadline")
    assert found.schedulable == (not run.deadline_misses)
    if not found.schedulable:
        assert found.instant is not None
        assert processor_demand(task_set, found.instant) == found.demand > found.instant


@pytest.mark.parametrize("seed", SEEDS)
def test_demand_test_with_jitter_agrees_with_checking_every_instant(seed: int) -> None:
    """The backward search finds an overload exactly when one exists."""
    task_set = with_jitter(random_task_set(seed, longest=2.0), seed)
    end = 2 * task_set.hyperperiod + 200
    demands = ((t, processor_demand(task_set, t)) for t in range(-200, int(end)))
    overload = any(demand > max(t, 0) for t, demand in demands)
    assert processor_demand_test(task_set).schedulable == (not overload)


@pytest.mark.parametrize("seed", SEEDS)
def test_phased_bounds_of_independent_tasks_equal_the_simulation(seed: int) -> None:
    """With all phases known and no jitter the bounds are exact."""
    task_set = with_phases(random_task_set(seed), seed)
    run = simulate(task_set, 4 * task_set.hyperperiod + 60)
    for found in phased_response_time_bounds(task_set):
        assert found.terms is not None and found.terms.total == found.bound
        if task_set.utilization < 1:
            assert run.response_time_max(found.task.name) == found.bound


@pytest.mark.parametrize("seed", SEEDS)
def test_phased_bounds_hold_with_jitter_sections_and_sporadic_tasks(seed: int) -> None:
    """They are never below a random run and never above the bounds without phases."""
    task_set = with_sections(with_jitter(random_task_set(seed), seed), seed)
    task_set = with_phases(task_set, seed)
    first, *others = task_set
    task_set = TaskSet((replace(first, phase=None, release="sporadic"), *others))
    run = simulate(task_set, 400, releases=random_releases(seed))
    unphased = response_time_bounds(task_set)
    for found, loose in zip(phased_response_time_bounds(task_set), unphased, strict=True):
        observed = run.response_time_max(found.task.name)
        assert found.bound is not None and loose.bound is not None
        assert (observed or 0) <= found.bound <= loose.bound


@pytest.mark.parametrize("seed", SEEDS)
def test_passing_a_utilisation_bound_means_schedulable(seed: int) -> None:
    """The hyperbolic bound accepts all that the older bound accepts; both are safe."""
    rows = [(task.wcet, task.period) for task in random_task_set(seed)]
    task_set = TaskSet.of(*sorted(rows, key=lambda row: row[1]))
    old, new = passes_liu_layland_bound(task_set), passes_hyperbolic_bound(task_set)
    assert new or not old
    assert is_schedulable(task_set) or not new


@pytest.mark.parametrize("seed", range(25))
def test_audsley_finds_an_assignment_exactly_when_one_exists(seed: int) -> None:
    """Compared with all orders, with jitter, sections and deadlines beyond the period."""
    task_set = random_task_set(seed, longest=1.6)
    task_set = with_sections(TaskSet(task_set.tasks[:4]), seed)
    names = [task.name for task in task_set]
    exists = any(
        is_schedulable(task_set.with_priorities(order)) for order in itertools.permutations(names)
    )
    found = audsley(task_set)
    assert (found is not None) == exists
    assert found is None or is_schedulable(found)


def scaled(task_set: TaskSet, factor: Time, name: str = "") -> TaskSet:
    tasks = []
    for task in task_set:
        if not name or task.name == name:
            sections = tuple(
                replace(s, duration=s.duration * factor, start=s.start * factor)
                for s in task.sections
            )
            task = replace(task, wcet=task.wcet * factor, sections=sections)
        tasks.append(task)
    return TaskSet(tuple(tasks))


@pytest.mark.parametrize("seed", range(40))
def test_largest_scaling_is_the_border_of_schedulability(seed: int) -> None:
    """Deadlines hold at the factor and one is missed just above it, overheads included."""
    dice = random.Random(seed)
    costs = (
        Overheads()
        if seed % 2
        else Overheads(Fraction(1, 8), Fraction(1, 8), masked_section=Fraction(1, 2))
    )
    task_set = with_sections(random_task_set(seed, longest=dice.choice((1.0, 2.0))), seed)
    factor = largest_scaling(task_set, costs).factor
    if not factor:
        assert not is_schedulable(scaled(task_set, Fraction(1, 10**6)), costs)
        return
    assert is_schedulable(scaled(task_set, factor), costs)
    assert not is_schedulable(scaled(task_set, factor * ABOVE), costs)


@pytest.mark.parametrize("seed", range(40))
def test_largest_wcet_of_one_task_is_the_border_of_schedulability(seed: int) -> None:
    """The named task may execute that long, and not longer."""
    task_set = with_jitter(random_task_set(seed, longest=2.0), seed)
    for task in task_set:
        longest, _ = largest_wcet(task_set, task.name)
        if longest is None or longest == 0:
            assert not is_schedulable(scaled(task_set, Fraction(1, 10**6), task.name))
            continue
        border = task_set.with_task(replace(task, wcet=longest))
        beyond = task_set.with_task(replace(task, wcet=longest * ABOVE))
        assert is_schedulable(border) and not is_schedulable(beyond)


@pytest.mark.parametrize("seed", range(30))
def test_smallest_period_is_the_border_of_schedulability(seed: int) -> None:
    """The next smaller multiple of the step misses a deadline."""
    task_set = TaskSet.of(*[(t.wcet, 2 * t.period) for t in random_task_set(seed)])
    for task in task_set:
        found = smallest_period(task_set, task.name, 1)
        if found is None:
            assert not is_schedulable(task_set)
            continue
        assert is_schedulable(task_set.with_task(replace(task, period=found, deadline=found)))
        if found > 1:
            less = replace(task, period=found - 1, deadline=found - 1)
            assert not is_schedulable(task_set.with_task(less))


def reactions(task_set: TaskSet, chain: list[str], end: int, seed: int) -> list[Time]:
    """Delays from a change at the input to the end of the job that first carries it out."""
    run = simulate(task_set, end, releases=random_releases(seed))
    delays = []
    for change in range(0, end // 2, 3):
        instant: Time = change
        for name in chain:
            jobs = [j for j in run.jobs_of(name) if j.start is not None and j.start >= instant]
            if not jobs or jobs[0].completion is None:
                break
            instant = jobs[0].completion
        else:
            delays.append(instant - change)
    return delays


@pytest.mark.parametrize("seed", range(30))
def test_no_chain_reacts_later_than_its_bound(seed: int) -> None:
    """A change waits for the next job of each stage that starts after it."""
    task_set = random_task_set(seed)
    chain = [task.name for task in task_set][:3]
    random.Random(seed).shuffle(chain)
    bound = sampled_chain_bound(task_set, chain)
    observed = reactions(task_set, chain, 1200, seed)
    assert bound is not None and observed and max(observed) <= bound


def test_overheads_are_terms_of_their_own() -> None:
    """Switches, interrupt entries, ticks and masked sections appear beside the execution."""
    task_set = TaskSet(
        (
            Task("interrupt", 100, 2, 30, release="interrupt"),
            Task("fast", 50, 10, 2),
            Task("slow", 100, 20, 1),
        )
    )
    costs = Overheads(
        1, 2, 3, tick_period=10, tick=1, tick_first=2, tick_further=1, masked_section=4
    )
    found = response_time_bound(task_set, task_set.task("slow"), costs)
    terms = found.terms
    assert terms is not None
    assert terms.own == 20 and terms.interference_time == 2 + 2 * 10
    assert terms.context_switches == 3 * 3 and terms.interrupt_entries == 3
    assert terms.blocking.time == 4 and terms.blocking.cause == "masked"
    # In a window of 72: eight ticks and three releases by the clock.
    assert terms.clock == 8 * 1 + 3 * 2
    assert found.bound == terms.total == 72


def test_overloaded_priority_has_no_bound() -> None:
    """Above utilisation 1 the bound is None and the demand test fails."""
    task_set = TaskSet.of((3, 5), (3, 5))
    assert [found.bound for found in response_time_bounds(task_set)] == [3, None]
    assert not processor_demand_test(task_set).schedulable
    assert [found.bound for found in earliest_deadline_bounds(task_set)] == [None, None]
