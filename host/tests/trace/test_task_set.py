# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The task set of robot.toml beside made runs of one cycle per microsecond."""

from __future__ import annotations

from dataclasses import replace

import pytest
from verification.support.recordings import Event, made

from ravenbrick.errors import ProjectFileError
from ravenbrick.project.robot import Robot
from ravenbrick.trace.recording import IDLE, EventKind, Recording, Thread
from ravenbrick.trace.task_set import check_release, check_shortest_interval, check_task_set

K = EventKind
PERIOD_US = 4_000


def released(releases: list[int], end: int = 0, thread: int = 0) -> list[Event]:
    """Jobs of a thread at these instants, of 20 us each."""
    events: list[Event] = []
    for at in releases:
        events += [(at, K.RELEASE, thread, at), (at + 5, K.THREAD_RUNNING, thread, 0)]
        events += [(at + 20, K.COMPLETION, thread, at), (at + 20, K.THREAD_RUNNING, IDLE, 0)]
    return events


def run(releases: list[int], end: int = 0) -> Recording:
    """A run of the vehicle's control task alone, whose period is 4 ms."""
    thread = Thread("control_task", 2, 4096, 100)
    return made(released(releases), end or releases[-1] + PERIOD_US, [thread])


@pytest.mark.parametrize(("off_us", "accepted"), [(0, True), (1, True), (2, False)])
def test_a_period_may_differ_by_a_microsecond(robot: Robot, off_us: int, accepted: bool) -> None:
    """As much as the clock's resolution takes from a period that it cannot represent."""
    found = run([number * (PERIOD_US + off_us) for number in range(1, 6)])
    if accepted:
        check_release(robot, found, "control_task")
    else:
        with pytest.raises(ProjectFileError, match=r"period_us: is 4000, but .* has 4002"):
            check_release(robot, found, "control_task")


def test_the_last_quarter_of_a_run_says_the_period(robot: Robot) -> None:
    """Tasks may set up for three quarters; with fewer than three releases there the whole run."""
    slow = [10_000 * number for number in range(1, 10)]
    quick = [90_000 + PERIOD_US * number for number in range(1, 4)]
    check_release(robot, run(slow + quick, end=125_000), "control_task")
    for releases, end in ((slow + quick, 126_000), (slow + quick[:2], 124_000)):
        with pytest.raises(ProjectFileError, match="has 10000"):
            check_release(robot, run(releases, end), "control_task")


def test_fewer_than_three_periodic_releases_show_no_period(robot: Robot) -> None:
    """The first release is none of the period's: the task begins there."""
    check_release(robot, run([1, 9_000, 19_000]), "control_task")
    with pytest.raises(ProjectFileError, match="has 10000"):
        check_release(robot, run([1, 9_000, 19_000, 29_000]), "control_task")


def test_no_release_comes_sooner_than_the_period(robot: Robot) -> None:
    """Where the task keeps its period once; the instant of the early release is named."""
    regular = [PERIOD_US * number for number in range(1, 8)]
    early = [*regular, regular[-1] + PERIOD_US - 2, regular[-1] + 3 * PERIOD_US]
    sentence = r"released 3998\.0 us after its release before, at 0\.031998 s"
    with pytest.raises(ProjectFileError, match=sentence):
        check_shortest_interval(robot, run(early), "control_task")
    check_shortest_interval(
        robot, run([3_000, 6_000, *(6_000 + at for at in regular)]), "control_task"
    )
    second = [4_000, 8_000, 12_000, 13_000, 17_000, 21_000]
    with pytest.raises(ProjectFileError, match=r"released 1000\.0 us after its release before"):
        check_shortest_interval(robot, run(second), "control_task")
    check_shortest_interval(robot, run([10, 20, 30]), "control_task")
    with pytest.raises(ProjectFileError, match=r"released 10\.0 us .* at 0\.000030 s"):
        check_shortest_interval(robot, run([10, 20, 30, 40]), "control_task")


def test_a_wait_inside_a_job_is_no_release_of_its_own(robot: Robot) -> None:
    """One wait of 1 ms a job: of two intervals together the period counts, less the wait."""
    starts = [PERIOD_US * number for number in range(1, 8)]
    waiting = [at + offset for at in starts for offset in (0, 1_000)]
    with pytest.raises(ProjectFileError, match="control_task is released"):
        check_shortest_interval(robot, run(waiting), "control_task")
    check_shortest_interval(robot, run(waiting), "control_task", waits=1, waits_us=1_000.0)
    early = [at - 2_000 if at > 22_000 else at for at in waiting]
    with pytest.raises(ProjectFileError, match=r"released 2000\.0 us after"):
        check_shortest_interval(robot, run(early), "control_task", waits=1, waits_us=1_000.0)


def test_a_task_set_that_differs_is_refused_by_its_field(robot: Robot) -> None:
    """Name, priority, stack and, of whole runs, the period."""
    tasks = [t for t in robot.tasks if t.period_us is not None]
    threads = [Thread(t.name.upper(), t.priority, t.stack_bytes, 100) for t in tasks]
    events = [
        event
        for place, task in enumerate(tasks)
        for event in released([(task.period_us or 0) * n for n in range(1, 6)], thread=place)
    ]
    found = made(sorted(events), 3_000_000, threads)
    check_task_set(robot, found)
    for field, thread in {
        "name: the image has no task 'coprocessor_task'": replace(threads[0], name="other"),
        "priority: is 30, but .* has 29": replace(threads[0], base_priority=29),
        "stack_bytes: is 1024, but .* has 1032": replace(threads[0], stack_bytes=1032),
    }.items():
        with pytest.raises(ProjectFileError, match=field):
            check_task_set(robot, replace(found, threads=(thread, *threads[1:])))
    slow = replace(found, events=found.events.copy())
    slow.events["at_cycles"] *= 2
    slow.events["value"] *= 2
    with pytest.raises(ProjectFileError, match=r"period_us: is 2000, but .* has 4000"):
        check_task_set(robot, slow)
    check_task_set(robot, slow, whole=False)
    names = [task.name for task in tasks]
    check_task_set(robot, slow, outside=names)
    with pytest.raises(ProjectFileError, match=r"period_us: is 2000, but .* has 4000"):
        check_task_set(robot, slow, outside=names[1:])
