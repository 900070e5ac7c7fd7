# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a run shows beside what was bounded before it."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import Robot
from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.facts.facts import Facts
from ravenbrick.timing.initial_state import ALARM_SOURCE
from ravenbrick.timing.observation.job_facts import FactCount, have_deadline
from ravenbrick.timing.observation.net_execution_time import interruption_cycles, stolen_cycles
from ravenbrick.timing.observation.outside_jobs import outside_count
from ravenbrick.timing.task_set.background import never_waits
from ravenbrick.trace.dynamics import TaskDynamics, task_dynamics
from ravenbrick.trace.recording import ENVIRONMENT, EventKind, Recording
from ravenbrick.trace.schedule import Job, all_jobs, cyclic_begin_cycles, jobs_of

__all__ = [
    "LongestJob",
    "Observed",
    "check_bounds",
    "check_event_rates",
    "check_job_kinds",
    "exceeded",
    "longest_jobs",
    "observe",
    "outside_counts",
    "ratio",
    "refuse_exceeded",
    "used_stacks",
    "worst_job",
]

# An early call of the alarm comes at most this long before the one that releases.
EARLY_AT_MOST_US = 80
STRETCH = 10


@dataclass(frozen=True)
class Observed:
    """Largest values over the jobs of a task that are released after the start of all tasks.

    `without_transfers`: the cycles that the data controller took are no part of the execution.
    """

    jobs: int
    response_cycles: int
    execution_cycles: int
    interference_cycles: int
    blocking_cycles: int
    interrupt_cycles: int
    release_jitter_cycles: int
    deadline_misses: int
    stack_bytes: int
    without_transfers: bool = False


def _largest(found: TaskDynamics, column: str, chosen: NDArray[np.bool_]) -> int:
    return int(getattr(found, column)[chosen].max())


def _begin_cycles(robot: Robot, recording: Recording, task: str) -> int:
    """The start of all tasks; what the environment task waits for before is elaboration."""
    since = cyclic_begin_cycles(robot, recording)
    if task.lower() != ENVIRONMENT:
        return since
    return max(since, *(jobs[0].release_cycles for jobs in all_jobs(recording) if jobs))


def _operating(
    robot: Robot, recording: Recording, name: str, since_cycles: int, outside: Collection[str]
) -> NDArray[np.bool_]:
    """Which completed jobs are released from an instant on, the first job left out, and those
    without a deadline of tasks in `outside`."""
    jobs = jobs_of(recording, recording.thread_index(name))
    done = [job for job in jobs if job.completion_cycles is not None]
    releases = np.array([job.release_cycles for job in done], np.int64)
    chosen = have_deadline(robot.task(name), releases, outside)
    return (releases >= since_cycles) & (np.arange(releases.size) > 0) & chosen


def _completed(recording: Recording, task: str) -> tuple[int, NDArray[np.int64], NDArray[np.int64]]:
    """Thread of a task, releases and completions of its completed jobs."""
    thread = recording.thread_index(task)
    done = [
        (job.release_cycles, job.completion_cycles)
        for job in jobs_of(recording, thread)
        if job.start_cycles is not None and job.completion_cycles is not None
    ]
    release, end = np.array(done, np.int64).reshape(-1, 2).T
    return thread, release, end


def _net_execution_times(
    recording: Recording, found: TaskDynamics, transfer_cycles: int
) -> NDArray[np.int64]:
    """Net execution time of each completed job, without what interrupts add to it and what the
    data controller takes, `transfer_cycles` each, where the run recorded it."""
    thread, release, end = _completed(recording, found.name)
    own = found.execution_cycles - interruption_cycles(recording, thread, release, end)
    own -= stolen_cycles(recording, thread, release, end, transfer_cycles)
    return np.asarray(own, np.int64)


def observe(
    robot: Robot,
    recording: Recording,
    transfer_cycles: int = 1,
    outside: Collection[str] = (),
) -> dict[str, Observed]:
    """By the task's name in robot.toml; tasks without a completed job are left out. A transfer of
    the data controller takes `transfer_cycles` (`STOLEN_CYCLES`); `outside` are tasks with jobs
    without a deadline, which are left out."""
    threads = {thread.name.lower(): thread for thread in recording.threads}
    result: dict[str, Observed] = {}
    for found in task_dynamics(robot, recording):
        task = robot.task(found.name)
        if task is None:
            continue
        since = _begin_cycles(robot, recording, found.name)
        chosen = _operating(robot, recording, found.name, since, outside)
        if not chosen.any():
            continue
        latency = found.release_latency_cycles[chosen]
        own = _net_execution_times(recording, found, transfer_cycles)
        result[task.name] = Observed(
            jobs=int(np.count_nonzero(chosen)),
            response_cycles=_largest(found, "response_time_cycles", chosen),
            execution_cycles=int(own[chosen].max()),
            interference_cycles=_largest(found, "interference_cycles", chosen),
            blocking_cycles=_largest(found, "blocking_cycles", chosen),
            interrupt_cycles=_largest(found, "interrupt_cycles", chosen),
            release_jitter_cycles=int(np.ptp(latency)),
            deadline_misses=found.deadline_misses,
            stack_bytes=threads[found.name.lower()].stack_used_bytes,
            without_transfers=recording.transfers is not None,
        )
    return result


