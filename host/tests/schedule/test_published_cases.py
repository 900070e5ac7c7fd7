# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every case of the literature, to the digit."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from verification.support.timing.published_cases import HERSCHEL, HERSCHEL_PHASES, SETS

from ravenbrick.schedule.assignment import audsley, deadline_monotonic, rate_monotonic
from ravenbrick.schedule.bounds import (
    hyperbolic_product,
    liu_layland_bound,
    passes_hyperbolic_bound,
    passes_liu_layland_bound,
)
from ravenbrick.schedule.model import CriticalSection, Frame, Overheads, Task, TaskSet
from ravenbrick.schedule.offsets import phased_response_time_bounds
from ravenbrick.schedule.response_time import (
    ResponseTimeBound,
    is_schedulable,
    non_preemptive_bounds,
    response_time_bounds,
)
from ravenbrick.schedule.simulation import Protocol, simulate


def bounds(task_set: TaskSet) -> list[Fraction | int | None]:
    return [found.bound for found in response_time_bounds(task_set)]


@pytest.mark.parametrize("name", SETS)
def test_bounds_of_the_published_set_are_met_to_the_digit(name: str) -> None:
    """Each response-time bound equals the published or recomputed figure exactly."""
    rows, expected = SETS[name]
    assert bounds(TaskSet.of(*rows)) == [Fraction(text) for text in expected]


@pytest.mark.parametrize("name", SETS)
def test_terms_of_each_bound_add_up_to_it(name: str) -> None:
    """Own time, interference and blocking of the worst job sum to the bound."""
    for found in response_time_bounds(TaskSet.of(*SETS[name][0])):
        assert found.terms is not None and found.terms.total == found.bound


def test_set_a_fails_both_tests_and_its_last_task_misses() -> None:
    """U = .82 is above .78 and the third task needs 52 of 50."""
    task_set = TaskSet.of((10, 30), (10, 40), (12, 50))
    assert round(float(task_set.utilization), 2) == 0.82
    assert not passes_liu_layland_bound(task_set)
    assert [found.meets_deadline for found in response_time_bounds(task_set)] == [True, True, False]


def test_set_b_passes_the_utilisation_bound() -> None:
    """U = .775 is below .780, and the hyperbolic product is 1.969."""
    task_set = TaskSet.of((4, 16), (5, 40), (32, 80))
    assert task_set.utilization == Fraction(775, 1000)
    assert round(float(hyperbolic_product(task_set)), 3) == 1.969
    assert passes_liu_layland_bound(task_set) and passes_hyperbolic_bound(task_set)


def test_set_c_is_schedulable_at_full_utilisation() -> None:
    """U = 1, no quick test passes, and every deadline is met."""
    task_set = TaskSet.of((5, 20), (10, 40), (40, 80))
    assert task_set.utilization == 1
    assert not passes_hyperbolic_bound(task_set)
    assert is_schedulable(task_set)


def test_liu_and_layland_bounds_have_the_published_digits() -> None:
    """n (2^(1/n) - 1) for n = 1, 2, 3, 4, 5, 10 and its limit."""
    published = {1: 1.000, 2: 0.828, 3: 0.780, 4: 0.757, 5: 0.743, 10: 0.718, 10**9: 0.693}
    assert {count: round(liu_layland_bound(count), 3) for count in published} == published


@pytest.mark.parametrize(
    "tasks",
    [
        (Task("a", 10, 4, 2), Task("b", 20, 4, 1, deadline=5)),
        (Task("a", 10, 4, 2, release_jitter=7), Task("b", 20, 1, 1)),
        (Task("a", 10, 4, 2, blocking=7), Task("b", 20, 1, 1)),
        (
            Task("a", 10, 4, 2, sections=(CriticalSection("x", 1),)),
            Task("b", 40, 8, 1, sections=(CriticalSection("x", 8),)),
        ),
        (
            Task("a", 1, 1, 2, frames=(Frame(8, 10, 10), Frame(1, 10, 10), Frame(1, 10, 10))),
            Task("b", 10, 4, 1),
        ),
        (Task("a", 20, 4, 2), Task("b", 5, 2, 1)),
    ],
    ids=["deadline", "jitter", "blocking", "section", "frames", "order"],
)
def test_a_light_set_that_can_miss_a_deadline_passes_no_utilisation_bound(
    tasks: tuple[Task, ...],
) -> None:
    """The bounds need independent tasks, D >= T, rate monotonic; here one condition fails."""
    task_set = TaskSet(tasks)
    assert float(task_set.utilization) < liu_layland_bound(2)
    assert not is_schedulable(task_set)
    assert not passes_liu_layland_bound(task_set) and not passes_hyperbolic_bound(task_set)


