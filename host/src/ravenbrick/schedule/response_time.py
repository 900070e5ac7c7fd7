# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Response-time analysis under fixed priorities, with each term of the bound kept apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from ravenbrick.schedule.blocking import NO_BLOCKING, Blocking
from ravenbrick.schedule.demand import STEP_LIMIT, AnalysisLimitError, Source, Window, window_of
from ravenbrick.schedule.model import NO_OVERHEADS, Frame, Overheads, Task, TaskSet
from ravenbrick.schedule.multiframe import frames_from
from ravenbrick.schedule.quantity import Time, ceiling, common_multiple, exact
from ravenbrick.schedule.whole_times import common_denominator, multiplied

__all__ = [
    "Interference",
    "ResponseTimeBound",
    "Terms",
    "is_schedulable",
    "non_preemptive_bounds",
    "response_time_bound",
    "response_time_bounds",
    "terms_of",
]


@dataclass(frozen=True)
class Interference:
    """Execution of `jobs` jobs of a more urgent task, without their overheads."""

    task: str
    jobs: Time
    time: Time


@dataclass(frozen=True)
class Terms:
    """Where the worst response time goes; `total` is the response-time bound.

    `job` counts from the start of the busy period. `previous_jobs` is the execution of the task's
    own earlier jobs in it, `waited` the time from its start to the job's arrival.
    """

    job: int
    own: Time
    previous_jobs: Time
    interference: tuple[Interference, ...]
    blocking: Blocking
    context_switches: Time
    interrupt_entries: Time
    clock: Time
    release_jitter: Time
    waited: Time

    @property
    def interference_time(self) -> Time:
        """Sum over the interfering tasks."""
        return exact(sum(part.time for part in self.interference))

    @property
    def overheads(self) -> Time:
        """What the run-time costs."""
        return self.context_switches + self.interrupt_entries + self.clock

    @property
    def total(self) -> Time:
        """Sum of all terms."""
        work = self.own + self.previous_jobs + self.interference_time + self.blocking.time
        return exact(work + self.overheads + self.release_jitter - self.waited)


@dataclass(frozen=True)
class ResponseTimeBound:
    """Bound of a task's response time, from arrival to completion; None when there is none.

    `jobs` holds the bound of each job in the busy period, and `busy_period` its length: None when
    it never ends. `frames` holds the bound of each frame of a multiframe task.
    """

    task: Task
    bound: Time | None
    jobs: tuple[Time, ...] = ()
    busy_period: Time | None = None
    terms: Terms | None = None
    frames: tuple[Time, ...] = ()

    @property
    def meets_deadline(self) -> bool:
        """Whether the bound is within the deadline."""
        slack = self.slack
        return slack is not None and slack >= 0

    @property
    def from_release(self) -> Time | None:
        """Bound counted from the release instead of the arrival, which is not shorter for a
        multiframe task."""
        if self.terms is None:
            return None
        task, jitter = self.task, self.terms.release_jitter
        if task.frames:
            return self.bound
        return exact(max(r - max(0, jitter - q * task.period) for q, r in enumerate(self.jobs)))

    @property
    def slack(self) -> Time | None:
        """Deadline minus bound, the least of all frames; negative when it can be missed."""
        if self.bound is None:
            return None
        frames = zip(self.task.frames, self.frames, strict=bool(self.frames))
        left = [frame.deadline - time for frame, time in frames]
        return min(left, default=self.task.deadline - self.bound)


def _too_long(task: Task) -> AnalysisLimitError:
    return AnalysisLimitError(
        f"the busy period of '{task.name}' takes more than {STEP_LIMIT} steps; "
        "its utilisation is too close to 1"
    )


def _in_unit(found: ResponseTimeBound, task: Task, unit: int) -> ResponseTimeBound:
    """A bound of the task that was found with all times multiplied by `unit`."""
    if unit == 1:
        return found
    share = Fraction(1, unit)
    times = (found.bound, found.jobs, found.busy_period, found.terms, found.frames)
    bound, jobs, busy_period, terms, frames = multiplied(times, share)
    return ResponseTimeBound(task, bound, jobs, busy_period, terms, frames)


Load = tuple[Source, Time, Time]
"""A source with its jobs and their execution."""


def _interference_parts(loads: Sequence[Load]) -> tuple[Interference, ...]:
    """Execution of the interfering jobs, task by task; tasks without a job are left out."""
    return tuple(Interference(s.task.name, jobs, time) for s, jobs, time in loads if jobs)


def _overhead_parts(loads: Sequence[Load]) -> tuple[Time, Time]:
    """What the jobs cost in context switches and in interrupt entries."""
    switches: Time = 0
    entries: Time = 0
    for source, count, _ in loads:
        if source.task.release == "interrupt":
            entries += count * source.overhead
        else:
            switches += count * source.overhead
    return switches, entries


