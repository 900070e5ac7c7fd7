# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bounds from known phases, kinds of jobs and requests, beside the exact simulator: never below."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from typing import Any

import pytest
from verification.support.timing.random_task_sets import (
    random_releases,
    random_task_set,
    with_phases,
    with_sections,
)

from ravenbrick.schedule.beginning import JobKind, Known, Request
from ravenbrick.schedule.blocking import blocking_candidates
from ravenbrick.schedule.demand import Source
from ravenbrick.schedule.model import NO_OVERHEADS, CriticalSection, Task, TaskSet
from ravenbrick.schedule.offsets import (
    phased_response_time_bound,
    phased_response_time_bounds,
)
from ravenbrick.schedule.quantity import Time
from ravenbrick.schedule.response_time import (
    ResponseTimeBound,
    response_time_bound,
    response_time_bounds,
)
from ravenbrick.schedule.simulation import simulate

SEEDS = range(60)
Case = Callable[[int], tuple[TaskSet, TaskSet, Known]]


def plain_responses(task_set: TaskSet) -> Known:
    return Known({found.task.name: found.bound for found in response_time_bounds(task_set)})


@pytest.mark.parametrize("seed", SEEDS)
def test_no_run_exceeds_a_bound_without_blocking_by_jobs_that_are_over(seed: int) -> None:
    """With sections, a common release or random phases, and one task without a phase."""
    task_set = with_phases(with_sections(random_task_set(seed), seed), seed)
    tasks = [replace(task, phase=0) for task in task_set] if seed % 2 else list(task_set)
    free = seed % (len(tasks) + 1)
    if free < len(tasks):
        tasks[free] = replace(tasks[free], phase=None, release="sporadic")
    task_set = TaskSet(tuple(tasks))
    bounds = {found.task.name: found.bound for found in phased_response_time_bounds(task_set)}
    for pattern in range(4):
        run = simulate(task_set, 400, releases=random_releases(10 * seed + pattern))
        for name, bound in bounds.items():
            assert bound is not None and (run.response_time_max(name) or 0) <= bound


def ending_outside_of_sections(seed: int) -> tuple[TaskSet, list[ResponseTimeBound], bool]:
    """A less urgent task that is over about a release of a more urgent one, and ends outside
    of its section; the bounds without that section; whether one is closer for that."""
    rng = random.Random(seed)
    short, burst = rng.randint(1, 3), rng.randint(1, 4)
    fast = Task("fast", 20, short, 2, phase=0)
    interrupt = Task("interrupt", 60, burst, 3, release="interrupt")
    wcet = 20 - short - burst - rng.randint(-6, 2)
    length = rng.randint(2, wcet - 1)
    inside = CriticalSection("shared", length, rng.randint(0, wcet - 1 - length))
    slow = Task("slow", 60, wcet, 1, phase=0, sections=(inside,))
    fast = replace(fast, sections=(CriticalSection("shared", 1),))
    task_set = TaskSet((interrupt, fast, slow))

    def bounds(closer: bool) -> list[ResponseTimeBound]:
        def stated(task: Task, absent: frozenset[str], ended: frozenset[str]) -> Time:
            out = absent | ended if closer else absent
            found = blocking_candidates(task_set, task, NO_OVERHEADS)
            return max((b.time for b in found if b.task not in out), default=0)

        known = replace(plain_responses(task_set), blocking=stated)
        return [
            phased_response_time_bound(task_set, task, NO_OVERHEADS, known) for task in (fast, slow)
        ]

    found = bounds(closer=True)
    return task_set, found, found != bounds(closer=False)


@pytest.mark.parametrize("seed", SEEDS)
def test_no_run_exceeds_a_bound_without_sections_of_jobs_that_are_over_by_a_release(
    seed: int,
) -> None:
    task_set, bounds, _ = ending_outside_of_sections(seed)
    interrupt = task_set.task("interrupt")
    for phase in range(60):
        run = simulate(task_set.with_task(replace(interrupt, release="cyclic", phase=phase)), 240)
        for found in bounds:
            assert found.bound is not None
            assert (run.response_time_max(found.task.name) or 0) <= found.bound


def test_sections_of_jobs_that_are_over_by_a_release_make_bounds_longer() -> None:
    assert sum(ending_outside_of_sections(seed)[2] for seed in SEEDS) > len(SEEDS) / 6


