# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The task set of an image for the response-time analysis: tasks with their blocking, interrupts,
timing events and transfers of the data controller as tasks of their own. Times are in cycles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from ravenbrick.project.robot import Task
from ravenbrick.schedule.beginning import JobKind, Known, Request
from ravenbrick.schedule.model import Overheads, TaskSet
from ravenbrick.schedule.model import Task as ScheduledTask
from ravenbrick.schedule.offsets import phased_response_time_bound
from ravenbrick.schedule.quantity import exact
from ravenbrick.schedule.response_time import (
    ResponseTimeBound,
    response_time_bound,
    response_time_bounds,
)
from ravenbrick.timing.bounds import Bound
from ravenbrick.timing.facts.facts import Facts, KindOfJob
from ravenbrick.timing.kernel import (
    DELAY_UNTIL,
    ENTRY_CALL,
    SUSPEND,
    YIELD,
    InterruptCost,
    Services,
)
from ravenbrick.timing.task_set.alarm import AlarmCosts, exact_cycles
from ravenbrick.timing.task_set.background import Background
from ravenbrick.timing.task_set.interrupt_blocking import InterruptBlocking
from ravenbrick.timing.task_set.scheduled_interrupts import (
    expiries,
    interrupts_seen_by,
    scheduled_interrupts,
)
from ravenbrick.timing.task_set.suspension import suspension_of
from ravenbrick.trace.interrupts import source_name

__all__ = [
    "WAITS",
    "BlockingCause",
    "Change",
    "Executions",
    "Scheduled",
    "TaskTiming",
    "blocking_cause",
    "deepest_stack",
    "periods_us",
    "phased_in_jobs",
    "requests_of",
    "scheduled_bounds",
]

PREEMPTION_BYTES = 68
Change = Callable[[ScheduledTask], ScheduledTask]
"""A task as it may become, for margins."""
ENDLESS_PERIOD_US = 1_000_000
ROUNDS = 3
# Where a task waits for its next release, and where if its body does not wait there.
WAITS = {
    "cyclic": ((DELAY_UNTIL,), ()),
    "sporadic": ((ENTRY_CALL, SUSPEND), (DELAY_UNTIL,)),
}


@dataclass(frozen=True)
class BlockingCause:
    """The cause of a job's blocking: a protected action or masked interrupts of `task`."""

    cycles: int
    task: str
    kind: str


@dataclass(frozen=True)
class TaskTiming:
    """A task's job with its bounds; cycles."""

    task: Task
    job: Bound
    suspension_cycles: int
    suspension_count: int
    blocking: BlockingCause

    @property
    def releases(self) -> int:
        """How often it is released in a period: twice if by a time and by something else."""
        other = self.job.released_by & {ENTRY_CALL, SUSPEND}
        return 2 if other and DELAY_UNTIL in self.job.released_by else 1

    @property
    def stack_bound_bytes(self) -> int | None:
        """Deepest stack, with what a preemption saves."""
        return deepest_stack(self.job)


@dataclass(frozen=True)
class Executions:
    """Bounds of the jobs and of their kinds. With `dispatch`, the cycles of a call that gives the
    processor away at the end of a protected action, they are without such calls, and each release
    of a more urgent task pays for one."""

    jobs: Sequence[tuple[Task, Bound]]
    kinds: Sequence[tuple[KindOfJob, int, tuple[int, ...]]] = ()
    dispatch: int = 0


@dataclass(frozen=True)
class Scheduled:
    """Tasks with their blocking, the task set, and bounds by the task's name."""

    timings: tuple[TaskTiming, ...]
    task_set: TaskSet
    overheads: Overheads
    bounds: dict[str, ResponseTimeBound]


def deepest_stack(job: Bound) -> int | None:
    """Stack of a thread in bytes, with what a preemption saves."""
    return None if job.stack_bytes is None else job.stack_bytes + PREEMPTION_BYTES