def terms_of(
    window: Window,
    job: int,
    execution: tuple[Time, Time],
    loads: Sequence[Load],
    *,
    clock: Time,
    jitter: Time,
    waited: Time,
) -> Terms:
    """The response time of a job by its parts; `loads` are the jobs that delay it, `execution` its
    own and that of the task's earlier jobs."""
    own = Source(window.task, window.task.period, 0, 0, window.own_overhead)
    switches, entries = _overhead_parts([*loads, (own, job + 1, 0)])
    return Terms(
        job,
        *execution,
        _interference_parts(loads),
        window.blocking,
        switches,
        entries,
        clock,
        jitter,
        waited,
    )


@dataclass(frozen=True)
class _Job:
    """A job of the busy period, the frame at `place`; `execution` is the task's up to its end."""

    number: int
    place: int
    frame: Frame
    arrival: Time
    execution: Time
    completion: Time

    def response(self, window: Window) -> Time:
        """Response time from the arrival, which may lie before the busy period."""
        return exact(self.completion - self.arrival + window.jitter)

    def terms(self, window: Window) -> Terms:
        """The response time by its parts."""
        return terms_of(
            window,
            self.number,
            (self.frame.wcet, self.execution - self.frame.wcet),
            [(source, *source.work(self.completion)) for source in window.sources],
            clock=window.clock.time(self.completion),
            jitter=window.jitter,
            waited=self.arrival,
        )


