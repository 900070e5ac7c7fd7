# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a run shows beside what was bounded before it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.robot import Robot
from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.facts import Facts
from ravenbrick.trace.dynamics import TaskDynamics, task_dynamics
from ravenbrick.trace.interrupts import source_name
from ravenbrick.trace.plots import cyclic_begin_cycles
from ravenbrick.trace.recording import EventKind, Recording
from ravenbrick.trace.schedule import jobs_of

__all__ = [
    "Observed",
    "check_interrupt_rates",
    "never_exceeded",
    "observe",
    "ratio",
    "worst_job_release",
]


@dataclass(frozen=True)
class Observed:
    """Largest values over the jobs of a task that are released after the start of all tasks."""

    jobs: int
    response_cycles: int
    execution_cycles: int
    interference_cycles: int
    blocking_cycles: int
    interrupt_cycles: int
    release_jitter_cycles: int
    deadline_misses: int
    stack_bytes: int


def _largest(found: TaskDynamics, column: str, chosen: NDArray[np.bool_]) -> int:
    return int(getattr(found, column)[chosen].max())


def _operating(recording: Recording, task: str, since_cycles: int) -> NDArray[np.bool_]:
    """Which completed jobs are released from an instant on, the first job left out."""
    names = [thread.name.lower() for thread in recording.threads]
    jobs = jobs_of(recording, names.index(task.lower()))
    done = [job for job in jobs if job.completion_cycles is not None]
    releases = np.array([job.release_cycles for job in done], np.int64)
    return (releases >= since_cycles) & (np.arange(releases.size) > 0)


def observe(robot: Robot, recording: Recording) -> dict[str, Observed]:
    """By the task's name in robot.toml; tasks without a completed job are left out."""
    threads = {thread.name.lower(): thread for thread in recording.threads}
    result: dict[str, Observed] = {}
    since = cyclic_begin_cycles(robot, recording)
    for found in task_dynamics(robot, recording):
        task = robot.task(found.name)
        if task is None:
            continue
        chosen = _operating(recording, found.name, since)
        if not chosen.any():
            continue
        latency = found.release_latency_cycles[chosen]
        result[task.name] = Observed(
            jobs=int(np.count_nonzero(chosen)),
            response_cycles=_largest(found, "response_time_cycles", chosen),
            execution_cycles=_largest(found, "execution_cycles", chosen),
            interference_cycles=_largest(found, "interference_cycles", chosen),
            blocking_cycles=_largest(found, "blocking_cycles", chosen),
            interrupt_cycles=_largest(found, "interrupt_cycles", chosen),
            release_jitter_cycles=int(np.ptp(latency)),
            deadline_misses=found.deadline_misses,
            stack_bytes=threads[found.name.lower()].stack_used_bytes,
        )
    return result


def worst_job_release(robot: Robot, recording: Recording, task: str) -> int | None:
    """Nominal release of the job with the longest response time after the start of all tasks."""
    names = [thread.name.lower() for thread in recording.threads]
    since = cyclic_begin_cycles(robot, recording)
    jobs = jobs_of(recording, names.index(task.lower()))[1:]
    done = [
        job for job in jobs if job.response_time_cycles is not None and job.release_cycles >= since
    ]
    worst = max(done, key=lambda job: job.response_time_cycles or 0, default=None)
    return None if worst is None else worst.release_cycles


def check_interrupt_rates(robot: Robot, facts: Facts, recording: Recording) -> None:
    """Raise `ExecutionTimeError` when a source came more often than the facts say.

    What comes before the start of all tasks is not looked at.
    """
    since = cyclic_begin_cycles(robot, recording)
    entered = recording.of_kind(EventKind.INTERRUPT_ENTERED)
    for load in facts.interrupts:
        at = entered["at_cycles"][entered["subject"] == load.source].astype(np.int64)
        at = at[at >= since]
        window = MASTER_CLOCK.cycles_of_us(load.window_us)
        if at.size <= load.at_most:
            continue
        spans = at[load.at_most :] - at[: -load.at_most]
        if spans.size and spans.min() < window:
            begin = float(MASTER_CLOCK.seconds(int(at[int(spans.argmin())])))
            raise ExecutionTimeError(
                f"{facts.name}: {source_name(load.source)} interrupts more than {load.at_most} "
                f"times in {load.window_us} us, {begin:.6f} s after the begin of the run "
                f"'{recording.scenario}'; correct the fact or slow the source down"
            )


def ratio(bound: int, observed: int) -> float | None:
    """Bound over observed maximum."""
    return bound / observed if observed else None


def never_exceeded(analysis: Analysis, observed: dict[str, Observed]) -> bool:
    """Whether no response time and no stack lies above its bound."""
    for timing in analysis.tasks:
        found = observed.get(timing.task.name)
        if found is None:
            continue
        bound = analysis.bounds[timing.task.name].bound
        deepest = timing.stack_bound_bytes
        if bound is not None and found.response_cycles > bound:
            return False
        if deepest is not None and found.stack_bytes > deepest:
            return False
    return True
