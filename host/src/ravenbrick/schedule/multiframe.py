# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Tasks whose jobs take different frames in turn (Mok, Chen 1997), each with its own separation
and deadline (Baruah, Chen, Gorinsky, Mok 1999)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

from ravenbrick.schedule.model import Frame, Task, TaskSetError
from ravenbrick.schedule.quantity import Time, exact

__all__ = [
    "frames_from",
    "least_span",
    "most_execution",
    "most_work",
    "multiframe_utilization_bound",
    "release_times",
]


def frames_from(task: Task, first: int) -> Iterator[tuple[Time, Frame]]:
    """Frames from frame `first` on, each with its least distance from the first arrival."""
    arrival: Time = 0
    number = first
    while True:
        frame = task.frame(number)
        yield arrival, frame
        arrival += frame.separation
        number += 1


def _work_from(task: Task, first: int, length: Time) -> tuple[int, Time]:
    """Jobs and execution that arrive in a half-open window of this length from frame `first` on."""
    cycles = math.ceil(Fraction(length) / Fraction(task.cycle)) - 1
    jobs = cycles * len(task.frames)
    execution: Time = cycles * sum(frame.wcet for frame in task.frames)
    for arrival, frame in frames_from(task, first):
        if cycles * task.cycle + arrival >= length:
            return jobs, execution
        jobs, execution = jobs + 1, execution + frame.wcet
    raise AssertionError("frames never end")


def most_work(task: Task, length: Time, overhead: Time = 0) -> tuple[int, Time]:
    """Jobs and their execution in the half-open window of this length with the most work, where
    each job costs `overhead` besides.

    The request bound function of the generalised multiframe model: the longest over all first
    frames, each following job as soon as it may be (Takada, Sakamura 1997).
    """
    if length <= 0:
        return 0, 0
    found = (_work_from(task, first, length) for first in range(len(task.frames)))
    return max(found, key=lambda work: (work[1] + work[0] * overhead, work))


def release_times(task: Task, limit: Time) -> Iterator[Time]:
    """Lengths up to `limit` just after which a window can hold another job, from the longest."""
    starts: set[Time] = set()
    for first in range(len(task.frames)):
        for arrival, _ in frames_from(task, first):
            if arrival > limit:
                break
            starts.add(arrival)
    return iter(sorted(starts, reverse=True))


def multiframe_utilization_bound(ratio: float, count: int) -> float:
    """Utilisation up to which `count` multiframe tasks are rate monotonic schedulable.

    r n ((1 + 1/r)^(1/n) - 1), where r is the least ratio of a task's longest frame to the one
    after it (Mok, Chen 1997, theorem 5); the utilisation is that of the longest frames, the jobs
    of a task are equally far apart, and no sequence from another frame on is longer than the one
    from the longest on. r = 1 gives the bound of Liu and Layland. Raises `TaskSetError`.
    """
    if count < 1 or ratio < 1:
        raise TaskSetError(f"a bound for {count} tasks and a ratio of {ratio} does not exist")
    return float(ratio * count * math.expm1(math.log1p(1 / ratio) / count))


def _rows(task: Task, length: int) -> Iterator[list[Frame]]:
    """The frames of this many jobs in a row, from each first frame."""
    for first in range(len(task.frames)):
        yield [task.frame(first + k) for k in range(length)]


def least_span(task: Task, jobs: int) -> Time:
    """Least time from an arrival to the one `jobs` later."""
    if not task.frames:
        return jobs * task.period
    whole, rest = divmod(jobs, len(task.frames))
    shortest = min(sum(frame.separation for frame in row) for row in _rows(task, rest))
    return exact(whole * task.cycle + shortest)


def most_execution(task: Task, jobs: int) -> Time:
    """Most execution of this many jobs in a row."""
    if not task.frames:
        return jobs * task.wcet
    whole, rest = divmod(jobs, len(task.frames))
    longest = max(sum(frame.wcet for frame in row) for row in _rows(task, rest))
    return exact(whole * sum(frame.wcet for frame in task.frames) + longest)
