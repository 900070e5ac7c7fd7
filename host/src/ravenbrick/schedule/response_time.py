# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Response-time analysis under fixed priorities, with each term of the bound kept apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from ravenbrick.schedule.blocking import NO_BLOCKING, Blocking
from ravenbrick.schedule.demand import STEP_LIMIT, AnalysisLimitError, Source, Window, window_of
from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet
from ravenbrick.schedule.quantity import Time, ceiling, common_multiple, exact

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
    it never ends.
    """

    task: Task
    bound: Time | None
    jobs: tuple[Time, ...] = ()
    busy_period: Time | None = None
    terms: Terms | None = None

    @property
    def meets_deadline(self) -> bool:
        """Whether the bound is within the deadline."""
        return self.bound is not None and self.bound <= self.task.deadline

    @property
    def from_release(self) -> Time | None:
        """Bound counted from the release instead of the arrival."""
        if self.terms is None:
            return None
        task, jitter = self.task, self.terms.release_jitter
        return exact(max(r - max(0, jitter - q * task.period) for q, r in enumerate(self.jobs)))

    @property
    def slack(self) -> Time | None:
        """Deadline minus bound; negative when the deadline can be missed."""
        return None if self.bound is None else self.task.deadline - self.bound


def _too_long(task: Task) -> AnalysisLimitError:
    return AnalysisLimitError(
        f"the busy period of '{task.name}' takes more than {STEP_LIMIT} steps; "
        "its utilisation is too close to 1"
    )


def _interference_parts(counts: Sequence[tuple[Source, Time]]) -> tuple[Interference, ...]:
    """Execution of the interfering jobs, task by task; tasks without a job are left out."""
    return tuple(Interference(s.task.name, n, n * s.execution) for s, n in counts if n)


def _overhead_parts(counts: Sequence[tuple[Source, Time]]) -> tuple[Time, Time]:
    """What the jobs cost in context switches and in interrupt entries."""
    switches: Time = 0
    entries: Time = 0
    for source, count in counts:
        if source.task.release == "interrupt":
            entries += count * source.overhead
        else:
            switches += count * source.overhead
    return switches, entries


def terms_of(
    window: Window,
    job: int,
    counts: Sequence[tuple[Source, Time]],
    *,
    clock: Time,
    jitter: Time,
    waited: Time,
) -> Terms:
    """The response time of a job by its parts; `counts` are the jobs that delay it."""
    own = Source(window.task, window.task.period, 0, 0, window.own_overhead)
    switches, entries = _overhead_parts([*counts, (own, job + 1)])
    return Terms(
        job,
        window.task.wcet,
        job * window.task.wcet,
        _interference_parts(counts),
        window.blocking,
        switches,
        entries,
        clock,
        jitter,
        waited,
    )


def _terms(window: Window, job: int, completion: Time) -> Terms:
    return terms_of(
        window,
        job,
        [(source, source.jobs(completion)) for source in window.sources],
        clock=window.clock.time(completion),
        jitter=window.jitter,
        waited=job * window.task.period,
    )


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
    """
    window = window_of(task_set, task, overheads)
    utilization = window.utilization
    if utilization > 1:
        return ResponseTimeBound(task, None)
    jobs_at_most = window.repetition // task.period if utilization == 1 else None
    responses: list[Time] = []
    completions: list[Time] = []
    completion: Time = 0
    while True:
        job = len(responses)
        completion = window.completion(job, completion + window.own if job else 0)
        completions.append(completion)
        responses.append(exact(completion - job * task.period + window.jitter))
        if completion + window.jitter <= (job + 1) * task.period:
            break
        if len(responses) == jobs_at_most:
            return _bound(window, responses, completions, None)
        if len(responses) >= STEP_LIMIT:
            raise _too_long(task)
    return _bound(window, responses, completions, exact(completion))


def _bound(
    window: Window, responses: list[Time], completions: list[Time], busy_period: Time | None
) -> ResponseTimeBound:
    worst = max(range(len(responses)), key=responses.__getitem__)
    terms = _terms(window, worst, completions[worst])
    return ResponseTimeBound(window.task, responses[worst], tuple(responses), busy_period, terms)


def response_time_bounds(
    task_set: TaskSet, overheads: Overheads = NO_OVERHEADS
) -> tuple[ResponseTimeBound, ...]:
    """`response_time_bound` of each task, most urgent first."""
    return tuple(response_time_bound(task_set, task, overheads) for task in task_set.by_priority())


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
    continuous time it is an upper bound that is approached, not reached.
    """
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