def blocking_cause(
    priority: int,
    name: str,
    jobs: Sequence[tuple[Task, Bound]],
    costs: Services,
    ended: frozenset[str] = frozenset(),
) -> BlockingCause:
    """The longest blocking of this priority by less urgent tasks, of which those in `ended` are in
    no protected action.

    One of them may be in a protected action or a masked service. Each of the others may add a
    masked service: it gave the processor away with interrupts masked to a thread that was
    interrupted just as it masked them (`masked.InterruptBlocking`).
    """
    found, masked_cycles = [BlockingCause(0, "", "none")], {}
    for task, job in jobs:
        if task.priority < priority and task.name != name:
            if task.name not in ended:
                section = job.longest_critical_section(2 * priority)
                found.append(BlockingCause(section, task.name, "protected action"))
            masked, service = costs.longest_masked(job.reached)
            found.append(BlockingCause(masked, task.name, f"interrupts masked in {service}"))
            masked_cycles[task.name] = costs.resumed_masked_cycles(job.reached)
    return max((_after_others(cause, masked_cycles) for cause in found), key=lambda c: c.cycles)


def _in_background(
    cause: BlockingCause, background: Background, alarm: AlarmCosts
) -> BlockingCause:
    """The cause with a call of the alarm for each background thread that waits for a time."""
    calls = background.alarm_cycles(alarm)
    if not calls:
        return cause
    names = ", ".join(task.name for task, _ in background.threads)
    kind = f"{cause.kind}, and the alarm called once for {names}"
    return BlockingCause(cause.cycles + calls, cause.task or names, kind)


def _after_others(cause: BlockingCause, masked_cycles: dict[str, int]) -> BlockingCause:
    """The cause at the end of the masked services of other tasks."""
    before = sum(cycles for task, cycles in masked_cycles.items() if task != cause.task)
    if not cause.task or not before:
        return cause
    kind = f"{cause.kind}, after others masked interrupts"
    return BlockingCause(cause.cycles + before, cause.task, kind)


def _scheduled_tasks(timings: Sequence[TaskTiming], facts: Facts) -> list[ScheduledTask]:
    found = []
    for timing in timings:
        task = timing.task
        clocked = DELAY_UNTIL in timing.job.released_by
        together = clocked and task.name.lower() in facts.together
        found.append(
            ScheduledTask(
                name=task.name,
                period=exact_cycles(task.period_us or 0),
                deadline=exact_cycles(task.deadline_us or task.period_us or 0),
                wcet=timing.job.cycles + timing.suspension_cycles,
                priority=task.priority,
                release="cyclic" if clocked else "sporadic",
                phase=0 if together else None,
                blocking=timing.blocking.cycles * (1 + timing.suspension_count),
            )
        )
    return found


def _second_releases(
    timings: Sequence[TaskTiming], tasks: Sequence[ScheduledTask]
) -> list[ScheduledTask]:
    """Tasks that stand for second releases in a period."""
    return [
        replace(task, name=f"{task.name}, second release", phase=None)
        for timing, task in zip(timings, tasks, strict=True)
        if timing.releases > 1
    ]


def _outside_code(jobs: Sequence[tuple[Task, Bound]], facts: Facts) -> dict[str, ScheduledTask]:
    """Tasks that stand for code without a deadline, by the name of the task that executes it and
    that does not meet it: its jobs are released after that code."""
    found = {}
    for task, job in jobs:
        loads = facts.outside_of(task.name)
        if loads and job.outside_cycles:
            found[task.name] = ScheduledTask(
                name=f"{task.name}, outside of jobs",
                period=exact_cycles(min(load.period_us for load in loads)),
                wcet=job.outside_cycles,
                priority=task.priority,
            )
    return found


def _never_waiting(background: Background) -> list[ScheduledTask]:
    """Threads that take all the time there is: more than a processor has."""
    period = exact_cycles(ENDLESS_PERIOD_US)
    return [
        ScheduledTask(task.name, period, 2 * period, task.priority, release="sporadic")
        for task, _ in background.never_waiting
    ]