def _busy_period(window: Window, first: int) -> tuple[list[_Job], bool]:
    """Jobs of the busy period that starts with frame `first`, and whether it ends."""
    task = window.task
    never_ends = window.utilization == 1
    jobs_at_most = int(window.repetition // task.cycle) * (len(task.frames) or 1)
    jobs: list[_Job] = []
    execution: Time = 0
    completion: Time = 0
    for arrival, frame in frames_from(task, first):
        number = len(jobs)
        if jobs and completion + window.jitter <= arrival:
            return jobs, True
        if never_ends and number == jobs_at_most:
            return jobs, False
        if number >= STEP_LIMIT:
            raise _too_long(task)
        execution += frame.wcet
        start = completion + frame.wcet + window.own_overhead if jobs else 0
        completion = window.completion(execution + (number + 1) * window.own_overhead, start)
        place = (first + number) % (len(task.frames) or 1)
        jobs.append(_Job(number, place, frame, arrival, execution, completion))
    raise AssertionError("frames never end")


def response_time_bound(
    task_set: TaskSet, task: Task, overheads: Overheads = NO_OVERHEADS
) -> ResponseTimeBound:
    """Worst response time of `task` under preemptive fixed priorities; deadlines are arbitrary.

    For job q of the busy period that starts with a synchronous release, w(q) is the smallest
    w = B + (q + 1) C + sum over the interfering tasks j of ceil((w + J_j) / T_j) C_j, and
    R = J + max over q of w(q) - q T, until a job ends before the next arrives: Joseph and Pandya
    1986; Audsley, Burns, Richardson, Tindell, Wellings 1993 (jitter); Lehoczky 1990 and Tindell,
    Burns, Wellings 1994 (several jobs). Costs of switches and clock: Burns, Tindell, Wellings
    1995. At utilisation 1 the jobs of one repetition of the pattern are examined, since
    w(q + H / T) = w(q) + H. Phases are not used, which is sound. Exact for independent tasks that
    can be released together.

    A multiframe task interferes with the most work of any of its frames in a row, and its own busy
    period is examined from each frame: exact if no such sequence is longer than the one from the
    longest frame on (accumulatively monotonic: Zuhily, Burns 2008), else an upper bound.
    """
    unit = common_denominator([task_set, task, overheads])
    own, costs = multiplied(task, unit), multiplied(overheads, unit)
    return _in_unit(_bound_of(multiplied(task_set, unit), own, costs), task, unit)


def _bound_of(task_set: TaskSet, task: Task, overheads: Overheads) -> ResponseTimeBound:
    window = window_of(task_set, task, overheads)
    if window.utilization > 1:
        return ResponseTimeBound(task, None)
    periods = [_busy_period(window, first) for first in range(len(task.frames) or 1)]
    jobs, ends = max(periods, key=lambda found: max(job.response(window) for job in found[0]))
    responses = tuple(job.response(window) for job in jobs)
    worst = jobs[max(range(len(jobs)), key=responses.__getitem__)]
    busy_period = exact(max(found[0][-1].completion for found in periods)) if ends else None
    return ResponseTimeBound(
        task,
        worst.response(window),
        responses,
        busy_period,
        worst.terms(window),
        _frame_bounds(window, [job for found in periods for job in found[0]]),
    )


def _frame_bounds(window: Window, jobs: list[_Job]) -> tuple[Time, ...]:
    """Worst response time of each frame."""
    return tuple(
        max(job.response(window) for job in jobs if job.place == place)
        for place in range(len(window.task.frames))
    )


def response_time_bounds(
    task_set: TaskSet, overheads: Overheads = NO_OVERHEADS
) -> tuple[ResponseTimeBound, ...]:
    """`response_time_bound` of each task, most urgent first."""
    unit = common_denominator([task_set, overheads])
    whole, costs = multiplied(task_set, unit), multiplied(overheads, unit)
    tasks = zip(task_set.by_priority(), whole.by_priority(), strict=True)
    return tuple(_in_unit(_bound_of(whole, own, costs), task, unit) for task, own in tasks)


def is_schedulable(task_set: TaskSet, overheads: Overheads = NO_OVERHEADS) -> bool:
    """Whether every bound is within its deadline."""
    return all(response_time_bound(task_set, task, overheads).meets_deadline for task in task_set)


def _start(
    task: Task, interfering: tuple[Task, ...], blocking: Time, job: int, start: Time
) -> Time:
    window = max(start, blocking + job * task.wcet)
    for _ in range(STEP_LIMIT):
        following = blocking + job * task.wcet
        for other in interfering:
            following += ((window + other.release_jitter) // other.period + 1) * other.wcet
        if following <= window:
            return window
        window = following
    raise _too_long(task)


def non_preemptive_bounds(task_set: TaskSet) -> tuple[ResponseTimeBound, ...]:
    """Worst response times when a job that has started is never preempted; most urgent first.

    Every job of the level-i busy period counts, not only the first (Davis, Burns, Bril, Lukkien
    2007, which corrects the analysis of 1994). Blocking is the longest less urgent job; for
    continuous time it is an upper bound that is approached, not reached. Each job of a multiframe
    task counts as its longest.
    """
    task_set = task_set.without_frames()
    return tuple(_non_preemptive(task_set, task) for task in task_set.by_priority())


def _non_preemptive(task_set: TaskSet, task: Task) -> ResponseTimeBound:
    interfering, lower = task_set.interfering(task), task_set.lower(task)
    utilization = sum((Fraction(t.utilization) for t in (task, *interfering)), Fraction(0))
    if utilization > 1:
        return ResponseTimeBound(task, None)
    longest = max(lower, key=lambda other: other.wcet, default=None)
    found = Blocking(longest.wcet, "section", longest.name, "processor") if longest else NO_BLOCKING
    blocking = max(found, Blocking(task.blocking, "stated"), key=lambda each: each.time)
    repetition = common_multiple(t.period for t in (task, *interfering))
    jobs_at_most = repetition // task.period if utilization == 1 else None
    responses: list[Time] = []
    starts: list[Time] = []
    start: Time = 0
    ended = False
    while not ended and len(responses) != jobs_at_most:
        job = len(responses)
        if job >= STEP_LIMIT:
            raise _too_long(task)
        start = _start(task, interfering, blocking.time, job, start)
        starts.append(start)
        responses.append(exact(start + task.wcet - job * task.period + task.release_jitter))
        ended = _busy_until(task, interfering, blocking.time, job, start) <= (
            (job + 1) * task.period - task.release_jitter
        )
    worst = max(range(len(responses)), key=responses.__getitem__)
    terms = _non_preemptive_terms(task, interfering, blocking, worst, starts[worst])
    busy = exact(start + task.wcet) if ended else None
    return ResponseTimeBound(task, responses[worst], tuple(responses), busy, terms)


def _busy_until(
    task: Task, interfering: tuple[Task, ...], blocking: Time, job: int, start: Time
) -> Time:
    """End of the work of level i once jobs 0..`job` of the task are served."""
    window = start + task.wcet
    for _ in range(STEP_LIMIT):
        following = blocking + (job + 1) * task.wcet
        for other in interfering:
            following += ceiling(window + other.release_jitter, other.period) * other.wcet
        if following <= window:
            return window
        window = following
    raise _too_long(task)


def _non_preemptive_terms(
    task: Task, interfering: tuple[Task, ...], blocking: Blocking, job: int, start: Time
) -> Terms:
    parts = []
    for other in interfering:
        count = (start + other.release_jitter) // other.period + 1
        parts.append(Interference(other.name, count, count * other.wcet))
    return Terms(
        job,
        task.wcet,
        job * task.wcet,
        tuple(parts),
        blocking,
        0,
        0,
        0,
        task.release_jitter,
        job * task.period,
    )
