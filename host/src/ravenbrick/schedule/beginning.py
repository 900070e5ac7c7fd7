# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What can be under way when a busy period starts of which the release is known."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from ravenbrick.schedule.blocking import NO_BLOCKING, Blocking
from ravenbrick.schedule.demand import Source, Window
from ravenbrick.schedule.model import Task
from ravenbrick.schedule.quantity import Time, ceiling

__all__ = ["Beginning", "JobKind", "Known", "LeftOut", "Request"]


@dataclass(frozen=True)
class Request:
    """Jobs of `source` come only from a request in a job of one of the tasks until `lasts` after
    the end of that job. `rest` is the longest execution of some of these tasks' jobs from their
    first request to their end, with the critical section in which they may be at that request."""

    source: str
    tasks: tuple[str, ...]
    lasts: Time = 0
    rest: tuple[tuple[str, Time], ...] = ()


@dataclass(frozen=True)
class JobKind:
    """Jobs of a task that take at most `wcet` and after whose release, until the next one, at most
    this many jobs of each source come (parts of one where a job is a burst). `turns` as of a task.
    """

    wcet: Time
    most: tuple[tuple[str, Time], ...] = ()
    turns: tuple[Time, ...] = ()

    def execution(self, number: int) -> Time:
        """Of the job with this number from the task's phase on."""
        return self.turns[number % len(self.turns)] if self.turns else self.wcet


@dataclass(frozen=True)
class Known:
    """What is known besides the phases when a busy period starts.

    `responses` are bounds of response times, which tell when a job of a less urgent task is over.
    `blocking` is the longest blocking of a task by less urgent ones without those of the first
    names, and without the sections in jobs of the second ones, which end outside of sections; None
    takes the sections of the task set. Each job of a task in `kinds` is of one of its kinds.
    """

    responses: Mapping[str, Time | None]
    requests: tuple[Request, ...] = ()
    blocking: Callable[[Task, frozenset[str], frozenset[str]], Time] | None = None
    kinds: Mapping[str, tuple[JobKind, ...]] = field(default_factory=dict)


Limits = frozenset[tuple[str, Time]]
"""Most jobs of some sources until the end of the job."""
LeftOut = tuple[frozenset[str], frozenset[str], frozenset[str], Limits]
"""Less urgent tasks that are over by the start, sources of interrupts that none requests, less
urgent tasks that are over by the first phased arrival, and limits of sources that only the job
itself requests."""


def _at_most(source: Source, jobs: Time, span: Time) -> Source:
    """A source of which at most so many jobs come in a window that is no longer than this."""
    limits = (*source.task.limits, (jobs, span + source.jitter, 0))
    return replace(source, task=replace(source.task, limits=limits))


