# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Small random task sets of whole numbers, the same for each seed."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

from ravenbrick.schedule.model import CriticalSection, Task, TaskSet
from ravenbrick.schedule.quantity import Time
from ravenbrick.schedule.releases import ReleasePattern

__all__ = ["random_releases", "random_task_set", "with_jitter", "with_phases", "with_sections"]

PERIODS = (4, 5, 6, 8, 10, 12, 15, 20, 24, 30, 40, 60)


def random_task_set(seed: int, *, longest: float = 1.0) -> TaskSet:
    """2 to 5 tasks with U <= 1 and deadlines up to `longest` periods, in random order."""
    dice = random.Random(seed)
    while True:
        rows = []
        for _ in range(dice.randint(2, 5)):
            period = dice.choice(PERIODS)
            wcet = dice.randint(1, max(1, period // 2))
            rows.append((wcet, period, dice.randint(wcet, max(wcet, int(period * longest)))))
        task_set = TaskSet.of(*rows)
        if task_set.utilization <= 1:
            return task_set


def with_jitter(task_set: TaskSet, seed: int) -> TaskSet:
    """The set with release jitter up to one and a half periods."""
    dice = random.Random(seed)
    return TaskSet(
        tuple(replace(t, release_jitter=dice.randint(0, t.period * 3 // 2)) for t in task_set)
    )


def with_phases(task_set: TaskSet, seed: int) -> TaskSet:
    """The set with known phases."""
    dice = random.Random(seed)
    return TaskSet(tuple(replace(t, phase=dice.randint(0, int(t.period) - 1)) for t in task_set))


def with_sections(task_set: TaskSet, seed: int) -> TaskSet:
    """The set with one or two sections on three objects in most tasks."""
    dice = random.Random(seed)
    tasks = []
    for task in task_set:
        sections = []
        position = 0
        while position < task.wcet and dice.random() < 0.8:
            start = dice.randint(position, int(task.wcet) - 1)
            length = dice.randint(1, int(task.wcet) - start)
            sections.append(CriticalSection(dice.choice("PQR"), length, start))
            position = start + length
        tasks.append(replace(task, sections=tuple(sections)))
    return TaskSet(tuple(tasks))


def random_releases(seed: int) -> ReleasePattern:
    """Random jitter and random extra separation of sporadic tasks, the same for each seed.

    Cyclic tasks of unknown phase start anywhere in their period. Delays are eighths of the jitter
    or the period, rounded down.
    """

    def pattern(task: Task) -> Iterator[tuple[Time, Time]]:
        dice = random.Random(f"{seed} {task.name}")
        arrival = task.phase if task.phase is not None else _part(task.period, dice)
        release = arrival
        while True:
            release = max(release, arrival + _part(task.release_jitter, dice))
            yield arrival, release
            arrival += task.period
            if task.release != "cyclic" and dice.random() < 0.5:
                arrival += _part(task.period, dice)

    return pattern


def _part(time: Time, dice: random.Random) -> Time:
    return time * dice.randint(0, 8) // 8
