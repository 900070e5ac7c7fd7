# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Patterns of arrivals and releases for the simulation.

A pattern maps a task to its endless jobs (arrival, release), both never falling.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ravenbrick.schedule.model import Task
from ravenbrick.schedule.multiframe import frames_from
from ravenbrick.schedule.quantity import Time

__all__ = ["ReleasePattern", "critical_instant", "periodic"]

ReleasePattern = Callable[[Task], Iterator[tuple[Time, Time]]]


def periodic(task: Task) -> Iterator[tuple[Time, Time]]:
    """From the phase (0 when unknown) on, one job each period, without jitter."""
    for distance, _ in frames_from(task, 0):
        arrival = (task.phase or 0) + distance
        yield arrival, arrival


def critical_instant(task: Task) -> Iterator[tuple[Time, Time]]:
    """All tasks release at 0 a job that is late by their jitter, later jobs as early as they can.

    The worst pattern of independent tasks under fixed priorities (Liu, Layland 1973; Audsley,
    Burns, Richardson, Tindell, Wellings 1993). Phases are not used.
    """
    for distance, _ in frames_from(task, 0):
        arrival = distance - task.release_jitter
        yield arrival, max(0, arrival)