def test_a_less_urgent_job_that_is_over_blocks_nobody() -> None:
    """The slow task ends before each release of the fast one but those that it shares."""
    section = (CriticalSection("shared", 2),)
    fast = Task("fast", 10, 2, 2, phase=0, sections=(replace(section[0], duration=1),))
    slow = Task("slow", 20, 3, 1, phase=0, sections=section)
    together = TaskSet((fast, slow))
    assert [found.bound for found in phased_response_time_bounds(together)] == [2, 5]
    late = TaskSet((fast, replace(slow, phase=9)))
    assert [found.bound for found in phased_response_time_bounds(late)] == [4, 5]


def alternating(seed: int) -> tuple[TaskSet, TaskSet, Known]:
    """A link that starts interrupts, one each third cycle, in every other job, which is the shorter
    one, and a task whose jobs make a device work after their end: the simulator's tasks, the
    analysis', and what it knows."""
    rng = random.Random(seed)
    long, short, burst = rng.randint(3, 7), rng.randint(1, 3), rng.randint(4, 6)
    low = Task("low", 40, rng.randint(1, 6), 1, phase=0)
    middle = Task("middle", rng.choice((20, 40)), rng.randint(1, 5), 2, phase=0)
    link = Task("link", 20, long, 3, phase=0)
    limits = ((Fraction(1, burst), 3, 3),)
    interrupts = Task("interrupts", 20, burst, 4, release="interrupt", limits=limits)
    device = Task("device", 40, 1, 4, release="interrupt")
    analysed = TaskSet((device, interrupts, link, middle, low))
    kinds = {"link": (JobKind(long, (("interrupts", Fraction(0)),)), JobKind(short))}
    known = replace(
        plain_responses(analysed), requests=(Request("device", ("low",), 5),), kinds=kinds
    )
    end = known.responses["low"]
    assert end is not None
    begin = 20 + rng.randint(0, 2)
    each = [
        Task(f"interrupt {n}", 40, 1, 4, phase=begin + 3 * n, deadline=40) for n in range(burst)
    ]
    simulated = TaskSet(
        (
            *each,
            Task("device", 40, 1, 4, phase=end + rng.randint(0, 5)),
            Task("long", 40, long, 3, phase=0),
            Task("short", 40, short, 3, phase=20),
            middle,
            low,
        )
    )
    return simulated, analysed, known


def kinds_in_turn(seed: int) -> tuple[TaskSet, TaskSet, Known]:
    """As `alternating`, where it is known which jobs come when: each of both kinds has one of the
    times in turn, the job with interrupts in the second one."""
    simulated, analysed, known = alternating(seed)
    link, short = analysed.task("link"), simulated.task("short").wcet
    analysed = analysed.with_task(replace(link, turns=(link.wcet, short)))
    first, second = known.kinds["link"]
    kinds = (replace(first, turns=(link.wcet, 1)), replace(second, turns=(1, short)))
    return simulated, analysed, replace(known, kinds={"link": kinds})


@pytest.mark.parametrize("seed", SEEDS)
def test_bounds_below_jobs_that_take_their_times_in_turn_are_exact(seed: int) -> None:
    rng = random.Random(seed)
    turns = tuple(rng.randint(1, 6) for _ in range(rng.choice((2, 2, 3, 4))))
    period = rng.choice((8, 10, 12))
    top = Task("top", period, max(turns), 3, phase=rng.randint(0, 11), turns=turns)
    others = [
        Task(name, multiple * period, rng.randint(1, 9), priority, phase=rng.randint(0, 40))
        for name, multiple, priority in (("middle", rng.choice((2, 3)), 2), ("low", 4, 1))
    ]
    each = [
        replace(top, name=f"top {n}", period=len(turns) * period, wcet=wcet, turns=(),
                deadline=len(turns) * period, phase=int(top.phase or 0) + n * period)
        for n, wcet in enumerate(turns)
    ]  # fmt: skip
    run = simulate(TaskSet((*each, *others)), 2_000)
    bounds = phased_response_time_bounds(TaskSet((top, *others)))
    for found in bounds[1:]:
        if found.bound is not None and found.bound <= found.task.period:
            assert run.response_time_max(found.task.name) == found.bound