@dataclass(frozen=True)
class LongestJob:
    """A job by its net execution time; cycles. It has the processor first at `begin_cycles`."""

    thread: int
    begin_cycles: int
    end_cycles: int
    cycles: int


def longest_jobs(
    robot: Robot,
    recording: Recording,
    transfer_cycles: int = 1,
    outside: Collection[str] = (),
) -> dict[str, LongestJob]:
    """The job of each task whose `execution_cycles` are `observe`'s, by the task's name."""
    result = {}
    for found in task_dynamics(robot, recording):
        task, thread = robot.task(found.name), recording.thread_index(found.name)
        since = _begin_cycles(robot, recording, found.name)
        chosen = np.flatnonzero(_operating(robot, recording, found.name, since, outside))
        if task is None or not chosen.size:
            continue
        own = _net_execution_times(recording, found, transfer_cycles)
        longest = int(chosen[np.argmax(own[chosen])])
        done = [job for job in jobs_of(recording, thread) if job.completion_cycles is not None]
        begin, end = done[longest].start_cycles, done[longest].completion_cycles
        if begin is not None and end is not None:
            result[task.name] = LongestJob(thread, begin, end, int(own[longest]))
    return result


def worst_job(
    robot: Robot, recording: Recording, task: str, outside: Collection[str] = ()
) -> Job | None:
    """The job with the longest response time after the start of all tasks."""
    since = _begin_cycles(robot, recording, task)
    jobs = jobs_of(recording, recording.thread_index(task))
    releases = np.array([job.release_cycles for job in jobs], np.int64)
    chosen = have_deadline(robot.task(task), releases, outside) & (releases >= since)
    done = [
        job
        for job, counts in list(zip(jobs, chosen, strict=True))[1:]
        if counts and job.response_time_cycles is not None
    ]
    return max(done, key=lambda job: job.response_time_cycles or 0, default=None)


def _expiries(robot: Robot, recording: Recording) -> NDArray[np.int64]:
    """Calls of the alarm, after the start of all tasks, that release no cyclic task and are not
    early: no other call follows soon."""
    cyclic = {task.name.lower() for task in robot.tasks if task.release == "cyclic"}
    names = [thread.name.lower() for thread in recording.threads]
    clocked = [index for index, name in enumerate(names) if name in cyclic]
    events = recording.events
    at = events["at_cycles"].astype(np.int64)
    is_call = events["kind"] == int(EventKind.INTERRUPT_ENTERED)
    calls = at[is_call & (events["subject"] == ALARM_SOURCE)]
    is_release = events["kind"] == int(EventKind.RELEASE)
    releases = at[is_release & np.isin(events["subject"], clocked)]
    ends = np.append(calls[1:], np.iinfo(np.int64).max)
    released = np.searchsorted(releases, ends) - np.searchsorted(releases, calls)
    early = ends - calls < MASTER_CLOCK.cycles_of_us(EARLY_AT_MOST_US)
    since = cyclic_begin_cycles(robot, recording)
    return np.asarray(calls[(released == 0) & ~early & (calls >= since)], np.int64)


def check_event_rates(robot: Robot, facts: Facts, recording: Recording) -> None:
    """Raise `ExecutionTimeError` when timing events expired more often than the facts say.

    Calls of the alarm do not tell which event expired, and come late by what delays them, so the
    sum over all handlers is looked at, in stretches of many windows.
    """
    if not facts.events:
        return
    at = _expiries(robot, recording)
    handlers = sorted({load.handler.lower() for load in facts.events})
    for load in facts.events:
        window_us = STRETCH * load.window_us
        allowed = sum(
            min(
                one.at_most * math.ceil(window_us / one.window_us)
                for one in facts.event_loads(handler)
            )
            for handler in handlers
        )
        spans = at[allowed:] - at[:-allowed]
        if spans.size and spans.min() < MASTER_CLOCK.cycles_of_us(window_us - load.window_us):
            begin = float(MASTER_CLOCK.seconds(int(at[int(spans.argmin())])))
            raise ExecutionTimeError(
                f"{facts.name}: timing events expire more than {allowed} times in {window_us} us, "
                f"{begin:.6f} s after the start of the run '{recording.scenario}'; correct the "
                "rates in [[timing_event]]"
            )