def periods_us(tasks: Sequence[Task]) -> list[int]:
    """Periods of the cyclic tasks, in microseconds."""
    return [task.period_us for task in tasks if task.release == "cyclic" and task.period_us]


def _alarms_inside(
    timings: Sequence[TaskTiming], alarm: AlarmCosts, priority: int
) -> list[ScheduledTask]:
    """The alarm's calls for tasks that also wait for a time inside their jobs."""
    return [
        ScheduledTask(
            f"alarm inside {timing.task.name}",
            exact_cycles(timing.task.period_us or 0),
            timing.suspension_count * (alarm.first + alarm.early),
            priority,
            release="interrupt",
        )
        for timing in timings
        if timing.suspension_count and DELAY_UNTIL in timing.job.reached
    ]


def scheduled_bounds(
    blocking: InterruptBlocking,
    alarm: AlarmCosts,
    background: Background,
    transfers: Sequence[ScheduledTask],
    facts: Facts,
    executions: Executions,
    change: Change | None = None,
) -> Scheduled:
    """The tasks with their blocking and bounds. With a change of tasks, bounds are no closer than
    is needed to tell whether all deadlines are met."""
    jobs, dispatch, changed = executions.jobs, executions.dispatch, change or (lambda task: task)
    costs, kernel = blocking.handlers, blocking.kernel
    below = [*jobs, *background.all_threads]

    def cause(
        task: Task,
        absent: frozenset[str] = frozenset(),
        ended: frozenset[str] = frozenset(),
    ) -> BlockingCause:
        present = [(other, job) for other, job in below if other.name not in absent]
        found = blocking_cause(task.priority, task.name, present, kernel, ended)
        return _in_background(found, background, alarm)

    timings = tuple(
        TaskTiming(task, job, *suspension_of(facts, task, job), cause(task)) for task, job in jobs
    )
    overheads = alarm.overheads(kernel)
    level = costs[0].handler.priority
    calls = background.alarm_cycles(alarm)

    def longest_blocking(priority: int) -> int:
        return blocking.longest_cycles(priority, below) + calls

    interrupts = scheduled_interrupts(
        costs, facts, periods_us([t for t, _ in jobs]), longest_blocking
    )
    interrupts += expiries(blocking.events, alarm, longest_blocking(level))
    interrupts += _alarms_inside(timings, alarm, level)
    interrupts += transfers
    outside = _outside_code(jobs, facts)
    tasks = [changed(task) for task in _scheduled_tasks(timings, facts)]
    more = [*_second_releases(timings, tasks), *_never_waiting(background)]
    task_set = TaskSet((*map(changed, (*interrupts, *outside.values())), *tasks, *more))
    stands_in = {task.name for task in outside.values()}
    every = response_time_bounds(task_set, overheads)
    bounds = {b.task.name: b for b in every if b.task.name not in stands_in}
    sets, kinds = {}, _job_kinds(executions, facts, tasks, changed)
    for timing in sorted(timings, key=lambda each: -each.task.priority):
        special = interrupts_seen_by(timing.task.name, interrupts, costs, facts)
        others = _seen_by(timing, timings, tasks, bounds, changed)
        met = [*phased_in_jobs(timing, timings, others or tasks, facts), *more]
        met = [
            task if task.name == timing.task.name else _in_turn(_paying(task, dispatch), kinds)
            for task in met
        ]
        beside = {
            name: _paying(changed(task), dispatch)
            for name, task in outside.items()
            if name != timing.task.name
        }
        met = [task for task in met if not _stands_for(beside.get(task.name), task, timing)]
        seen = TaskSet((*map(changed, special or interrupts), *beside.values(), *met))
        sets[timing.task.name] = seen
        if special is not None or others is not None or dispatch or outside:
            own = seen.task(timing.task.name)
            bounds[own.name] = response_time_bound(seen, own, overheads)
    suspended = any(timing.suspension_count for timing in timings)
    enough = change is not None and all(bound.meets_deadline for bound in bounds.values())
    if facts.together and not more and not suspended and not enough:
        requests = requests_of(facts, costs, below)
        known = Known({}, requests, kinds=kinds)
        given = (bounds, known, cause)
        timings, closer = with_common_release(timings, sets, overheads, *given, change is None)
        bounds |= closer
    return Scheduled(timings, task_set, overheads, bounds)


