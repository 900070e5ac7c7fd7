# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The load that a job meets in its busy period, as a step function of the window's length."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from ravenbrick.errors import ExitCode, RavenbrickError
from ravenbrick.schedule.blocking import Blocking, blocking_candidates
from ravenbrick.schedule.model import Overheads, Task, TaskSet
from ravenbrick.schedule.multiframe import least_span, most_execution, most_work, release_times
from ravenbrick.schedule.quantity import Time, ceiling, common_multiple, exact

__all__ = ["AnalysisLimitError", "Source", "Window", "window_of"]

STEP_LIMIT = 1_000_000


class AnalysisLimitError(RavenbrickError):
    """The exact answer would take too many steps; the sentence says what to change."""

    exit_code = ExitCode.USAGE


@dataclass(frozen=True)
class Source:
    """An interfering task: a job each `period`, the first delayed by `jitter` into the window."""

    task: Task
    period: Time
    jitter: Time
    execution: Time
    overhead: Time

    @property
    def rate(self) -> Fraction:
        """Long-term jobs per time; a window holds at least this many times its length."""
        rates = [Fraction(share) / Fraction(span) for share, span, _ in self.task.limits]
        return min([Fraction(len(self.task.frames) or 1) / Fraction(self.task.cycle), *rates])

    @property
    def utilization(self) -> Fraction:
        """Long-term share of the processor; limits of bursts are not used."""
        jobs = Fraction(len(self.task.frames) or 1) / Fraction(self.task.cycle)
        execution = Fraction(self.task.utilization) if self.execution else Fraction(0)
        return execution + jobs * self.overhead

    def work(self, window: Time) -> tuple[Time, Time]:
        """Most jobs released in a half-open window of this length (a part of one if limited) and
        their execution without overheads."""
        if self.task.frames:
            return most_work(self.task, window + self.jitter, self.overhead)
        parts, execution, limits = self._in_parts
        count = parts * ceiling(window + self.jitter, self.period)
        for share, span, late in limits:
            count = min(count, share * ceiling(window + late, span))
        jobs = Fraction(count, parts) if count % parts else count // parts
        return jobs, count * execution

    @cached_property
    def _in_parts(self) -> tuple[int, Time, list[tuple[int, Time, Time]]]:
        """Into how many parts the limits divide a job, the execution of one, and the limits in
        parts, with the jitter: whole numbers are fast."""
        limits = [(Fraction(share), span, late) for share, span, late in self.task.limits]
        parts = math.lcm(*(share.denominator for share, _, _ in limits))
        whole = [(int(share * parts), span, self.jitter + late) for share, span, late in limits]
        return parts, exact(Fraction(self.execution) / parts), whole

    def demand(self, window: Time) -> Time:
        """Most execution in a window with its overheads."""
        jobs, execution = self.work(window)
        return execution + jobs * self.overhead if self.overhead else execution

    def steps(self, limit: Time) -> Iterator[Iterator[Time]]:
        """Window lengths up to `limit` just after which the work rises, each from the longest."""
        if self.task.frames:
            times = release_times(self.task, limit + self.jitter)
            yield (time - self.jitter for time in times if time > self.jitter)
        else:
            yield _steps(self.period, self.jitter, limit)
        yield from (_steps(span, self.jitter + late, limit) for _, span, late in self.task.limits)


@dataclass(frozen=True)
class ClockLoad:
    """Work of clock and alarm at the top priority, for all cyclic tasks of the set.

    `released` are their periods and jitters, `phases` their phases. Tick-driven costs follow Burns,
    Tindell, Wellings 1995: with V ticks and K releases in the window, V tick + min(V, K) tick_first
    + max(K - V, 0) tick_further.
    """

    released: tuple[tuple[Time, Time], ...]
    overheads: Overheads
    phases: tuple[Time | None, ...] = ()

    def releases(self, window: Time) -> int:
        """Most releases by the clock in the window."""
        return sum(ceiling(window + jitter, period) for period, jitter in self.released)

    def early(self, window: Time, releases: int) -> int:
        """Most calls of the alarm that release nobody: each comes before another release, of which
        the last may lie behind the window."""
        period = self.overheads.alarm_early_period
        limit = releases + 1 if window > 0 and self.released else 0
        return min(limit, ceiling(window, period)) if period else limit

    def time(self, window: Time) -> Time:
        """Processor time of the clock's work in the window."""
        costs = self.overheads
        if not costs.alarm and not costs.tick_period:
            return 0
        releases = self.releases(window)
        total: Time = releases * costs.alarm + self.early(window, releases) * costs.alarm_early
        if costs.tick_period:
            ticks = ceiling(window, costs.tick_period)
            total += ticks * costs.tick + min(ticks, releases) * costs.tick_first
            total += max(releases - ticks, 0) * costs.tick_further
        return total

    @property
    def utilization(self) -> Fraction:
        """Long-term share of the processor."""
        costs = self.overheads
        rate = sum((1 / Fraction(period) for period, _ in self.released), Fraction(0))
        total = rate * costs.alarm
        period = costs.alarm_early_period
        total += costs.alarm_early * (min(rate, 1 / Fraction(period)) if period else rate)
        if costs.tick_period:
            ticks = 1 / Fraction(costs.tick_period)
            total += ticks * costs.tick + min(ticks, rate) * costs.tick_first
            total += max(rate - ticks, Fraction(0)) * costs.tick_further
        return total

    def periods(self) -> Iterator[Time]:
        """Periods after which the load repeats."""
        if self.overheads.alarm or self.overheads.tick_period:
            yield from (period for period, _ in self.released)
        for period in (self.overheads.alarm_early_period, self.overheads.tick_period):
            if period:
                yield period

    def steps(self, limit: Time) -> Iterator[Iterator[Time]]:
        """Window lengths up to `limit` just after which the load rises, by their cause, each from
        the longest."""
        if self.overheads.alarm or self.overheads.tick_period:
            for period, jitter in self.released:
                yield _steps(period, jitter, limit)
        for period in (self.overheads.alarm_early_period, self.overheads.tick_period):
            if period:
                yield _steps(period, 0, limit)


