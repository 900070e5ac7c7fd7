# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The task set of a project with execution times from its binary, and its response-time bounds.

Times are in cycles. Jobs that wait for something inside are charged the longest wait as if it
were execution, which is sound for them and for less urgent tasks (Chen et al. 2019, section 4.1),
and may be blocked once more each time they go on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot, Task
from ravenbrick.schedule.model import Overheads, TaskSet
from ravenbrick.schedule.model import Task as ScheduledTask
from ravenbrick.schedule.quantity import exact
from ravenbrick.schedule.response_time import ResponseTimeBound, response_time_bounds
from ravenbrick.timing.alarm import AlarmCosts, alarm_costs, coarse_alarm
from ravenbrick.timing.bounds import (
    Bound,
    ExecutionTimeError,
    execution_times,
)
from ravenbrick.timing.events import (
    EventCost,
    event_costs,
    event_count,
    handlers_of_events,
)
from ravenbrick.timing.facts import (
    TIMING_FILE,
    EventLoad,
    Facts,
    InterruptLoad,
    Mode,
    TransferLoad,
    annotations_of,
)
from ravenbrick.timing.ipet import longest_path
from ravenbrick.timing.kernel import (
    DELAY_UNTIL,
    ENTRY_CALL,
    SUSPEND,
    InterruptCost,
    Services,
    expiry_facts,
    interrupt_costs,
    run_time_facts,
    services,
)
from ravenbrick.timing.masked import Masking, masking
from ravenbrick.timing.source_facts import source_facts
from ravenbrick.timing.started import (
    ALARM_SOURCE,
    ENVIRONMENT,
    ProtectedObject,
    attached_handlers,
    main_rests,
)
from ravenbrick.trace.interrupts import source_name
from ravenbrick.trace.task_set import check_names

__all__ = [
    "PREEMPTION_BYTES",
    "Analysis",
    "BlockingCause",
    "ModeBounds",
    "TaskTiming",
    "analyse",
    "blocking_cause",
    "body_of",
    "known_facts",
]

PREEMPTION_BYTES = 68
# By one transfer of the data controller, by timing profile (`pdc_steal_cycles`).
STOLEN_CYCLES = {"optimistic": 1, "nominal": 1, "pessimistic": 4}
WAITS = {"cyclic": (DELAY_UNTIL,), "sporadic": (ENTRY_CALL, SUSPEND)}


@dataclass(frozen=True)
class BlockingCause:
    """What may block a job once: a protected action or masked interrupts of `task`."""

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
    def stack_bound_bytes(self) -> int | None:
        """Deepest stack, with what a preemption saves."""
        deepest = self.job.stack_bytes
        return None if deepest is None else deepest + PREEMPTION_BYTES


@dataclass(frozen=True)
class ModeBounds:
    """Bounds that hold in one mode, by the task's name; cycles."""

    mode: Mode
    jobs: dict[str, int]
    bounds: dict[str, ResponseTimeBound]


@dataclass(frozen=True)
class Analysis:
    """Everything that is known before the run."""

    tasks: tuple[TaskTiming, ...]
    interrupts: tuple[InterruptCost, ...]
    objects: tuple[ProtectedObject, ...]
    services: Services
    task_set: TaskSet
    overheads: Overheads
    bounds: dict[str, ResponseTimeBound]
    modes: tuple[ModeBounds, ...] = ()
    events: tuple[EventCost, ...] = ()
    transfers: tuple[str, ...] = ()

    @property
    def schedulable(self) -> bool:
        """Whether all tasks and interrupts meet their deadlines."""
        return all(bound.meets_deadline for bound in self.bounds.values())

    def stolen_cycles(self, task: str) -> int:
        """What the data controller takes at most until a job of the task ends."""
        terms = self.bounds[task].terms
        parts = () if terms is None else terms.interference
        return math.ceil(sum(part.time for part in parts if part.task in self.transfers))

    @property
    def interrupt_stack_bytes(self) -> int | None:
        """Deepest handlers' stack: one handler of each level at the same time."""
        by_level: dict[int, int] = {}
        called = [(cost.handler.priority, cost.stack_bytes) for cost in self.interrupts]
        called += [(event.handler.priority, event.stack_bytes) for event in self.events]
        for level, stack_bytes in called:
            if stack_bytes is None:
                return None
            by_level[level] = max(by_level.get(level, 0), stack_bytes)
        return sum(by_level.values())


