# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Is the task set of robot.toml the one that ran?"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from ravenbrick.errors import ProjectFileError
from ravenbrick.project.robot import Robot, Task
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import releases_of

__all__ = ["check_names", "check_release", "check_shortest_interval", "check_task_set"]

PERIOD_TOLERANCE_US = 1.0
# A first wait, and some releases of which one is too early.
LEAST_INTERVALS = 3


def _observed_period_us(recording: Recording, thread: int) -> float | None:
    """In the run's last quarter if it has enough releases: a task may begin by setting up."""
    releases = releases_of(recording, thread)[1:]
    late = releases[4 * releases >= 3 * recording.stop.at_cycles]
    if late.size >= 3:
        releases = late
    if releases.size < 3:
        return None
    return 1e6 * float(np.median(np.diff(releases))) / float(recording.clock.hertz)


def _differences(recording: Recording, thread: int, task: Task) -> list[tuple[str, object, object]]:
    found = recording.threads[thread]
    differences: list[tuple[str, object, object]] = []
    if found.base_priority != task.priority:
        differences.append(("priority", task.priority, found.base_priority))
    if found.stack_bytes != task.stack_bytes:
        differences.append(("stack_bytes", task.stack_bytes, found.stack_bytes))
    return differences


def check_release(robot: Robot, recording: Recording, name: str) -> None:
    """Raise `ProjectFileError` where a cyclic task does not keep its period."""
    index = [task.name.lower() for task in robot.tasks].index(name.lower())
    task = robot.tasks[index]
    if task.release != "cyclic" or task.period_us is None:
        return
    thread = recording.thread_index(name)
    period = _observed_period_us(recording, thread)
    if period is not None and abs(period - task.period_us) > PERIOD_TOLERANCE_US:
        raise _differs(robot, index, "period_us", task.period_us, round(period, 3))
    check_shortest_interval(robot, recording, task.name)


def _differs(
    robot: Robot, index: int, field: str, declared: object, observed: object
) -> ProjectFileError:
    return robot.document.error(
        ("tasks", index, field),
        f"is {declared}, but the image that ran has {observed}; correct robot.toml or the program",
    )


def check_shortest_interval(
    robot: Robot, recording: Recording, name: str, waits: int = 0, waits_us: float = 0.0
) -> None:
    """Raise `ProjectFileError` where a task is released sooner than its period allows.

    The analysis takes the period as the shortest time between two releases. A job that waits
    `waits` times inside, for `waits_us` in all, shows as so many more of them. A task may begin by
    setting up, with other waits: it is judged from where it keeps its period first. A wait for an
    instant before the last release does not wait, so it is none.
    """
    index = [task.name for task in robot.tasks].index(name)
    thread = recording.thread_index(name)
    period_us = robot.tasks[index].period_us
    releases = releases_of(recording, thread)
    releases = releases[releases == np.maximum.accumulate(releases)]
    apart = 1 + waits
    intervals_us = 1e6 * (releases[apart:] - releases[:-apart]) / float(recording.clock.hertz)
    if period_us is None or intervals_us.size < LEAST_INTERVALS:
        return
    least_us = period_us - waits_us - PERIOD_TOLERANCE_US
    kept = np.flatnonzero(intervals_us[1:] >= least_us)
    first = 1 + (int(kept[0]) if kept.size else 0)
    place = first + int(intervals_us[first:].argmin())
    if intervals_us[place] < least_us:
        when = float(recording.clock.seconds(int(releases[place + apart])))
        raise robot.document.error(
            ("tasks", index, "period_us"),
            f"is {period_us}, but in the run '{recording.scenario}' {name} is released "
            f"{intervals_us[place]:.1f} us after its release before, at {when:.6f} s; correct "
            "robot.toml or the program",
        )


def check_names(robot: Robot, names: Sequence[str]) -> None:
    """Raise `ProjectFileError` for a task that is none of the image's, in small letters."""
    for index, task in enumerate(robot.tasks):
        if task.name.lower() not in names:
            raise robot.document.error(
                ("tasks", index, "name"),
                f"the image has no task '{task.name}'; it has: {', '.join(names) or 'none'}",
            )


def check_task_set(
    robot: Robot, recording: Recording, *, whole: bool = True, outside: Collection[str] = ()
) -> None:
    """Raise `ProjectFileError` for the first task that differs from the image that ran.

    A run that is not `whole` was stopped, perhaps while tasks set up: it tells nothing of periods.
    Nor does it of the tasks in `outside`, which are released anew after code outside of jobs.
    """
    names = [thread.name.lower() for thread in recording.threads]
    check_names(robot, names)
    for index, task in enumerate(robot.tasks):
        thread = names.index(task.name.lower())
        for field, declared, observed in _differences(recording, thread, task):
            raise _differs(robot, index, field, declared, observed)
        if whole and task.name not in outside:
            check_release(robot, recording, task.name)