def _steps(period: Time, jitter: Time, limit: Time) -> Iterator[Time]:
    last, first = (limit + jitter) // period, jitter // period + 1
    return (count * period - jitter for count in range(last, first - 1, -1))


@dataclass(frozen=True)
class Window:
    """What a job of `task` meets from the start of its busy period."""

    task: Task
    jitter: Time
    own_overhead: Time
    blockings: tuple[Blocking, ...]
    sources: tuple[Source, ...]
    clock: ClockLoad

    @property
    def blocking(self) -> Blocking:
        """The longest blocking."""
        return max(self.blockings, key=lambda blocking: blocking.time)

    @property
    def own(self) -> Time:
        """Execution and overhead of one job of the task."""
        return self.task.wcet + self.own_overhead

    @cached_property
    def utilization(self) -> Fraction:
        """Long-term share of the processor at the task's priority and above."""
        own = Source(self.task, self.task.period, 0, self.task.wcet, self.own_overhead)
        loads = (source.utilization for source in (own, *self.sources))
        return sum(loads, self.clock.utilization)

    @property
    def repetition(self) -> Time:
        """Length after which the pattern of releases repeats."""
        cycles = [self.task.cycle, *(source.task.cycle for source in self.sources)]
        return common_multiple([*cycles, *self.clock.periods()])

    def own_work(self, jobs: int) -> Time:
        """Most execution and overhead of this many of the task's own jobs in a row."""
        return most_execution(self.task, jobs) + jobs * self.own_overhead

    def own_arrival(self, job: int) -> Time:
        """Least time from the arrival of the task's first job to that of job `job`."""
        return least_span(self.task, job)

    def interference(self, window: Time) -> Time:
        """Work of the interfering tasks and the clock in a window."""
        total = self.clock.time(window)
        return total + sum(source.demand(window) for source in self.sources)

    def completion(self, work: Time, start: Time) -> Time:
        """Smallest window in which blocking, interference and this work of the task are served.

        `start` is a lower bound of it, from where the fixed-point iteration climbs.
        """
        fixed = self.blocking.time + work
        window = max(start, fixed)
        for _ in range(STEP_LIMIT):
            following = fixed + self.interference(window)
            if following <= window:
                return window
            window = following
        raise AnalysisLimitError(
            f"the busy period of '{self.task.name}' takes more than {STEP_LIMIT} steps; "
            "its utilisation is too close to 1"
        )

    def steps(self, limit: Time) -> Iterator[Time]:
        """Ends of the constant stretches of the interference up to `limit`, and `limit`; from the
        longest.

        Raises `AnalysisLimitError` where there are too many.
        """
        periods = [source.period for source in self.sources] + list(self.clock.periods())
        periods += [span for source in self.sources for _, span, _ in source.task.limits]
        if limit > STEP_LIMIT * min(periods, default=limit):
            raise AnalysisLimitError(
                f"{self.task.name}: the deadline is more than {STEP_LIMIT} times the shortest "
                "period of what is more urgent; use periods and deadlines that are closer together"
            )
        causes = [iter([limit]), *self.clock.steps(limit)]
        causes += [times for source in self.sources for times in source.steps(limit)]
        latest: Time | None = None
        for step in heapq.merge(*causes, reverse=True):
            if step != latest and step > 0:
                latest = step
                yield exact(step)


def window_of(task_set: TaskSet, task: Task, overheads: Overheads) -> Window:
    """The worst window of `task`: synchronous release after the longest jitter and blocking."""
    clocked = [other for other in task_set if other.programs_alarm]
    sources = tuple(
        Source(other, other.period, overheads.jitter(other), other.wcet, overheads.per_job(other))
        for other in task_set.interfering(task)
    )
    return Window(
        task,
        overheads.jitter(task),
        overheads.per_job(task),
        blocking_candidates(task_set, task, overheads),
        sources,
        ClockLoad(
            tuple((other.period, overheads.jitter(other)) for other in clocked),
            overheads,
            tuple(other.phase for other in clocked),
        ),
    )