def _paying(task: ScheduledTask, dispatch: int) -> ScheduledTask:
    """A task whose release makes a less urgent one give the processor away."""
    return replace(task, wcet=task.wcet + dispatch)


def _stands_for(outside: ScheduledTask | None, task: ScheduledTask, timing: TaskTiming) -> bool:
    """Is what a task executes outside of its jobs no shorter than these for one that is no more
    urgent? A release is of one or the other, and the next one no sooner than the period of that
    code, so it alone delays no less than both."""
    if outside is None or task.priority < timing.task.priority:
        return False
    return outside.wcet >= task.wcet and outside.period <= task.period


def with_common_release(
    timings: tuple[TaskTiming, ...],
    sets: Mapping[str, TaskSet],
    overheads: Overheads,
    bounds: dict[str, ResponseTimeBound],
    known: Known,
    cause: Callable[[Task, frozenset[str], frozenset[str]], BlockingCause],
    closest: bool = True,
) -> tuple[tuple[TaskTiming, ...], dict[str, ResponseTimeBound]]:
    """Closer bounds of tasks that keep a common release, with the blocking that they meet.

    `sets` are the tasks and interrupts as each task meets them, `cause` the blocking of a task by
    less urgent ones without those of some names, and without sections of others. Bounds tell when a
    job is over, so closer ones make those of the second round closer still; unless the closest are
    wanted, one round is enough in which all deadlines are met.
    """
    tasks = {timing.task.name: timing.task for timing in timings}
    causes: dict[tuple[str, object], BlockingCause] = {}

    def blocking(task: ScheduledTask, absent: frozenset[str], ended: frozenset[str]) -> int:
        met = cause(tasks[task.name], absent, ended)
        causes[task.name, met.cycles] = met
        return met.cycles

    found: dict[str, ResponseTimeBound] = {}
    for _ in range(ROUNDS):
        before = known.responses
        responses = {name: bound.bound for name, bound in (bounds | found).items()}
        enough = not closest and found and all(b.meets_deadline for b in found.values())
        if responses == before or enough:
            break
        known = replace(known, responses=responses, blocking=blocking)
        for name, seen in sets.items():
            found[name] = phased_response_time_bound(seen, seen.task(name), overheads, known)

    def blocked_by(timing: TaskTiming) -> BlockingCause:
        terms = found[timing.task.name].terms
        time = None if terms is None else terms.blocking.time
        return causes.get((timing.task.name, time), timing.blocking)

    return tuple(replace(timing, blocking=blocked_by(timing)) for timing in timings), found


def _job_kinds(
    executions: Executions, facts: Facts, tasks: Sequence[ScheduledTask], change: Change
) -> dict[str, tuple[JobKind, ...]]:
    """Kinds by task, as others meet them; interrupts as shares of the burst that stands for their
    source."""
    by_name = {task.name: task for task in tasks}
    found: dict[str, tuple[JobKind, ...]] = {}
    for kind, cycles, turns in executions.kinds:
        most = tuple(
            (source_name(source), exact(Fraction(at_most, facts.loads(source)[0].at_most)))
            for source, at_most in kind.most
            if facts.loads(source)
        )
        longest, *each = (
            change(replace(by_name[kind.task], wcet=wcet)).wcet + executions.dispatch
            for wcet in (cycles, *turns)
        )
        found[kind.task] = (*found.get(kind.task, ()), JobKind(longest, most, tuple(each)))
    return found


