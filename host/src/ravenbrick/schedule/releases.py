# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Patterns of arrivals and releases for the simulation.

A pattern maps a task to its endless jobs (arrival, release), both never falling.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Iterator

from ravenbrick.schedule.model import Task
from ravenbrick.schedule.quantity import Time

__all__ = ["ReleasePattern", "critical_instant", "periodic", "random_releases"]

ReleasePattern = Callable[[Task], Iterator[tuple[Time, Time]]]


def periodic(task: Task) -> Iterator[tuple[Time, Time]]:
    """From the phase (0 when unknown) on, one job each period, without jitter."""
    for number in itertools.count():
        arrival = (task.phase or 0) + number * task.period
        yield arrival, arrival


def critical_instant(task: Task) -> Iterator[tuple[Time, Time]]:
    """All tasks release at 0 a job that is late by their jitter, later jobs as early as they can.

    The worst pattern of independent tasks under fixed priorities (Liu, Layland 1973; Audsley,
    Burns, Richardson, Tindell, Wellings 1993). Phases are not used.
    """
    for number in itertools.count():
        arrival = number * task.period - task.release_jitter
        yield arrival, max(0, arrival)


def random_releases(seed: int, grain: int = 8) -> ReleasePattern:
    """Random jitter and random extra separation of sporadic tasks, the same for each seed.

    Cyclic tasks of unknown phase start anywhere in their period. Delays are multiples of the
    jitter or the period divided by `grain`.
    """

    def pattern(task: Task) -> Iterator[tuple[Time, Time]]:
        dice = random.Random(f"{seed} {task.name}")
        arrival = task.phase if task.phase is not None else _part(task.period, dice, grain)
        release = arrival
        while True:
            release = max(release, arrival + _part(task.release_jitter, dice, grain))
            yield arrival, release
            arrival += task.period
            if task.release != "cyclic" and dice.random() < 0.5:
                arrival += _part(task.period, dice, grain)

    return pattern


def _part(time: Time, dice: random.Random, grain: int) -> Time:
    """0, 1, ... or `grain` parts of the time, rounded down when it is whole."""
    if isinstance(time, int):
        return time * dice.randint(0, grain) // grain
    return time * dice.randint(0, grain) / grain
