# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Response-time analysis that uses known phases of cyclic tasks."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from ravenbrick.schedule.demand import STEP_LIMIT, AnalysisLimitError, Source, Window, window_of
from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet
from ravenbrick.schedule.quantity import Time, ceiling, common_multiple, exact
from ravenbrick.schedule.response_time import (
    ResponseTimeBound,
    Terms,
    response_time_bound,
    terms_of,
)

__all__ = ["phased_response_time_bounds", "synchronous_bound"]


@dataclass(frozen=True)
class _Candidate:
    """A busy period that starts at `begin` and the load that it meets."""

    window: Window
    begin: Time
    jitters: dict[str, Time]

    def jobs(self, task: Task, length: Time) -> int:
        """Most jobs of `task` released within `length` of the start."""
        jitter = self.jitters[task.name]
        if task.phase is None:
            return ceiling(length + jitter, task.period)
        first = ceiling(self.begin - jitter - task.phase, task.period)
        return ceiling(self.begin + length - task.phase, task.period) - first

    def load(self, source: Source, length: Time) -> tuple[Source, Time, Time]:
        """Jobs of a source released within `length` of the start, and their execution."""
        jobs = self.jobs(source.task, length)
        return source, jobs, jobs * source.execution

    def arrival(self, number: int) -> Time:
        """Arrival of the task's own job `number` of the busy period, from its start."""
        task, jitter = self.window.task, self.window.jitter
        if task.phase is None:
            return number * task.period - jitter
        first = ceiling(self.begin - jitter - task.phase, task.period)
        return task.phase + (first + number) * task.period - self.begin

    def initial(self) -> Time:
        """Interference released at the very start, or before it and still unserved."""
        total: Time = 0
        for source in self.window.sources:
            task, jitter = source.task, source.jitter
            if task.phase is None:
                count = jitter // task.period + 1
            else:
                first = ceiling(self.begin - jitter - task.phase, task.period)
                count = (self.begin - task.phase) // task.period + 1 - first
            total += count * (source.execution + source.overhead)
        return total

    def clock_time(self, length: Time) -> Time:
        """The clock's work within `length`; releases at the same instant share a call."""
        clock = self.window.clock
        costs = clock.overheads
        if costs.tick_period or not costs.alarm:
            return clock.time(length)
        instants: set[Time] = set()
        total = alone = 0
        for (period, jitter), phase in zip(clock.released, clock.phases, strict=True):
            if phase is None:
                alone += ceiling(length + jitter, period)
                continue
            first = ceiling(self.begin - jitter - phase, period)
            last = ceiling(self.begin + length - phase, period)
            total += last - first
            instants |= {phase + number * period for number in range(first, last)}
        calls = alone + len(instants)
        work = calls * costs.alarm + (total - len(instants)) * costs.alarm_further
        early = min(clock.early(length, calls), alone + self._after_pauses(instants) + 1)
        return work + early * costs.alarm_early

    def _after_pauses(self, instants: set[Time]) -> int:
        """Instants after the start that lie far enough behind the one before for an early call."""
        ordered = sorted(instants)
        pauses = pairwise(ordered)
        period = self.window.clock.overheads.alarm_early_period
        far = sum(after - before >= period for before, after in pauses if after > self.begin)
        return far + int(bool(ordered) and ordered[0] > self.begin)

    def completion(self, jobs: int, start: Time) -> Time:
        """End of blocking, interference and `jobs` own jobs; `start` is a lower bound of it."""
        fixed = self.window.blocking.time + jobs * self.window.own
        length = max(start, fixed)
        for _ in range(STEP_LIMIT):
            following = fixed + self.clock_time(length)
            for source in self.window.sources:
                _, count, execution = self.load(source, length)
                following += execution + count * source.overhead
            if following <= length:
                return length
            length = following
        raise AnalysisLimitError(
            f"the busy period of '{self.window.task.name}' takes more than {STEP_LIMIT} steps"
        )

    def worst(self, jobs_at_most: int) -> tuple[Time, int, Time] | None:
        """(response time, job, completion) of the worst job, None if the task has none here."""
        worst: tuple[Time, int, Time] | None = None
        length = self.completion(0, self.window.blocking.time + self.initial())
        for number in range(jobs_at_most):
            arrival = self.arrival(number)
            if arrival >= length and arrival > 0:
                break
            length = self.completion(number + 1, length + self.window.own)
            if worst is None or length - arrival > worst[0]:
                worst = (exact(length - arrival), number, exact(length))
        return worst

    def terms(self, job: int, length: Time) -> Terms:
        """The worst job's response time by its parts."""
        window = self.window
        arrival = self.arrival(job)
        return terms_of(
            window,
            job,
            (window.task.wcet, job * window.task.wcet),
            [self.load(source, length) for source in window.sources],
            clock=self.clock_time(length),
            jitter=exact(max(0, -arrival)),
            waited=exact(max(0, arrival)),
        )