class Beginning:
    """What can be under way when a busy period of `window.task` starts.

    It starts with the first arrival of a phased task of at least this priority (`begin`, which is
    after the longest jitter) or before it with an arrival of one without a phase. That lead is at
    most the time in which blocking and all without a phase are served. A less urgent task runs
    before the start or not at all, but for the section that blocks; since the clock releases in the
    order of arrivals, it arrived before the tasks that start the busy period. A job that is over by
    that first arrival ended at its own priority, which it has not in a busy period, so the busy
    period starts after its sections. A job that is no less urgent is over by the start or arrives
    in the busy period, which is no longer than `longest`. What only the job itself requests comes
    after its request: from the start of the section in which that is, where nothing more urgent
    waits, to the end of the job there is the rest of its execution and what more urgent is released
    meanwhile. Jobs of the same priority wait, as the processor is not given away to them.
    """

    def __init__(
        self, window: Window, tasks: Iterable[Task], known: Known, longest: Time | None
    ) -> None:
        self._window, self._known, self._longest = window, known, longest
        self._met = {source.task.name: source.task for source in window.sources}
        self._windows: dict[LeftOut, Window] = {}
        self._tasks = {task.name: task for task in tasks}
        self._clock = window.clock.overheads.clock_resolution
        phased = [source.jitter for source in window.sources if source.task.phase is not None]
        self._jitter = max([window.jitter, *phased])
        self._earliest = self._lead(window) + self._jitter

    @staticmethod
    def _lead(window: Window) -> Time:
        """Time in which blocking and all without a phase are served."""
        without = tuple(source for source in window.sources if source.task.phase is None)
        own = window.own if window.task.phase is None else 0
        alone = replace(window, sources=without)
        return alone.completion(own, 1) if without or own or window.blocking.time else 0

    def _over(self, name: str, begin: Time, before: Time) -> bool:
        """Is each job of a less urgent task that arrived before `begin` over so long before it?"""
        task, response = self._tasks.get(name), self._known.responses.get(name)
        if task is None or task.phase is None or response is None:
            return False
        if task.priority >= self._window.task.priority:
            return False
        latest = ceiling(begin - self._clock - task.phase, task.period) - 1
        return task.phase + latest * task.period + response <= begin - before

    def _passed(self, name: str, begin: Time, before: Time) -> bool:
        """Is each job of a task that is no less urgent over so long before `begin`, or does it
        arrive after the busy period?"""
        task, response = self._met.get(name), self._known.responses.get(name)
        if task is None or task.phase is None or response is None or self._longest is None:
            return False
        following = task.phase + ceiling(begin - task.phase, task.period) * task.period
        over = following - task.period + response
        return over <= begin - before and following >= begin + self._longest

    def _done(self, name: str, begin: Time, before: Time) -> bool:
        """Does no job of a task request anything from so long before `begin` on?"""
        is_over = self._passed if name in self._met else self._over
        return is_over(name, begin, before)

    def _alone_requests(self, request: Request, begin: Time) -> bool:
        """Does only the task's one job of the busy period request it?"""
        task, response = self._window.task, self._known.responses.get(self._window.task.name)
        if task.phase is None or response is None or self._longest is None:
            return False
        first = ceiling(begin - self._window.jitter - task.phase, task.period)
        over = task.phase + (first - 1) * task.period + response
        before = self._earliest + request.lasts
        others = (name for name in request.tasks if name != task.name)
        return (
            over <= begin - before
            and self._longest <= task.period - self._window.jitter
            and all(self._done(name, begin, before) for name in others)
        )

    @cached_property
    def _own_requests(self) -> tuple[tuple[Request, Time], ...]:
        """What the task requests, with the most jobs from a request to the end of its job."""
        task, found = self._window.task, []
        above = tuple(s for s in self._window.sources if s.task.priority > task.priority)
        window = replace(self._window, sources=above, blockings=(NO_BLOCKING,))
        sources = {source.task.name: source for source in above}
        for request in self._known.requests:
            rest, source = dict(request.rest).get(task.name), sources.get(request.source)
            if rest is not None and source is not None:
                length = window.completion(rest + window.own_overhead, 1)
                found.append((request, source.work(length)[0]))
        return tuple(found)

    def left_out(self, begin: Time) -> LeftOut:
        """What cannot be met at this start."""
        earliest = self._earliest
        absent = frozenset(name for name in self._tasks if self._over(name, begin, earliest))
        ended = frozenset(name for name in self._tasks if self._over(name, begin, self._jitter))
        over = frozenset(
            request.source
            for request in self._known.requests
            if all(self._done(name, begin, earliest + request.lasts) for name in request.tasks)
        )
        own = frozenset(
            (request.source, most)
            for request, most in self._own_requests
            if self._alone_requests(request, begin)
        )
        return absent, over, ended - absent, own

    def window(self, left_out: LeftOut) -> Window:
        """The load without that."""
        if left_out not in self._windows:
            self._windows[left_out] = self._without(*left_out)
        return self._windows[left_out]

    def _without(
        self,
        absent: frozenset[str],
        over: frozenset[str],
        ended: frozenset[str],
        own: Limits,
    ) -> Window:
        window, known = self._window, self._known
        blockings = [b for b in window.blockings if b.task not in absent]
        if known.blocking is not None:
            blockings = [Blocking(known.blocking(window.task, absent, ended), "stated")]
        sources = [source for source in window.sources if source.task.name not in over]
        for name, most in own:
            sources = [
                _at_most(source, most, window.task.period) if source.task.name == name else source
                for source in sources
            ]
        return replace(window, sources=tuple(sources), blockings=tuple(blockings) or (NO_BLOCKING,))

    def with_kind(self, window: Window, task: Task, kind: JobKind, number: int) -> Window:
        """The load that starts with a job of this kind and number: what comes until the next one,
        and before the start from the job before. What is over is not met in this lead either."""
        most, found = dict(kind.most), []
        lead = self._lead(window)
        for source in window.sources:
            if source.task.name == task.name:
                alone = replace(source.task, turns=())
                source = replace(source, task=alone, execution=kind.execution(number))
            elif source.task.name in most:
                share = most[source.task.name] + source.work(lead)[0]
                source = _at_most(source, share, task.period)
            found.append(source)
        return replace(window, sources=tuple(found))