def test_reversed_order_of_liu_and_layland_s_pair_allows_only_one_unit_each() -> None:
    """With the long period on top C1 = C2 = 1 just fits, and C2 = 2 does not."""
    fast, slow = Task("fast", 2, 1, 1), Task("slow", 5, 1, 2)
    assert bounds(TaskSet((slow, fast))) == [1, 2]
    assert not is_schedulable(TaskSet((replace(slow, wcet=2), fast)))
    assert is_schedulable(rate_monotonic(TaskSet((replace(slow, wcet=2), fast))))


def test_deadline_monotonic_order_is_feasible_where_rate_monotonic_is_not() -> None:
    """The book's table for D < T: R = 3, 6, 10, 20."""
    task_set = TaskSet.of((4, 10, 10), (3, 20, 20), (3, 15, 7), (3, 20, 5))
    assert bounds(deadline_monotonic(task_set)) == [3, 6, 10, 20]
    assert not is_schedulable(rate_monotonic(task_set))


@pytest.mark.parametrize("turn", range(4))
def test_audsley_finds_a_feasible_order_from_any_order_of_input(turn: int) -> None:
    """The deadline monotonic table has a feasible assignment however it is given."""
    rows = [(3, 20, 5), (3, 15, 7), (4, 10, 10), (3, 20, 20)]
    found = audsley(TaskSet.of(*rows[turn:], *rows[:turn]))
    assert found is not None and is_schedulable(found)


def test_lehoczky_s_busy_period_holds_seven_jobs() -> None:
    """The fifth job has the worst response time, 118; the busy period lasts 694."""
    found = response_time_bounds(TaskSet.of((26, 70), (62, 100)))[1]
    assert found.jobs == (114, 102, 116, 104, 118, 106, 94)
    assert found.busy_period == 694
    assert found.terms is not None and found.terms.job == 4


def test_monotonic_orders_fail_where_the_other_order_is_feasible_for_long_deadlines() -> None:
    """With D > T the urgent-deadline order misses 154 and the reverse is found by Audsley."""
    task_set = TaskSet.of((52, 100, 110), (52, 140, 154))
    assert not is_schedulable(rate_monotonic(task_set))
    assert not is_schedulable(deadline_monotonic(task_set))
    found = audsley(task_set)
    assert found is not None and found.by_priority()[0].name == "t2"
    assert is_schedulable(found)


def test_release_jitter_of_the_first_task_delays_all() -> None:
    """Set D with a jitter of 2: 5, 9, 23 from the arrival."""
    first, *others = TaskSet.of((3, 7), (3, 12), (5, 20))
    assert bounds(TaskSet((replace(first, release_jitter=2), *others))) == [5, 9, 23]


def test_jitter_counts_from_the_release_or_from_the_arrival() -> None:
    """10 and 13 from the release, 15 and 19 with the task's own jitter."""
    task_set = TaskSet((Task("t11", 30, 10, 2, release_jitter=5), Task("t12", 15, 3, 1, 30, 6)))
    found = response_time_bounds(task_set)
    assert [each.from_release for each in found] == [10, 13]
    assert [each.bound for each in found] == [15, 19]


def test_a_jitter_longer_than_the_period_releases_two_jobs_at_once() -> None:
    """By hand: jobs arrive at 0 and 4, both are released at 6 and end at 7 and 8."""
    (found,) = response_time_bounds(TaskSet((Task("t", 4, 1, 1, 12, release_jitter=6),)))
    assert found.jobs[:2] == (7, 4)
    assert (found.bound, found.from_release) == (7, 2)


def test_non_preemptive_analysis_examines_the_second_job() -> None:
    """The last message needs 3.5; its first instance alone would say 3 (Davis et al. 2007)."""
    found = non_preemptive_bounds(TaskSet.of((1, "2.5"), (1, "3.5"), (1, "3.5")))
    assert [each.bound for each in found] == [2, 3, Fraction(7, 2)]
    assert found[2].jobs[0] == 3
    assert all(each.terms is not None and each.terms.total == each.bound for each in found)


def test_non_preemptive_analysis_of_a_full_processor_examines_one_repetition() -> None:
    """By hand: a and b need all of it, H = 12. After 1 of c, b starts at 3 and, its second job, at
    10: responses 6 and 7. The next repetition is like the first (Lehoczky 1990)."""
    found = non_preemptive_bounds(TaskSet.of((2, 4), (3, 6), (1, 100)))
    assert [each.bound for each in found] == [5, 7, None]
    assert (found[1].jobs, found[1].busy_period) == ((6, 7), None)


@pytest.mark.parametrize(
    ("protocol", "expected"),
    [("none", (17, 8, 6, 12)), ("inheritance", (17, 14, 12, 9)), ("ceiling", (17, 14, 12, 7))],
)
def test_resource_protocols_give_the_book_s_charts(
    protocol: Protocol, expected: tuple[int, ...]
) -> None:
    """Four tasks sharing Q and V under three protocols: response times of a, b, c, d."""
    tasks = [
        Task(name, 100, wcet, priority, phase=phase, sections=sections)
        for name, wcet, priority, phase, sections in (
            ("a", 6, 1, 0, (CriticalSection("Q", 4, 1),)),
            ("b", 2, 2, 2, ()),
            ("c", 4, 3, 2, (CriticalSection("V", 2, 1),)),
            ("d", 5, 4, 4, (CriticalSection("Q", 1, 2), CriticalSection("V", 1, 3))),
        )
    ]
    run = simulate(TaskSet(tuple(tasks)), 100, protocol=protocol)
    assert tuple(run.response_time_max(name) for name in "abcd") == expected