def body_of(image: ElfImage, facts: Facts, task: Task) -> str:
    """Symbol of a task's body. Raises `ExecutionTimeError` when it cannot be told."""
    named = dict(facts.bodies).get(task.name.lower())
    if named is not None:
        return named
    end = f"__{task.name.lower()}TKB"
    found = sorted(name for name in image.symbols if name.endswith(end))
    if len(found) == 1:
        return found[0]
    raise ExecutionTimeError(
        f"the image has {len(found)} bodies for the task '{task.name}'; name the subprogram in "
        f'{TIMING_FILE}: [[body]] task = "{task.name}", symbol = "..."'
    )


def _check_tasks(robot: Robot, image: ElfImage, brick: Any) -> None:
    """Tasks of robot.toml and of the image are the same, and the main procedure does nothing: what
    is left out would not be counted."""
    known = [thread.name.lower() for thread in brick.threads()]
    check_names(robot, known)
    for name in known:
        if name != ENVIRONMENT and robot.task(name) is None:
            raise robot.document.error(
                ("tasks", len(robot.tasks) - 1),
                f"the image has a task '{name}', which is missing here; add it: its jobs and its "
                "protected actions hold up others",
            )
    if robot.task(ENVIRONMENT) is None and not main_rests(brick):
        raise ExecutionTimeError(
            f"{image.path}: the main procedure goes on beside the tasks, and no bound counts what "
            "it does; move its work into a task and end it with 'delay until "
            "Ada.Real_Time.Time_Last;'"
        )


def _check_ceilings(robot: Robot, job: Bound, task: Task, index: int, objects: Any) -> None:
    for urgency, _ in job.sections:
        if urgency < 2 * task.priority:
            names = ", ".join(o.name for o in objects if o.urgency == urgency)
            raise robot.document.error(
                ("tasks", index, "priority"),
                f"is {task.priority}, but the task may call the protected object {names}, whose "
                f"ceiling is {urgency // 2}; raise the ceiling or lower the task",
            )


def _suspension(facts: Facts, task: Task, job: Bound) -> tuple[int, int]:
    waits = {ENTRY_CALL, SUSPEND, DELAY_UNTIL} - set(WAITS[task.release])
    waiting = sorted(waits & job.reached)
    said = facts.suspension(task.name)
    if said is not None:
        return MASTER_CLOCK.cycles_of_us(said.longest_us), said.count
    if waiting:
        raise ExecutionTimeError(
            f"a job of '{task.name}' may wait in {waiting[0]}; say in {facts.name} for how long at "
            f'most: [[suspension]] task = "{task.name}", longest_us = ..., reason = "..."'
        )
    return 0, 0


def blocking_cause(
    priority: int, name: str, jobs: Sequence[tuple[Task, Bound]], costs: Services
) -> BlockingCause:
    """The longest that less urgent tasks go on without letting this priority in.

    One of them may be in a protected action or a masked service. Each of the others may add a
    masked service: it gave the processor away with interrupts masked to a thread that was
    interrupted just as it masked them (`masked.Masking`).
    """
    found, masked_cycles = [BlockingCause(0, "", "none")], {}
    for task, job in jobs:
        if task.priority < priority and task.name != name:
            section = job.longest_section(2 * priority)
            found.append(BlockingCause(section, task.name, "protected action"))
            masked, service = costs.longest_masked(job.reached)
            found.append(BlockingCause(masked, task.name, f"interrupts masked in {service}"))
            masked_cycles[task.name] = costs.going_on_masked(job.reached)
    return max((_after_others(cause, masked_cycles) for cause in found), key=lambda c: c.cycles)


