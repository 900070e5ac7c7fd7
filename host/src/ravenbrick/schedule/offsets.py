# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Response-time analysis that uses known phases of cyclic tasks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

from ravenbrick.schedule.beginning import Beginning, Known, LeftOut
from ravenbrick.schedule.demand import (
    STEP_LIMIT,
    AnalysisLimitError,
    Source,
    Window,
    window_of,
)
from ravenbrick.schedule.model import NO_OVERHEADS, Overheads, Task, TaskSet
from ravenbrick.schedule.quantity import Time, ceiling, common_multiple, exact
from ravenbrick.schedule.response_time import (
    ResponseTimeBound,
    Terms,
    response_time_bound,
    response_time_bounds,
    terms_of,
)
from ravenbrick.schedule.whole_times import common_denominator, multiplied

__all__ = [
    "phased_response_time_bound",
    "phased_response_time_bounds",
    "synchronous_bound",
]

# Starts of busy periods for which less urgent tasks are looked at.
LONGEST_REPETITION = 10_000


def _execution(source: Source, first: int, jobs: int) -> Time:
    """Of so many jobs of a phased source, from one with a number from the phase on."""
    turns = source.task.turns
    if not turns:
        return jobs * source.execution
    whole, rest = divmod(jobs, len(turns))
    more = sum(turns[(first + number) % len(turns)] for number in range(rest))
    return jobs * (source.execution - source.task.wcet) + whole * sum(turns) + more


def _repeating(task: Task) -> Time:
    """After how long a phased task's jobs come and take their times again."""
    return task.period * (len(task.turns) or 1)