def interrupted_before(seed: int) -> tuple[TaskSet, TaskSet, Known]:
    """As `alternating`, but the interrupts of the shorter job come, some late, just before the
    longer one is released, and the least urgent task may block the middle one."""
    simulated, analysed, known = alternating(seed)
    rng = random.Random(1000 + seed)
    burst = [task for task in simulated if task.name.startswith("interrupt ")]
    first = 40 - 3 * (len(burst) - 1) - rng.randint(1, 3)
    times = [min(39, first + 3 * n + rng.randint(0, 3)) for n in range(len(burst))]
    found = []
    for task_set in (simulated, analysed):
        low, middle = task_set.task("low"), task_set.task("middle")
        changed = [
            replace(low, sections=(CriticalSection("shared", low.wcet),)),
            replace(middle, sections=(CriticalSection("shared", 1),)),
        ]
        for each in changed:
            task_set = task_set.with_task(each)
        found.append(task_set)
    for task, time in zip(burst, times, strict=True):
        found[0] = found[0].with_task(replace(task, phase=time))
    return found[0], found[1], replace(known, responses=plain_responses(found[1]).responses)


def requested_above(seed: int) -> tuple[TaskSet, TaskSet, Known]:
    """A more urgent task whose jobs make a device work after their end, up to a while later; the
    tasks below are released at other times, some of them while it may work."""
    rng = random.Random(seed)
    lasts, burst = rng.randint(0, 12), rng.randint(1, 5)
    top = Task("top", 80, rng.randint(1, 5), 3, phase=0)
    middle = Task("middle", 20, rng.randint(1, 4), 2, phase=rng.randint(0, 19))
    low = Task("low", 40, rng.randint(1, 8), 1, phase=rng.randint(0, 39))
    device = Task("device", 80, burst, 4, release="interrupt")
    analysed = TaskSet((device, top, middle, low))
    request = Request("device", ("top",), lasts)
    known = replace(plain_responses(analysed), requests=(request,))
    working = replace(device, release="cyclic", phase=top.wcet + rng.randint(0, lasts))
    return analysed.with_task(working), analysed, known