def _after_others(cause: BlockingCause, masked_cycles: dict[str, int]) -> BlockingCause:
    """The cause at the end of the masked services of other tasks."""
    before = sum(cycles for task, cycles in masked_cycles.items() if task != cause.task)
    if not cause.task or not before:
        return cause
    kind = f"{cause.kind}, after others masked interrupts"
    return BlockingCause(cause.cycles + before, cause.task, kind)


def _cycles(microseconds: int) -> Any:
    return exact(microseconds * MASTER_CLOCK.hertz / 1_000_000)


def _scheduled_tasks(timings: Sequence[TaskTiming]) -> list[ScheduledTask]:
    found = []
    for timing in timings:
        task = timing.task
        found.append(
            ScheduledTask(
                name=task.name,
                period=_cycles(task.period_us or 0),
                deadline=_cycles(task.deadline_us or task.period_us or 0),
                wcet=timing.job.cycles + timing.suspension_cycles,
                priority=task.priority,
                release="cyclic" if task.release == "cyclic" else "sporadic",
                blocking=timing.blocking.cycles * (1 + timing.suspension_count),
            )
        )
    return found


def _periods_us(tasks: Sequence[Task]) -> list[int]:
    return [task.period_us for task in tasks if task.release == "cyclic" and task.period_us]


def _scheduled_interrupts(
    masks: Masking,
    facts: Facts,
    jobs: Sequence[tuple[Task, Bound]],
) -> list[ScheduledTask]:
    found, costs = [], masks.handlers
    for cost in costs:
        source = cost.handler.source
        if source == ALARM_SOURCE:
            continue
        loads = facts.loads(source)
        if not loads:
            name = source_name(source)
            raise ExecutionTimeError(
                f"{cost.handler.symbol} handles {name}: say in {facts.name} how often it comes at "
                f'most: [[interrupt]] source = "{name}", at_most = ..., window_us = ..., '
                'reason = "..."'
            )
        found.append(_interrupt(cost, loads, masks.waiting(cost.handler.priority, jobs)))
    periods = _periods_us([task for task, _ in jobs])
    alarm = next(cost for cost in costs if cost.handler.source == ALARM_SOURCE)
    return [*found, *coarse_alarm(periods, alarm.cycles, alarm.handler.priority)]


def _interrupt(cost: InterruptCost, loads: Sequence[InterruptLoad], blocking: int) -> ScheduledTask:
    name, level = source_name(cost.handler.source), cost.handler.priority
    return _bursts(name, cost.cycles, level, loads, blocking)


def _bursts(
    name: str,
    cycles: int,
    priority: int,
    loads: Sequence[InterruptLoad] | Sequence[EventLoad] | Sequence[TransferLoad],
    blocking: int,
    release_jitter: int = 0,
) -> ScheduledTask:
    """Calls of a handler, or transfers, the longest window first."""
    load, *shorter = loads
    limits = [(Fraction(s.at_most, load.at_most), _cycles(s.window_us)) for s in shorter]
    return ScheduledTask(
        name=name,
        period=_cycles(load.window_us),
        limits=tuple(limits),
        wcet=load.at_most * cycles,
        priority=priority,
        release="interrupt",
        blocking=blocking,
        release_jitter=release_jitter,
    )


def _transfers(image: ElfImage, masks: Masking, facts: Facts) -> list[ScheduledTask]:
    """Cycles that the data controller takes, whatever the processor executes, also while the alarm
    is late (the tasks' release jitter): data sheet 6175M, chapters PDC and memory controller."""
    first = 1 + max(cost.handler.priority for cost in masks.handlers)
    late, cycles = masks.kernel.release_jitter, STOLEN_CYCLES[masks.kernel.timing]
    return [
        _bursts(f"{peripheral} transfers", cycles, first, loads, 0, late)
        for peripheral, loads in facts.transfer_loads(image).items()
    ]


