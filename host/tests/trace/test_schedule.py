# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import itertools
import json
import random
from collections import Counter
from collections.abc import Collection

import pytest
from verification.support.recordings import Event
from verification.support.recordings import made as recording

from ravenbrick.catalogue import event_numbers
from ravenbrick.project.robot import Task
from ravenbrick.trace.recording import IDLE, EventKind, Recording
from ravenbrick.trace.schedule import (
    IDLE_OWNER,
    INTERRUPT_OWNER,
    KERNEL_OWNER,
    TaskMeasures,
    Utilization,
    jobs_of,
    measure_tasks,
    segments,
    stretches,
    task_plan,
)

K = EventKind


def measure_task(run: Recording, thread: int, task: Task | None) -> TaskMeasures:
    """Of one thread, with a task set of one task or of none."""
    name = run.threads[thread].name
    found = measure_tasks(run, () if task is None else (task,))
    return next(measures for measures in found if measures.name == name)


def utilization(run: Recording, background: Collection[str] = ()) -> Utilization:
    """Shares of a run with these background threads."""
    tasks = [Task(t.name, "", "cyclic", 100, 100, 1, 1024) for t in run.threads]
    plan = {"tasks": task_plan(task for task in tasks if task.name not in background)}
    answer = json.loads(run.native.measure(json.dumps(plan)).answer("{}"))
    shares = answer["measures"]["utilization"]
    return Utilization(**{**shares, "threads": tuple(shares["threads"])})


def task(deadline_us: int) -> Task:
    """A cyclic task of 100 microseconds."""
    return Task("task_1", "", "cyclic", 100, deadline_us, 1, 1024)


# Task 1 preempts task 0: released at 10, starts 12, ends 20; then task 0 goes on to 50; and so on.
PREEMPTION: list[Event] = [
    (0, K.PROCESSOR_STOPPED, 0, 0),
    (5, K.PROCESSOR_RESUMED, 0, 0),
    (5, K.RELEASE, 0, 4),
    (6, K.THREAD_RUNNING, 0, 0),
    (10, K.INTERRUPT_ENTERED, 3, 0),
    (11, K.RELEASE, 1, 10),
    (11, K.INTERRUPT_LEFT, 3, 0),
    (12, K.THREAD_RUNNING, 1, 0),
    (20, K.COMPLETION, 1, 10),
    (20, K.THREAD_RUNNING, 0, 0),
    (50, K.COMPLETION, 0, 4),
    (50, K.THREAD_RUNNING, IDLE, 0),
    (52, K.PROCESSOR_STOPPED, 0, 0),
    (110, K.PROCESSOR_RESUMED, 0, 0),
    (111, K.RELEASE, 1, 110),
    (117, K.THREAD_RUNNING, 1, 0),
    (130, K.COMPLETION, 1, 110),
    (130, K.THREAD_RUNNING, IDLE, 0),
    (132, K.PROCESSOR_STOPPED, 0, 0),
]


def test_response_times_run_from_nominal_release_to_completion() -> None:
    """Minimum, mean and maximum over the jobs, by hand: 10 and 20 cycles."""
    measures = measure_task(recording(PREEMPTION, 200), 1, task(100))
    assert measures.releases == 2
    assert measures.response_time_cycles_min == 10
    assert measures.response_time_cycles_mean == 15.0
    assert measures.response_time_cycles_max == 20


def test_release_jitter_is_the_spread_of_the_release_latencies() -> None:
    """First executions 2 and 7 cycles after the release: a jitter of 5."""
    measures = measure_task(recording(PREEMPTION, 200), 1, task(100))
    assert measures.release_latency_cycles_max == 7
    assert measures.release_jitter_cycles == 5


def test_a_preempted_job_keeps_its_first_start() -> None:
    """Resuming after a preemption is not another start."""
    (job,) = jobs_of(recording(PREEMPTION, 200), 0)
    assert (job.release_cycles, job.start_cycles, job.completion_cycles) == (4, 6, 50)


@pytest.mark.parametrize(("deadline", "misses"), [(20, 0), (19, 1), (9, 2)])
def test_a_deadline_is_missed_by_completing_after_it(deadline: int, misses: int) -> None:
    """Completion exactly at the deadline is in time."""
    assert measure_task(recording(PREEMPTION, 200), 1, task(deadline)).deadline_misses == misses


def test_a_job_that_never_completes_misses_a_deadline_that_has_passed() -> None:
    """A hanging task is not forgiven because the run ends."""
    events = [*PREEMPTION, (150, K.RELEASE, 1, 150)]
    assert measure_task(recording(events, 200), 1, task(49)).deadline_misses == 1
    assert measure_task(recording(events, 200), 1, task(51)).deadline_misses == 0


def test_an_overrun_job_counts_from_its_nominal_release() -> None:
    """A release in the past, while the task runs, starts when the former job ends."""
    events: list[Event] = [
        (10, K.RELEASE, 1, 10),
        (11, K.THREAD_RUNNING, 1, 0),
        (130, K.COMPLETION, 1, 10),
        (130, K.RELEASE, 1, 110),
        (160, K.COMPLETION, 1, 110),
        (160, K.THREAD_RUNNING, IDLE, 0),
    ]
    measures = measure_task(recording(events, 200), 1, task(100))
    assert measures.response_time_cycles_max == 120
    assert measures.deadline_misses == 1
    assert measures.release_latency_cycles_max == 20


