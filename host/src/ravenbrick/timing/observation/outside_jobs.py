# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What jobs without a deadline cost, of tasks with `[[outside]]` code."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import Task
from ravenbrick.timing.facts.facts import Facts
from ravenbrick.timing.observation.job_facts import (
    TOLERANCE_CYCLES,
    FactCount,
    have_deadline,
)

__all__ = ["outside_count"]

Cycles = NDArray[np.int64]


def _at(cycles: int) -> str:
    return f"at {float(MASTER_CLOCK.seconds(cycles)):.6f} s"


def outside_count(
    facts: Facts, task: Task, bound_cycles: int, release: Cycles, own: Cycles, since: int
) -> list[FactCount]:
    """Longest execution of a job without a deadline beside its bound, and shortest time to the next
    release, of a task that has such jobs; `own` are the net execution times of its completed jobs.
    The last one is left out if it comes a period after one: its next release would tell which it
    is."""
    chosen = ~have_deadline(task, release, {task.name}) & (release >= since)
    if release.size > 1 and have_deadline(task, release[-2:], {task.name})[0]:
        chosen[-1] = False
    counts = []
    for load in facts.outside_of(task.name):
        text = f'{load.file}: [[outside]] task = "{task.name}"'
        longest, excess = int(own[chosen].max(initial=0)), ""
        if longest > bound_cycles:
            where = _at(int(release[chosen][own[chosen].argmax()]))
            excess = f"at most {bound_cycles} cycles, seen {longest} in the job {where}"
        counts.append(FactCount(text, "cycles", bound_cycles, longest, excess))
        period = MASTER_CLOCK.cycles_of_us(load.period_us)
        gaps, excess = np.diff(release)[chosen[:-1]], ""
        least = int(gaps.min()) if gaps.size else period
        least_us = round(1e6 * float(MASTER_CLOCK.seconds(least)))
        if least < period - TOLERANCE_CYCLES:
            where = _at(int(release[:-1][chosen[:-1]][gaps.argmin()]))
            excess = f"declared {load.period_us} us, released again {least_us} us after {where}"
        counts.append(FactCount(text, "period_us", load.period_us, least_us, excess))
    return counts