def _begins(window: Window, repetition: Time) -> list[Time]:
    """Starts of busy periods to examine: each release, as late as its jitter allows."""
    found: set[Time] = set()
    releases = [(source.task, source.jitter) for source in window.sources]
    for task, jitter in [*releases, (window.task, window.jitter)]:
        if task.phase is not None:
            count = int(repetition // task.period)
            if count + len(found) > STEP_LIMIT:
                raise AnalysisLimitError(
                    f"the phases repeat after {repetition} only, which is too far to examine; "
                    "use periods with a smaller common multiple"
                )
            begin = (task.phase + jitter) % repetition
            found |= {(begin + k * task.period) % repetition for k in range(count)}
    return sorted(found)


def _phased_bound(task_set: TaskSet, task: Task, overheads: Overheads) -> ResponseTimeBound:
    window = window_of(task_set, task, overheads)
    involved = [task, *(source.task for source in window.sources)]
    phased = [each.period for each in involved if each.phase is not None]
    framed = any(each.frames for each in involved)
    if not phased or framed or window.utilization > 1:
        return response_time_bound(task_set, task, overheads)
    jitters = {source.task.name: source.jitter for source in window.sources}
    jitters[task.name] = window.jitter
    jobs_at_most = int(window.repetition // task.period) + 1 if window.utilization == 1 else None
    worst: tuple[tuple[Time, int, Time], _Candidate] | None = None
    for begin in _begins(window, common_multiple(phased)):
        candidate = _Candidate(window, begin, jitters)
        found = candidate.worst(jobs_at_most or STEP_LIMIT)
        if found is not None and (worst is None or found[0] > worst[0][0]):
            worst = (found, candidate)
    if worst is None:
        return response_time_bound(task_set, task, overheads)
    (bound, job, length), candidate = worst
    return ResponseTimeBound(task, bound, terms=candidate.terms(job, length))


def synchronous_bound(
    task_set: TaskSet, task: Task, overheads: Overheads = NO_OVERHEADS
) -> ResponseTimeBound:
    """Worst response time of the first job of `task` in a release of all cyclic tasks at the same
    instant, after which they keep their phases; they must all be declared as 0.

    As `phased_response_time_bounds`, for this one start of a busy period.
    """
    window = window_of(task_set, task, overheads)
    jitters = {source.task.name: source.jitter for source in window.sources}
    candidate = _Candidate(window, window.jitter, {**jitters, task.name: window.jitter})
    found = candidate.worst(1)
    if found is None or window.utilization > 1:
        return ResponseTimeBound(task, None)
    return ResponseTimeBound(task, found[0], terms=candidate.terms(0, found[2]))


def phased_response_time_bounds(
    task_set: TaskSet, overheads: Overheads = NO_OVERHEADS
) -> tuple[ResponseTimeBound, ...]:
    """Worst response times when the cyclic tasks with a phase keep it; most urgent first.

    A busy period starts, at worst, with a release of one of the phased tasks after its longest
    jitter; all such starts within one repetition are examined, in each of them the other phased
    tasks arrive when they must and tasks without a phase at the start (Tindell 1994; Palencia,
    Gonzalez Harbour 1998, with one transaction for all phased tasks). Blocking and overheads are
    as in `response_time_bound`, but for releases at the same instant, which share a call of the
    alarm. Exact for independent tasks which all have phases and no jitter. Phases do not help
    tasks that meet a multiframe task, whose first frame is unknown.
    """
    return tuple(_phased_bound(task_set, task, overheads) for task in task_set.by_priority())