def test_a_job_released_while_its_task_runs_starts_at_its_release_and_not_before() -> None:
    """The kernel may release a moment early; the job of a sleeping task starts when selected."""
    for at, nominal, running, start in [(98, 100, True, 100), (103, 100, True, 103)]:
        events: list[Event] = [
            (10, K.THREAD_RUNNING, 1 if running else 0, 0),
            (at, K.RELEASE, 1, nominal),
            (150, K.COMPLETION, 1, nominal),
        ]
        (job,) = jobs_of(recording(events, 200), 1)
        assert (job.release_cycles, job.start_cycles) == (nominal, start)
    (job,) = jobs_of(recording([(10, K.THREAD_RUNNING, 0, 0), (20, K.RELEASE, 1, 20)], 200), 1)
    assert job.start_cycles is None


def test_segments_cover_the_run_without_gap_or_overlap() -> None:
    """Each cycle has exactly one owner."""
    found = segments(recording(PREEMPTION, 200))
    assert found[0].begin_cycles == 0
    assert found[-1].end_cycles == 200
    joints = itertools.pairwise(found)
    assert all(left.end_cycles == right.begin_cycles for left, right in joints)


def test_the_processors_shares_are_exact() -> None:
    """By hand: task 0 35 cycles, task 1 21, interrupts 1, kernel 12, asleep 131 of 200."""
    shares = utilization(recording(PREEMPTION, 200))
    assert shares.threads == pytest.approx((35 / 200, 21 / 200))
    assert shares.interrupts == pytest.approx(1 / 200)
    assert shares.kernel == pytest.approx(12 / 200)
    assert shares.busy == pytest.approx(69 / 200)


def test_background_threads_do_not_count_as_use_of_the_processor() -> None:
    """A main procedure that loops would otherwise make it 100 %."""
    run = recording(PREEMPTION, 200)
    shares = utilization(run, {run.threads[1].name})
    assert shares.background == shares.threads[1] == pytest.approx(21 / 200)
    assert shares.busy == pytest.approx(48 / 200)


def random_run(seed: int) -> Recording:
    """Any events, also handlers that are left and were never entered."""
    rng = random.Random(seed)
    kinds = [K.THREAD_RUNNING, K.INTERRUPT_ENTERED, K.INTERRUPT_LEFT, K.RELEASE]
    kinds += [K.PROCESSOR_STOPPED, K.PROCESSOR_RESUMED] if seed % 2 else []
    instants = sorted(rng.choices(range(1000), k=200))
    events: list[Event] = [(at, rng.choice(kinds), rng.choice([0, 1, IDLE]), 0) for at in instants]
    return recording(events, 1000)


@pytest.mark.parametrize("seed", range(20))
def test_shares_are_the_sums_of_the_segments(seed: int) -> None:
    run = random_run(seed)
    shares, cycles = utilization(run), Counter[int]()
    for segment in segments(run):
        cycles[segment.owner] += segment.end_cycles - segment.begin_cycles
    named = {0: shares.threads[0], 1: shares.threads[1], IDLE_OWNER: shares.idle}
    named |= {KERNEL_OWNER: shares.kernel, INTERRUPT_OWNER: shares.interrupts}
    assert named == {owner: cycles[owner] / 1000 for owner in named}


@pytest.mark.parametrize("seed", range(20))
def test_stretches_within_a_window_are_the_segments_cut_to_it(seed: int) -> None:
    """From 0 and from inside, to the stop and before it."""
    run = random_run(seed)
    for begin, end in ((0, 1000), (250, 700), (333, 334)):
        cut = [
            (max(s.begin_cycles, begin), min(s.end_cycles, end), s.owner)
            for s in segments(run)
            if s.end_cycles > begin and s.begin_cycles < end
        ]
        joined: list[tuple[int, int, int]] = []
        for first, last, owner in cut:
            before = joined.pop() if joined and joined[-1][2] == owner else (first, first, owner)
            joined.append((before[0], last, owner))
        assert list(stretches(run).within(begin, end)) == joined


def test_without_sleep_events_the_idle_thread_is_idle() -> None:
    """A run-time that spins when idle is measured too."""
    events: list[Event] = [(50, K.THREAD_RUNNING, 0, 0), (75, K.THREAD_RUNNING, IDLE, 0)]
    assert utilization(recording(events, 100)).busy == pytest.approx(0.25)


def test_a_task_without_a_job_has_no_measures() -> None:
    """Nothing is invented for a task that never ran."""
    measures = measure_task(recording([], 100), 0, None)
    assert (measures.releases, measures.response_time_cycles_max) == (0, None)
    assert measures.release_jitter_cycles is None


def test_kinds_of_events_are_those_of_the_catalogue() -> None:
    """Which the tests of crate `trace` compare with the virtual brick's."""
    assert {kind.name.lower(): kind.value for kind in EventKind} == event_numbers()