def _in_turn(task: ScheduledTask, kinds: Mapping[str, Sequence[JobKind]]) -> ScheduledTask:
    """A task as others meet it, with the longest of its kinds in each turn of its jobs."""
    turns = [kind.turns for kind in kinds.get(task.name, ())]
    if task.phase is None or not turns or not all(turns):
        return task
    longest = (min(task.wcet, max(each)) for each in zip(*turns, strict=True))
    return replace(task, turns=tuple(longest))


def requests_of(
    facts: Facts, costs: Sequence[InterruptCost], jobs: Sequence[tuple[Task, Bound]]
) -> tuple[Request, ...]:
    """Who requests interrupts; left out where a handler of another source may request them too."""
    found = []
    for number, fact in enumerate(facts.requests):

        def calls(bound: Bound, begin: str = fact.begin) -> bool:
            return any(symbol.startswith(begin) for symbol in bound.reached)

        others = (cost.body for cost in costs if cost.handler.source != fact.source)
        tasks = tuple(task.name for task, job in jobs if calls(job))
        if tasks and not any(calls(body) for body in others):
            name, lasts = source_name(fact.source), exact_cycles(fact.lasts_us)
            rest = tuple(
                (task.name, remaining + job.longest_critical_section(2 * task.priority))
                for task, job in jobs
                if (remaining := _remaining(facts, task, job, number)) is not None
            )
            found += [Request(each, tasks, lasts, rest) for each in (name, f"{name} transfers")]
    return tuple(found)


def _remaining(facts: Facts, task: Task, job: Bound, request: int) -> int | None:
    """Most cycles of a job from its first request to its end; None for a task that may request
    otherwise too, or that lets others of its priority run."""
    found = job.remaining[request] if job.remaining else None
    otherwise = task.release != "cyclic" or facts.outside_of(task.name) or YIELD in job.reached
    if found is None or otherwise:
        return None
    return min(found, job.cycles)


def phased_in_jobs(
    timing: TaskTiming,
    timings: Sequence[TaskTiming],
    tasks: Sequence[ScheduledTask],
    facts: Facts,
) -> list[ScheduledTask]:
    """The tasks as one of them meets those that keep the common release in their jobs only.

    Its own jobs come after its other code. That of a task which is no less urgent delays it at any
    time: as code outside of jobs, if that is stated. That of a less urgent one may block it at any
    time. A task with another period (for margins) need not fit the common release.
    """
    found = []
    for other, task in zip(timings, tasks, strict=True):
        after_us = facts.in_jobs.get(task.name.lower())
        stated = other.task.priority >= timing.task.priority and facts.outside_of(task.name)
        kept = task.release == "cyclic" and task.period == exact_cycles(other.task.period_us or 0)
        if after_us is not None and kept and (other is timing or stated):
            task = replace(task, phase=exact_cycles(after_us))
        found.append(task)
    return found


def _seen_by(
    timing: TaskTiming,
    timings: Sequence[TaskTiming],
    tasks: Sequence[ScheduledTask],
    bounds: dict[str, ResponseTimeBound],
    changed: Change,
) -> list[ScheduledTask] | None:
    """The tasks as a less urgent one sees those that suspend themselves; None without any.

    A job that suspends itself delays it by no more than its execution if it is taken to be
    released with a jitter of its response time less its execution, given that it ends before its
    next release (Chen et al. 2019, section 4.2).
    """
    found, special = [], False
    for other, task in zip(timings, tasks, strict=True):
        bound = bounds[task.name].bound
        more_urgent = other.task.priority > timing.task.priority
        if more_urgent and other.suspension_cycles and bound is not None and bound <= task.period:
            own = changed(replace(task, wcet=other.job.cycles)).wcet
            found.append(replace(task, wcet=own, release_jitter=max(0, bound - own)))
            special = True
        else:
            found.append(task)
    return found if special else None