@cache
def requested_by_itself(seed: int, since_release: bool = False) -> tuple[TaskSet, TaskSet, Known]:
    """A task that makes a device work from some place of its jobs on, perhaps in a section, until a
    while after their end; perhaps a more urgent one does, too. The device interrupts as often as it
    may, or a while later. It may do so `since_release` of the job, which is no such place."""
    rng = random.Random(seed)
    period, lasts, length = rng.choice((40, 80)), rng.choice((2, 12, 30)), rng.choice((0, 2, 7))
    wcet = length + rng.randint(4, 9)
    start = rng.randint(1, wcet - length)
    place = rng.choice((start, start + length)) if length else rng.randint(1, wcet - 1)
    top = Task("top", 10, rng.randint(1, 2), 3, phase=0, sections=(CriticalSection("shared", 1),))
    middle = Task("middle", 40, rng.randint(1, 5), 2, phase=rng.randint(0, 39))
    sections = (CriticalSection("shared", length, start),) if length else ()
    low = Task("low", period, wcet, 1, phase=rng.randint(0, 39), sections=sections)
    other = Task("other", 160, rng.randint(1, 5), 1, phase=rng.randint(0, 39))
    before = CriticalSection("shared", min(length, place - start), start)
    part = replace(low, wcet=place, sections=(before,) if before.duration > 0 else ())
    simulated = TaskSet((top, middle, low, other))
    requesting: tuple[str, ...] = ("low",)
    times: list[int] = []
    if rng.random() < 0.3:
        requesting, times = ("low", "middle"), list(range(int(middle.phase or 0), 240, 40))
    for job in range(240 // period - 1):
        released = int(low.phase or 0) + job * period
        begin = released if since_release else _done_at(simulated, low, part, released, times)
        at = begin + rng.choice((0, 0, rng.randint(0, lasts)))
        end = _done_at(simulated, low, low, released, times)
        while at <= end + lasts:
            if all(abs(at - known) >= 4 for known in times):
                times.append(at)
                end = _done_at(simulated, low, low, released, times)
            at += 1
    device = Task("device", 4, 1, 4, release="interrupt")
    analysed = TaskSet((device, *simulated))
    request = Request("device", requesting, lasts, (("low", wcet - place + length),))
    known = replace(plain_responses(analysed), requests=(request,))
    return TaskSet((*_interrupts(times), *simulated)), analysed, known


def _interrupts(times: Iterable[int]) -> list[Task]:
    return [Task(f"device {at}", 400, 1, 4, phase=at, deadline=400) for at in times]


def _done_at(task_set: TaskSet, low: Task, last: Task, released: int, times: list[int]) -> int:
    """When the job of `low` of this release is over, if it is one of `last`."""
    earlier = range(int(low.phase or 0), released, int(low.period))
    jobs = [replace(low, name=f"low {at}", period=400, phase=at) for at in earlier]
    jobs.append(replace(last, name="last", period=400, phase=released, deadline=400))
    others = [task for task in task_set if task.name != "low"]
    run = simulate(TaskSet((*_interrupts(times), *others, *jobs)), 400)
    return released + int(run.response_time_max("last") or 0)


def compared(
    seed: int, without_interrupts: bool = False, case: Case = alternating
) -> list[tuple[Time, Time, Time]]:
    """Longest response, bound, and bound without kinds and requests, of the two tasks below."""
    simulated, analysed, known = case(seed)
    if without_interrupts:
        first, second = known.kinds["link"]
        known = replace(known, kinds={"link": (first, replace(second, most=first.most))})
    run, rows = simulate(simulated, 400), []
    for name in ("middle", "low"):
        task = analysed.task(name)
        found = phased_response_time_bound(analysed, task, NO_OVERHEADS, known).bound
        loose = response_time_bound(analysed, task).bound
        assert found is not None and loose is not None
        rows.append((run.response_time_max(name) or 0, found, loose))
    return rows


@pytest.mark.parametrize(
    "case",
    [alternating, kinds_in_turn, interrupted_before, requested_above, requested_by_itself],
)
@pytest.mark.parametrize("seed", SEEDS)
def test_no_run_exceeds_a_bound_with_kinds_of_jobs_and_requests(seed: int, case: Case) -> None:
    assert all(seen <= bound <= loose for seen, bound, loose in compared(seed, case=case))


def test_interrupts_just_before_a_job_that_starts_none_delay_what_is_below() -> None:
    """Two at once, a cycle before: one of them is served after the release of the longer job."""
    limits = ((Fraction(1, 2), 3, 3),)
    interrupts = Task("interrupts", 20, 2, 4, release="interrupt", limits=limits)
    link, low = Task("link", 20, 5, 3, phase=0), Task("low", 40, 2, 1, phase=0)
    kinds = {"link": (JobKind(5, (("interrupts", Fraction(0)),)), JobKind(1))}
    analysed = TaskSet((interrupts, link, low))
    known = replace(plain_responses(analysed), kinds=kinds)
    bound = phased_response_time_bound(analysed, low, NO_OVERHEADS, known).bound
    each = [Task(f"interrupt {n}", 40, 1, 4, phase=39) for n in range(2)]
    long, short = Task("long", 40, 5, 3, phase=0), Task("short", 40, 1, 3, phase=20)
    run = simulate(TaskSet((*each, long, short, low)), 400)
    assert run.response_time_max("low") == 8
    assert bound is not None and 8 <= bound < 5 + 2 + 3


def test_what_is_over_delays_nobody_before_the_start_either() -> None:
    """The lead has no section of a task that is over by then, so two interrupts instead of six."""
    limits = ((Fraction(1, 6), 3, 3),)
    interrupts = Task("interrupts", 40, 6, 4, release="interrupt", limits=limits)
    section = (CriticalSection("shared", 9),)
    link = Task("link", 40, 5, 3, phase=0)
    middle = Task("middle", 40, 2, 2, phase=0, sections=(replace(section[0], duration=1),))
    low = Task("low", 80, 9, 1, phase=0, sections=section)
    kinds = {"link": (JobKind(5, (("interrupts", Fraction(0)),)),)}
    bounds = []
    for slow in (low, replace(low, phase=None, release="sporadic")):
        analysed = TaskSet((interrupts, link, middle, slow))
        known = replace(plain_responses(analysed), kinds=kinds)
        bounds.append(phased_response_time_bound(analysed, middle, NO_OVERHEADS, known).bound)
    assert bounds == [5 + 2 + 2, 22]


def test_kinds_of_jobs_and_requests_make_most_bounds_closer() -> None:
    rows = [row for seed in SEEDS for row in compared(seed)]
    assert sum(bound < loose for _, bound, loose in rows) > len(rows) // 2


def test_interrupts_that_a_more_urgent_job_requested_are_left_out_after_it_only() -> None:
    rows = [row for seed in SEEDS for row in compared(seed, case=requested_above)]
    assert sum(bound < loose for _, bound, loose in rows) > len(rows) // 8

    def longer(seed: int) -> tuple[TaskSet, TaskSet, Known]:
        """The device works later than is said."""
        simulated, analysed, known = requested_above(seed)
        (request,) = known.requests
        device = simulated.task("device")
        late = replace(device, phase=simulated.task("top").wcet + request.lasts + 20)
        return simulated.with_task(late), analysed, known

    late = [row for seed in SEEDS for row in compared(seed, case=longer)]
    assert any(seen > bound for seen, bound, _ in late)


def test_interrupts_that_a_job_requests_itself_are_left_out_before_its_request_only() -> None:
    rows = [row for seed in SEEDS for row in compared(seed, case=requested_by_itself)]
    assert sum(bound < loose for _, bound, loose in rows) > len(rows) // 8
    sooner = partial(requested_by_itself, since_release=True)
    early = [row for seed in SEEDS for row in compared(seed, case=sooner)]
    assert any(seen > bound for seen, bound, _ in early)


LOW, UPPER = Task("low", 20, 6, 1, phase=0), Task("upper", 20, 2, 2, phase=0)


@pytest.mark.parametrize(
    ("tasks", "times", "made", "stated"),
    [
        ((LOW,), range(8, 80, 4), Request("device", ("low",), 20), {"lasts": 0}),
        ((UPPER, LOW), (0, 4, 8), Request("device", ("low", "upper"), 8), {"tasks": ("low",)}),
    ],
    ids=["by the job before", "by a more urgent job"],
)
def test_interrupts_that_another_job_requested_are_not_left_out(
    tasks: tuple[Task, ...], times: Iterable[int], made: Request, stated: dict[str, Any]
) -> None:
    """If nothing is said of it, they show as a response above the bound."""
    analysed = TaskSet((Task("device", 4, 1, 4, release="interrupt"), *tasks))
    run = simulate(TaskSet((*_interrupts(times), *tasks)), 80)
    made = replace(made, rest=(("low", 1),))
    for request, holds in ((made, True), (replace(made, **stated), False)):
        known = replace(plain_responses(analysed), requests=(request,))
        found = phased_response_time_bound(analysed, LOW, NO_OVERHEADS, known).bound
        assert found is not None and (run.response_time_max("low") <= found) == holds


def test_the_section_before_a_request_counts_as_more_urgent_jobs_wait_for_its_end() -> None:
    """The upper task is released just behind its beginning, and anew soon after the request."""
    shared = CriticalSection("shared", 1)
    top = Task("top", 10, 3, 3, phase=0, sections=(shared,))
    low = Task("low", 80, 11, 1, phase=7, sections=(replace(shared, duration=7, start=2),))
    analysed = TaskSet((Task("device", 4, 1, 4, release="interrupt"), top, low))
    run = simulate(TaskSet((*_interrupts((16, 20, 24)), top, low)), 80)
    for rest, holds in ((2 + 7, True), (2, False)):
        request = Request("device", ("low",), 0, (("low", rest),))
        known = replace(plain_responses(analysed), requests=(request,))
        found = phased_response_time_bound(analysed, low, NO_OVERHEADS, known).bound
        assert found is not None and (run.response_time_max("low") <= found) == holds


def test_interrupts_that_a_kind_leaves_out_show_as_a_response_above_the_bound() -> None:
    rows = [row for seed in SEEDS for row in compared(seed, without_interrupts=True)]
    assert any(seen > bound for seen, bound, _ in rows)


def test_periodic_jobs_with_lateness_are_as_many_as_their_model_says() -> None:
    """Periodic with jitter (Richter 2005): two at once, then one each period."""
    burst = Task("burst", 1000, 100, limits=((Fraction(1, 10), 20, 20),))
    source = Source(burst, burst.period, 0, burst.wcet, 0)
    counts = {window: source.work(window)[0] * 10 for window in (1, 20, 21, 40, 41, 199)}
    assert counts == {1: 2, 20: 2, 21: 3, 40: 3, 41: 4, 199: 10}