@dataclass(frozen=True)
class _Candidate:
    """A busy period that starts at `begin` and the load that it meets."""

    window: Window
    begin: Time
    jitters: dict[str, Time]

    def load(self, source: Source, length: Time) -> tuple[Source, Time, Time]:
        """Most jobs of a source released within `length` of the start, and their execution."""
        task, jitter = source.task, self.jitters[source.task.name]
        if task.phase is None:
            return source, *source.work(length)
        first = ceiling(self.begin - jitter - task.phase, task.period)
        jobs = ceiling(self.begin + length - task.phase, task.period) - first
        return source, jobs, _execution(source, first, jobs)

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
                limits = (n * ((jitter + late) // span + 1) for n, span, late in task.limits)
                count = min([jitter // task.period + 1, *limits])
                work = count * source.execution
            else:
                first = ceiling(self.begin - jitter - task.phase, task.period)
                count = (self.begin - task.phase) // task.period + 1 - first
                work = _execution(source, first, count)
            total += work + count * source.overhead
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
                following += execution + (count * source.overhead if source.overhead else 0)
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


class _Signatures:
    """Tells starts of busy periods apart by what is met in them: what is left out, and the releases
    of phased tasks within the longest busy period, from the start on. Starts with the same one have
    the same bound."""

    def __init__(self, window: Window, longest: Time) -> None:
        self._longest = longest
        clock = zip(window.clock.released, window.clock.phases, strict=True)
        found = [(phase, *released) for released, phase in clock]
        releases = [(source.task, source.jitter) for source in window.sources]
        for task, jitter in [*releases, (window.task, window.jitter)]:
            for turn in range(len(task.turns) or 1):
                phase = None if task.phase is None else task.phase + turn * task.period
                found.append((phase, _repeating(task), jitter))
        self._phased = [(p, t, j) for p, t, j in dict.fromkeys(found) if p is not None]

    def of(self, begin: Time, left_out: LeftOut) -> tuple[object, ...]:
        """That of one start."""
        return (
            left_out,
            *(
                min((phase + jitter - begin) % period - jitter, self._longest)
                for phase, period, jitter in self._phased
            ),
        )


Worst = tuple[tuple[Time, int, Time], _Candidate]


def _worst_of_kinds(worst: Worst, beginning: Beginning, known: Known) -> Worst:
    """The worst job, kind by kind, if the start is a release of a task with kinds and none of them
    makes the busy period last until its next one, which is no later than the next of the own."""
    candidate = worst[1]
    for source in candidate.window.sources:
        task, kinds = source.task, known.kinds.get(source.task.name, ())
        if task.phase is None or not kinds or candidate.window.task.period < task.period:
            continue
        number, apart = divmod(candidate.begin - source.jitter - task.phase, task.period)
        if apart:
            continue
        each: list[Worst] = []
        for kind in kinds:
            window = beginning.with_kind(candidate.window, task, kind, int(number))
            chosen = replace(candidate, window=window)
            found = chosen.worst(STEP_LIMIT)
            if found is not None and found[2] <= task.period - source.jitter:
                each.append((found, chosen))
        if len(each) == len(kinds):
            return min(worst, max(each, key=lambda one: one[0][0]), key=lambda one: one[0][0])
    return worst


def _worst_terms(
    task_set: TaskSet, task: Task, overheads: Overheads, known: Known, longest: Time | None
) -> Terms | None:
    """The worst response time by its parts, over all starts of busy periods, which are no longer
    than `longest`; None where phases do not help."""
    window = window_of(task_set, task, overheads)
    involved = [task, *(source.task for source in window.sources)]
    phased = [_repeating(each) for each in involved if each.phase is not None]
    framed = any(each.frames for each in involved)
    if not phased or framed or window.utilization > 1:
        return None
    repetition, lower = common_multiple(phased), list[Task]()
    for other in sorted(task_set.lower(task), key=lambda each: each.period):
        if other.phase is not None and not other.frames:
            longer = common_multiple([repetition, other.period])
            if longer <= LONGEST_REPETITION * min(phased):
                repetition, lower = longer, [*lower, other]
    jitters = {source.task.name: source.jitter for source in window.sources}
    jitters[task.name] = window.jitter
    jobs_at_most = int(window.repetition // task.period) + 1 if window.utilization == 1 else None
    worst: Worst | None = None
    seen: set[tuple[object, ...]] = set()
    beginning = Beginning(window, lower, known, longest)
    signatures = None if longest is None else _Signatures(window, longest)
    for begin in _begins(window, repetition):
        left_out = beginning.left_out(begin)
        if signatures is not None:
            signature = signatures.of(begin, left_out)
            if signature in seen:
                continue
            seen.add(signature)
        candidate = _Candidate(beginning.window(left_out), begin, jitters)
        found = candidate.worst(jobs_at_most or STEP_LIMIT)
        if found is not None and (worst is None or found[0] > worst[0][0]):
            closer = _worst_of_kinds((found, candidate), beginning, known)
            if worst is None or closer[0][0] > worst[0][0]:
                worst = closer
    if worst is None:
        return None
    (_, job, length), candidate = worst
    return candidate.terms(job, length)


def _in_whole_times(
    task_set: TaskSet, overheads: Overheads, known: Known
) -> tuple[TaskSet, Overheads, Known, int]:
    """All in a unit in which the times are whole numbers, and how many of it are one of before."""
    responses = tuple(known.responses.values())
    kinds = tuple(known.kinds.values())
    unit = common_denominator([task_set, overheads, known.requests, kinds, responses])
    names = zip(known.responses, multiplied(responses, unit), strict=True)
    stated = known.blocking
    known = Known(
        dict(names),
        multiplied(known.requests, unit),
        None if stated is None else lambda task, *names: exact(stated(task, *names) * unit),
        dict(zip(known.kinds, multiplied(kinds, unit), strict=True)),
    )
    return multiplied(task_set, unit), multiplied(overheads, unit), known, unit


def phased_response_time_bound(
    task_set: TaskSet, task: Task, overheads: Overheads, known: Known
) -> ResponseTimeBound:
    """`phased_response_time_bounds` of one task, with what is known besides the phases."""
    whole, costs, known, unit = _in_whole_times(task_set, overheads, known)
    own = whole.task(task.name)
    longest = response_time_bound(whole, own, costs).busy_period
    found = _worst_terms(whole, own, costs, known, longest)
    if found is None:
        return response_time_bound(task_set, task, overheads)
    terms = multiplied(found, Fraction(1, unit))
    return ResponseTimeBound(task, terms.total, terms=terms)


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
    Gonzalez Harbour 1998, with one transaction for all phased tasks). A less urgent task blocks
    only where a job of it can be under way. Overheads are as in `response_time_bound`, but for
    releases at the same instant, which share a call of the alarm. Exact for independent tasks
    which all have phases and no jitter. Phases do not help tasks that meet a multiframe task,
    whose first frame is unknown.
    """
    plain = response_time_bounds(task_set, overheads)
    known = Known({each.task.name: each.bound for each in plain})
    return tuple(
        phased_response_time_bound(task_set, task, overheads, known)
        for task in task_set.by_priority()
    )
