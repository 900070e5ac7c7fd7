# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import numpy as np
import pytest
from verification.support.recordings import TC0, TWI, Event, made, preempted

from ravenbrick.project.robot import Robot
from ravenbrick.report.plots.dynamics import dynamics_drawing
from ravenbrick.trace.dynamics import (
    TaskDynamics,
    dynamics_summary,
    handler_dynamics,
    histogram,
    task_dynamics,
)
from ravenbrick.trace.recording import IDLE, EventKind


@pytest.fixture
def tasks(robot: Robot) -> dict[str, TaskDynamics]:
    """The tasks of the made recording."""
    return {task.name: task for task in task_dynamics(robot, preempted())}


def test_tasks_come_by_falling_priority(tasks: dict[str, TaskDynamics]) -> None:
    """The most urgent is shown first."""
    assert list(tasks) == ["urgent", "worker"]


def test_a_preempted_job_is_counted_once_per_loss(tasks: dict[str, TaskDynamics]) -> None:
    """Interrupts are not preemptions, and giving up the processor at the end is none."""
    assert tasks["worker"].preemptions.tolist() == [1]
    assert tasks["urgent"].preemptions.tolist() == [0, 0]


def test_the_time_of_a_job_is_shared_out_without_remainder(tasks: dict[str, TaskDynamics]) -> None:
    """By hand, from 1000 to 6000: own 490 + 405 + 30 + 2960, urgent 910, handlers 195."""
    worker = tasks["worker"]
    assert worker.response_time_cycles.tolist() == [5000]
    assert worker.execution_cycles.tolist() == [3885]
    assert worker.interference_cycles.tolist() == [910]
    assert worker.interrupt_cycles.tolist() == [195]
    assert worker.blocking_cycles.tolist() == [0]


def test_blocking_is_lower_tasks_between_release_and_completion(
    tasks: dict[str, TaskDynamics],
) -> None:
    """Nominal release 2000: the worker runs on for 5 cycles, and 30 in the kernel's switch."""
    urgent = tasks["urgent"]
    assert urgent.blocking_cycles.tolist() == [35, 0]
    assert urgent.release_latency_cycles.tolist() == [130, 1210]
    assert urgent.execution_cycles.tolist() == [870, 790]


def test_handlers_are_told_apart_by_their_source() -> None:
    """Durations and intervals of each source."""
    twi, timer = handler_dynamics(preempted())
    assert (twi.name, twi.duration_cycles.tolist()) == ("TWI", [100])
    assert twi.interval_jitter_cycles is None
    assert (timer.name, timer.duration_cycles.tolist()) == ("TC0", [95, 200])
    assert timer.interval_cycles.tolist() == [97_995]
    assert timer.interval_jitter_cycles == 0


@pytest.mark.parametrize("values", [[5], [0, 39], [0, 40], [7, 7, 7], list(range(1000))])
def test_a_histogram_holds_every_value_once(values: list[int]) -> None:
    """At most 40 bins of equal whole width, from the smallest to the largest value."""
    found = histogram(np.array(values, np.int64))
    assert found.counts.sum() == len(values)
    assert found.counts[0] > 0
    assert found.counts[-1] > 0
    assert len(found.counts) <= 40
    widths = set(np.diff(found.edges_cycles).tolist())
    assert len(widths) == 1
    assert np.array_equal(np.histogram(values, found.edges_cycles)[0], found.counts)


@pytest.mark.parametrize(("last", "bins", "width"), [(39, 40, 1), (40, 21, 2), (119, 40, 3)])
def test_the_bins_of_a_histogram_are_as_narrow_as_40_can_be(
    last: int, bins: int, width: int
) -> None:
    """By hand: 40 values fill 40 bins of one cycle, one more needs two cycles a bin."""
    found = histogram(np.array([0, last], np.int64))
    assert found.edges_cycles.tolist() == list(range(0, width * bins + 1, width))


def test_a_handler_that_another_interrupts_does_not_count_its_time() -> None:
    """By hand: 30 cycles from 10 to 40, of which 5 and 8 are those of the other two."""
    entered, left = EventKind.INTERRUPT_ENTERED, EventKind.INTERRUPT_LEFT
    events = [(10, entered, TWI, 0), (15, entered, TC0, 0), (20, left, 0, 0)]
    events += [(22, entered, TC0, 0), (30, left, 0, 0), (40, left, 0, 0)]
    twi, timer = handler_dynamics(made(events, 100))
    assert twi.duration_cycles.tolist() == [17]
    assert timer.duration_cycles.tolist() == [5, 8] and timer.interval_cycles.tolist() == [7]


def test_the_summary_says_how_often_a_job_is_preempted_at_most(robot: Robot) -> None:
    """By hand: the first job loses the processor twice, the second never."""
    kinds = EventKind
    events: list[Event] = [(0, kinds.RELEASE, 0, 0), (1, kinds.THREAD_RUNNING, 0, 0)]
    for at in (10, 20):
        events += [(at, kinds.RELEASE, 1, at), (at, kinds.THREAD_RUNNING, 1, 0)]
        events += [(at + 5, kinds.COMPLETION, 1, at), (at + 5, kinds.THREAD_RUNNING, 0, 0)]
    events += [(30, kinds.COMPLETION, 0, 0), (30, kinds.THREAD_RUNNING, IDLE, 0)]
    events += [(50, kinds.RELEASE, 0, 50), (50, kinds.THREAD_RUNNING, 0, 0)]
    events += [(60, kinds.COMPLETION, 0, 50), (60, kinds.THREAD_RUNNING, IDLE, 0)]
    task = dynamics_summary(task_dynamics(robot, made(events, 100)), ())["tasks"]["task_0"]
    assert (task["jobs"], task["preemptions"], task["preemptions_per_job_max"]) == (2, 2, 2)


def test_no_values_make_an_empty_histogram() -> None:
    """Nothing is invented."""
    assert histogram(np.zeros(0, np.int64)).counts.size == 0


def test_the_summary_and_the_picture_name_every_task_and_source(robot: Robot) -> None:
    """A row per task and per interrupt source."""
    recording = preempted()
    tasks, handlers = task_dynamics(robot, recording), handler_dynamics(recording)
    summary = dynamics_summary(tasks, handlers)
    assert summary["tasks"]["worker"]["preemptions"] == 1
    assert summary["interrupts"]["TC0"]["duration_cycles"] == {"min": 95, "mean": 147.5, "max": 200}
    picture = dynamics_drawing(recording.clock, tasks, handlers).svg()
    for name in ("urgent", "worker", "interrupt TWI", "interrupt TC0"):
        assert f">{name}<" in picture, name