def herschel() -> list[ResponseTimeBound]:
    tasks = [
        Task(name, period, wcet, len(HERSCHEL) - rank, deadline, blocking=blocking)
        for rank, (name, row) in enumerate(HERSCHEL)
        for period, wcet, deadline, blocking in [[value or 0 for value in row[:4]]]
    ]
    return list(response_time_bounds(TaskSet(tuple(tasks))))


def test_satellite_s_bounds_equal_the_recomputed_column() -> None:
    """Herschel-Planck with the stated blocking: every given row to the microsecond."""
    given = [(name, row[6]) for name, row in HERSCHEL if row[6] is not None]
    found = {each.task.name: each.bound for each in herschel()}
    assert len(given) == 20
    assert {name: found[name] for name, _ in given} == dict(given)


def test_satellite_s_bounds_are_never_below_the_model_checker_s() -> None:
    """Each bound is at least the response time that model checking reached."""
    found = {each.task.name: each.bound for each in herschel()}
    reached = [(name, row[5]) for name, row in HERSCHEL if row[5] is not None]
    assert len(reached) == 21
    assert all(found[name] >= time for name, time in reached)


def test_satellite_s_bounds_lie_near_the_builder_s_analysis() -> None:
    """About two of three rows lie within 5 % of the builder's bounds, which knew of offsets."""
    found = {each.task.name: each.bound for each in herschel()}
    published = [(name, row[4]) for name, row in HERSCHEL if row[4] is not None]
    near = [name for name, time in published if abs(found[name] - time) <= time / 20]
    assert len(published) == 21 and len(near) >= 13


def phased_herschel() -> dict[str, ResponseTimeBound]:
    tasks = []
    for found in herschel():
        task = found.task
        if task.name == "Spw_Isr":
            tasks.append(replace(task, release="sporadic"))
        elif task.name == "PrimaryF":
            # It waits 2.971 ms for the hardware inside its job, which nothing above accounts for.
            waits = task.blocking + Fraction("2.971")
            tasks.append(replace(task, blocking=waits, phase=Fraction(20)))
        else:
            tasks.append(replace(task, phase=Fraction(HERSCHEL_PHASES.get(task.name, "0"))))
    return {each.task.name: each for each in phased_response_time_bounds(TaskSet(tuple(tasks)))}


def test_satellite_s_phases_shorten_its_bounds_and_keep_them_above_the_model_checker_s() -> None:
    """Three tasks respond within 20 ms, all in time; no bound is below what is reached."""
    found = phased_herschel()
    assert all(found[name].bound <= 20 for name in ("Hk_P", "Sgm_P", "TcRouter_P"))
    assert all(each.meets_deadline for each in found.values())
    assert all(found[name].bound >= row[5] for name, row in HERSCHEL if row[5] is not None)
    assert all(
        found[each.task.name].bound <= each.bound
        for each in herschel()
        if each.task.name != "PrimaryF"
    )


def test_overheads_of_the_ada_application_raise_its_bounds_by_less_than_one_percent() -> None:
    """With the published blocking, a 1 ms tick of 3 us and switches of 2 us (assumed costs)."""
    rows = [("0.01", 5000), ("482.59", 1000), ("312.34", 3000), ("198.64", 3000)]
    plain = response_time_bounds(TaskSet.of(*rows))
    tasks = [
        replace(task, blocking=Fraction(blocking))
        for task, blocking in zip(TaskSet.of(*rows), ("0.001", "0.002", "0.001", "0"), strict=True)
    ]
    costs = Overheads(
        switch_in=Fraction("0.002"),
        switch_out=Fraction("0.002"),
        tick_period=1,
        tick=Fraction("0.003"),
        tick_first=Fraction("0.001"),
        tick_further=Fraction("0.0005"),
    )
    for bare, full in zip(
        plain[1:], response_time_bounds(TaskSet(tuple(tasks)), costs)[1:], strict=True
    ):
        assert bare.bound is not None and full.bound is not None
        assert bare.bound < full.bound < bare.bound * Fraction(101, 100)


def test_rust_version_of_the_application_matches_the_plain_analysis() -> None:
    """With a blocking of 2 on the first task: 3, 304, 415, 466."""
    first, *others = TaskSet.of((1, 5000), (303, 1000), (111, 3000), (51, 3000))
    assert bounds(TaskSet((replace(first, blocking=2), *others))) == [3, 304, 415, 466]