def _expiries(events: Sequence[EventCost], alarm: AlarmCosts, blocking: int) -> list[ScheduledTask]:
    """Timing events: each a call of the alarm, and an early one before."""
    return [
        _bursts(
            event.name,
            event.cycles + alarm.early,
            event.handler.priority,
            event.loads,
            blocking,
        )
        for event in events
    ]


def _waits_inside(
    timings: Sequence[TaskTiming], alarm: AlarmCosts, priority: int
) -> list[ScheduledTask]:
    """The alarm's calls for sporadic tasks that also wait for a time inside their jobs."""
    return [
        ScheduledTask(
            f"alarm inside {timing.task.name}",
            _cycles(timing.task.period_us or 0),
            timing.suspension_count * (alarm.first + alarm.early),
            priority,
            release="interrupt",
        )
        for timing in timings
        if timing.suspension_count
        and timing.task.release == "sporadic"
        and DELAY_UNTIL in timing.job.reached
    ]


def _timed_tasks(robot: Robot) -> list[tuple[int, Task]]:
    found = []
    for index, task in enumerate(robot.tasks):
        if task.release == "background":
            raise robot.document.error(
                ("tasks", index, "release"),
                "is 'background'; tasks that are never released again are not analysed: give it a "
                "period",
            )
        found.append((index, task))
    return found


def _solved(
    image: ElfImage, facts: Facts, annotations: Sequence[tuple[str, str]], timing: str
) -> list[tuple[str, str]]:
    """Costs of the functions for which there are facts about their paths."""
    costs: list[dict[str, Any]] = []
    for symbol in sorted({fact.symbol for fact in facts.flows}):
        known = ("longest paths", annotations_of({"cost": costs}))
        found = execution_times(
            image.content,
            functions=[symbol],
            annotations=[*annotations, known],
            graphs=True,
            timing=timing,
        ).functions[0]
        own = [fact for fact in facts.flows if fact.symbol == symbol]
        cycles = longest_path(found.graph or {}, own)
        costs.append({"symbol": symbol, "cycles": min(cycles, found.cycles)})
    return [("longest paths", annotations_of({"cost": costs}))] if costs else []


def _stack_bytes(
    image: ElfImage,
    question: tuple[str, Sequence[str]],
    annotations: Sequence[tuple[str, str]],
) -> int | None:
    """Deepest stack of a task with all it calls, also outside of its jobs."""
    try:
        found = execution_times(image.content, jobs=[question], annotations=annotations).jobs
    except ExecutionTimeError:
        return None
    return found[0].stack_bytes


def known_facts(
    robot: Robot, image: ElfImage, facts: Facts, expiring: Sequence[str] = ()
) -> tuple[tuple[ProtectedObject, ...], list[tuple[str, str]]]:
    """The program's protected objects, and the annotations of its code: the project's own come
    first."""
    queued = len(robot.tasks) + 1 + event_count(image)
    objects, known = run_time_facts(image, queued, expiring)
    own = (facts.name, facts.annotations)
    return objects, [own, *facts.shared, *source_facts(image), *known]