def check_job_kinds(
    robot: Robot, analysis: Analysis, recording: Recording, transfer_cycles: int = 1
) -> None:
    """Raise `ExecutionTimeError` for a job that is of no kind that the facts state: it takes more
    than the bound of each, or more interrupts come until the next release."""
    names = {kind.task for kind, _, _ in analysis.kinds}
    since = cyclic_begin_cycles(robot, recording)
    for found in task_dynamics(robot, recording):
        task = robot.task(found.name)
        if task is None or task.name not in names:
            continue
        kinds = [(kind, most) for kind, most, _ in analysis.kinds if kind.task == task.name]
        chosen = _operating(robot, recording, found.name, since, analysis.outside)
        own = _net_execution_times(recording, found, transfer_cycles)[chosen]
        release = _completed(recording, found.name)[1][chosen]
        following = release + MASTER_CLOCK.cycles_of_us(task.period_us or 0)
        fits = np.zeros(own.size, np.bool_)
        for kind, cycles in kinds:
            of_kind = own <= cycles
            for source, at_most in kind.most:
                at = _entries(recording, source)
                count = np.searchsorted(at, following) - np.searchsorted(at, release)
                of_kind &= count <= at_most
            fits |= of_kind
        if not fits.all():
            when = float(MASTER_CLOCK.seconds(int(release[~fits][0])))
            words = ", ".join(f"'{kind.name}'" for kind, _ in kinds)
            raise ExecutionTimeError(
                f"{kinds[0][0].file}: [[job_kind]]: the job of {task.name} released at {when:.6f} "
                f"s of the run '{recording.scenario}' is of none of the kinds {words}; add a kind"
            )


def outside_counts(
    robot: Robot,
    facts: Facts,
    analysis: Analysis,
    recording: Recording,
    transfer_cycles: int = 1,
) -> list[FactCount]:
    """What jobs without a deadline took, beside what is said of them."""
    since, counts = cyclic_begin_cycles(robot, recording), list[FactCount]()
    bounds = {timing.task.name: timing.job.outside_cycles for timing in analysis.tasks}
    for found in task_dynamics(robot, recording):
        task = robot.task(found.name)
        if task is not None and facts.outside_of(task.name):
            own = _net_execution_times(recording, found, transfer_cycles)
            release = _completed(recording, found.name)[1]
            counts += outside_count(facts, task, bounds[task.name], release, own, since)
    return counts


def _entries(recording: Recording, source: int) -> NDArray[np.int64]:
    entered = recording.of_kind(EventKind.INTERRUPT_ENTERED)
    return np.asarray(entered["at_cycles"][entered["subject"] == source], np.int64)


def ratio(bound: int, observed: int) -> float | None:
    """Bound over observed maximum."""
    return bound / observed if observed else None


def exceeded(
    analysis: Analysis, observed: dict[str, Observed], long_run: dict[str, Any] | None = None
) -> list[str]:
    """Observations above their bounds, in words: responses, net execution times and stacks, and
    jobs of tasks that a thread never lets run."""
    found = []
    endless = [thread for thread in analysis.background.never_waiting if never_waits(thread[1])]
    for timing in analysis.tasks:
        name = timing.task.name
        seen = observed.get(name)
        pairs = []
        response = analysis.bounds[name].bound
        if seen is not None:
            deepest = timing.stack_bound_bytes
            stolen = 0 if seen.without_transfers else analysis.stolen_cycles(name)
            own = timing.job.cycles + stolen
            pairs = [
                ("a response time of", seen.response_cycles, response),
                ("an execution time of", seen.execution_cycles, own),
                ("a stack of", seen.stack_bytes, deepest),
            ]
        if long_run is not None and name in long_run["tasks"]:
            longest = long_run["tasks"][name]["response_time_cycles"]["max"]
            pairs.append(("in the long run a response time of", longest or 0, response))
        held = [t.name for t, _ in endless if t.priority >= timing.task.priority]
        if held and seen is not None:
            found.append(f"{name} completed {seen.jobs} jobs, but {held[0]} never waits for it")
        found += [
            f"{name} showed {what} {value}, above its bound of {math.ceil(bound)}"
            for what, value, bound in pairs
            if bound is not None and value > bound
        ]
    return found


def refuse_exceeded(found: Sequence[str]) -> None:
    """Raise `ExecutionTimeError` with the observations above their bounds, if there are any."""
    if found:
        raise ExecutionTimeError(
            f"{found[0]}; a fact in timing.toml does not hold, or the analysis is wrong",
            detail="\n".join(found),
        )


def check_bounds(
    analysis: Analysis, observed: dict[str, Observed], long_run: dict[str, Any] | None = None
) -> None:
    """Raise `ExecutionTimeError` when something seen lies above its bound."""
    refuse_exceeded(exceeded(analysis, observed, long_run))


def used_stacks(recording: Recording) -> dict[str, int]:
    """What a run used of each thread's stack, in bytes, by its name in lower case. That of the
    environment task counts from the start of the program on."""
    return {thread.name.lower(): thread.stack_used_bytes for thread in recording.threads}