def analyse(
    robot: Robot, image: ElfImage, brick: Any, facts: Facts, timing: str = "nominal"
) -> Analysis:
    """Bounds of all tasks and interrupts of an image; `brick` has elaborated it. `timing` is a
    profile of the timing that no document fixes (docs/reference/timing.md).

    Raises `ExecutionTimeError` for what has no bound, `ProjectFileError` where robot.toml and the
    image disagree.
    """
    _check_tasks(robot, image, brick)
    attached = attached_handlers(brick, image)
    expiring = handlers_of_events(image, attached)
    objects, annotations = known_facts(robot, image, facts, expiring)
    tasks = _timed_tasks(robot)
    annotations += _solved(image, facts, annotations, timing)
    kernel = services(image, annotations, timing)
    releasing = [expiry_facts(()), *annotations] if expiring else annotations
    costs = interrupt_costs(image, attached, releasing, timing)
    alarm = alarm_costs(image, costs[0], releasing, _periods_us([task for _, task in tasks]))
    events = event_costs(image, costs[0], expiring, facts, annotations)
    questions = [(body_of(image, facts, task), WAITS[task.release]) for _, task in tasks]

    def bounded(more: Sequence[tuple[str, str]]) -> list[tuple[Task, Bound]]:
        places = (f"{facts.name}, [[outside]]", facts.outside)
        known = [*annotations, places, *more]
        found = execution_times(
            image.content, jobs=questions, annotations=known, timing=timing
        ).jobs
        return [(task, job) for (_, task), job in zip(tasks, found, strict=True)]

    jobs = bounded(())
    if facts.outside:
        stacks = [_stack_bytes(image, one, annotations) for one in questions]
        jobs = [(t, replace(j, stack_bytes=s)) for (t, j), s in zip(jobs, stacks, strict=True)]
    for index, (task, job) in enumerate(jobs):
        _check_ceilings(robot, job, task, index, objects)
    masks = masking(image, costs, events, kernel, releasing)
    transfers = _transfers(image, masks, facts)
    modes = []
    for mode in facts.modes:
        in_mode = bounded([(f"{facts.name}, mode '{mode.name}'", mode.annotations)])
        rates = replace(facts, interrupts=(*facts.interrupts, *mode.interrupts))
        timings, _, _, bounds = _scheduled(masks, alarm, rates, in_mode, transfers)
        modes.append(ModeBounds(mode, {t.task.name: t.job.cycles for t in timings}, bounds))
    timings, task_set, overheads, bounds = _scheduled(masks, alarm, facts, jobs, transfers)
    return Analysis(
        timings,
        costs,
        objects,
        kernel,
        task_set,
        overheads,
        bounds,
        tuple(modes),
        events,
        tuple(task.name for task in transfers),
    )


def _scheduled(
    masks: Masking,
    alarm: AlarmCosts,
    facts: Facts,
    jobs: Sequence[tuple[Task, Bound]],
    transfers: Sequence[ScheduledTask],
) -> tuple[tuple[TaskTiming, ...], TaskSet, Overheads, dict[str, ResponseTimeBound]]:
    costs, kernel = masks.handlers, masks.kernel
    timings = tuple(
        TaskTiming(
            task,
            job,
            *_suspension(facts, task, job),
            blocking_cause(task.priority, task.name, jobs, kernel),
        )
        for task, job in jobs
    )
    overheads = alarm.overheads(kernel)
    level = costs[0].handler.priority
    interrupts = _scheduled_interrupts(masks, facts, jobs)
    interrupts += _expiries(masks.events, alarm, masks.waiting(level, jobs))
    interrupts += _waits_inside(timings, alarm, level)
    interrupts += transfers
    tasks = _scheduled_tasks(timings)
    task_set = TaskSet((*interrupts, *tasks))
    bounds = {b.task.name: b for b in response_time_bounds(task_set, overheads)}
    for timing in timings:
        special = _interrupts_seen_by(timing.task.name, interrupts, costs, facts)
        if special is not None:
            seen = TaskSet((*special, *tasks))
            own = {b.task.name: b for b in response_time_bounds(seen, overheads)}
            bounds[timing.task.name] = own[timing.task.name]
    return timings, task_set, overheads, bounds


def _interrupts_seen_by(
    task: str,
    interrupts: Sequence[ScheduledTask],
    costs: Sequence[InterruptCost],
    facts: Facts,
) -> list[ScheduledTask] | None:
    """Interrupts as they come in windows from a task's releases on; None where nothing is said
    about these."""
    by_name = {source_name(cost.handler.source): cost for cost in costs}
    found, special = [], False
    for interrupt in interrupts:
        cost = by_name.get(interrupt.name)
        loads = () if cost is None else facts.loads(cost.handler.source, task)
        special |= bool(loads)
        found.append(_interrupt(cost, loads, 0) if cost and loads else interrupt)
    return found if special else None
