# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The task set of a project with execution times from its binary, and its response-time bounds.

Times are in cycles. Jobs that wait for something inside are charged the longest wait as if it
were execution, which is sound for them and for less urgent tasks (Chen et al. 2019, section 4.1),
and may be blocked once more each time they go on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot, Task
from ravenbrick.schedule.beginning import Request
from ravenbrick.schedule.model import Overheads, TaskSet
from ravenbrick.schedule.response_time import ResponseTimeBound
from ravenbrick.timing.bounds import (
    Bound,
    ExecutionTimeError,
    execution_times,
)
from ravenbrick.timing.dispatch.dispatching_calls import DISPATCH_TABLES, DispatchingCalls
from ravenbrick.timing.environment_stack import (
    NO_ENVIRONMENT,
    EnvironmentStack,
    environment_stack,
)
from ravenbrick.timing.facts.counted_facts import CountedFact, counted_facts, turn_facts
from ravenbrick.timing.facts.facts import Facts, KindOfJob, Mode, annotations_of
from ravenbrick.timing.facts.source_facts import source_facts
from ravenbrick.timing.initial_state import (
    ProtectedObject,
    attached_handlers,
    executed_bodies,
)
from ravenbrick.timing.ipet import flow_point, longest_path
from ravenbrick.timing.kernel import (
    DISPATCH,
    InterruptCost,
    Services,
    expiry_facts,
    interrupt_costs,
    no_cost,
    run_time_facts,
    services,
)
from ravenbrick.timing.task_set.alarm import alarm_costs
from ravenbrick.timing.task_set.background import (
    NO_BACKGROUND,
    Background,
    background_of,
)
from ravenbrick.timing.task_set.events import (
    EventCost,
    event_costs,
    event_count,
    handlers_of_events,
)
from ravenbrick.timing.task_set.interrupt_blocking import interrupt_blocking
from ravenbrick.timing.task_set.jobs import (
    Annotations,
    Jobs,
    JobsOfTasks,
    Kinds,
    body_of,
    longest_kinds,
)
from ravenbrick.timing.task_set.scheduled_interrupts import transfer_tasks
from ravenbrick.timing.task_set.scheduled_tasks import (
    Change,
    Executions,
    Scheduled,
    TaskTiming,
    periods_us,
    requests_of,
    scheduled_bounds,
)
from ravenbrick.timing.task_set.suspension import with_operations
from ravenbrick.trace.recording import ENVIRONMENT
from ravenbrick.trace.task_set import check_names

__all__ = [
    "Analysis",
    "ModeBounds",
    "analyse",
    "known_facts",
]


@dataclass(frozen=True)
class ModeBounds:
    """Bounds that hold in one mode, by the task's name; cycles."""

    mode: Mode
    jobs: dict[str, int]
    bounds: dict[str, ResponseTimeBound]


@dataclass(frozen=True)
class Analysis:
    """All bounds of an image, before any run; `changed_bounds` are those with changed tasks,
    `outside` the tasks with jobs without a deadline."""

    tasks: tuple[TaskTiming, ...]
    interrupts: tuple[InterruptCost, ...]
    objects: tuple[ProtectedObject, ...]
    services: Services
    task_set: TaskSet
    overheads: Overheads
    bounds: dict[str, ResponseTimeBound]
    changed_bounds: Callable[[Change], Mapping[str, ResponseTimeBound]]
    modes: tuple[ModeBounds, ...] = ()
    events: tuple[EventCost, ...] = ()
    transfers: tuple[str, ...] = ()
    background: Background = NO_BACKGROUND
    counted: tuple[CountedFact, ...] = ()
    handlers_stack_bytes: int = 0
    environment: EnvironmentStack = NO_ENVIRONMENT
    requests: tuple[Request, ...] = ()
    kinds: tuple[tuple[KindOfJob, int, tuple[int, ...]], ...] = ()
    outside: frozenset[str] = frozenset()

    @property
    def schedulable(self) -> bool:
        """Whether all tasks and interrupts meet their deadlines."""
        return all(bound.meets_deadline for bound in self.bounds.values())

    def stolen_cycles(self, task: str) -> int:
        """Cycles that the data controller takes at most until a job of the task ends."""
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


def _check_tasks(robot: Robot, brick: Any) -> None:
    """Tasks of robot.toml and of the image are the same: what is left out would not be counted."""
    known = [thread.name.lower() for thread in brick.threads()]
    check_names(robot, known)
    for name in known:
        if name != ENVIRONMENT and robot.task(name) is None:
            raise robot.document.error(
                ("tasks", len(robot.tasks) - 1),
                f"the image has a task '{name}', which is missing here; add it: its jobs and its "
                "protected actions block others",
            )


def _check_ceilings(robot: Robot, job: Bound, task: Task, objects: Any) -> None:
    for urgency, _ in job.critical_sections:
        if urgency < 2 * task.priority:
            names = ", ".join(o.name for o in objects if o.urgency == urgency)
            declared = task in robot.tasks
            place = ("tasks", robot.tasks.index(task), "priority") if declared else ("tasks",)
            raise robot.document.error(
                place,
                f"the priority of {task.name} is {task.priority}, but it may call the protected "
                f"object {names}, whose ceiling is {urgency // 2}; raise the ceiling or lower the "
                "task",
            )


def _solved(
    image: ElfImage, facts: Facts, annotations: Annotations, timing: str
) -> tuple[list[tuple[str, str]], tuple[CountedFact, ...]]:
    """Costs of the functions for which there are facts about their paths, and what is counted of
    these."""
    costs: list[dict[str, Any]] = []
    counted = []
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
        graph = found.graph or {}
        costs.append({"symbol": symbol, "cycles": min(longest_path(graph, own), found.cycles)})
        for fact in own:
            text, place = f'{facts.name}: [[flow]] symbol = "{symbol}"', ", ".join(fact.lines)
            of_run = flow_point(graph, fact)
            counted.append(CountedFact(text, facts.name, "flow", place, fact.at_most, of_run))
    return [("longest paths", annotations_of({"cost": costs}))] if costs else [], tuple(counted)


def _handlers_stack_bytes(image: ElfImage) -> int:
    top, bottom = (image.symbols[f"ravenbrick_handler_stack{end}"] for end in ("_top", ""))
    return top.address - bottom.address


def known_facts(
    robot: Robot, image: ElfImage, facts: Facts, expiring: Sequence[str] = ()
) -> tuple[tuple[ProtectedObject, ...], list[tuple[str, str]]]:
    """The program's protected objects, and the annotations of its code: the project's own come
    first."""
    queued = len(robot.tasks) + 1 + event_count(image)
    objects, known = run_time_facts(image, queued, expiring)
    own = (facts.name, facts.annotations)
    devices = [port.device for port in robot.sensor_ports.values()]
    calls = DispatchingCalls(image.path, image.content).facts()
    return objects, [own, *facts.shared, *source_facts(image, devices), *known, calls]


def _executions(
    of_jobs: JobsOfTasks,
    facts: Facts,
    kernel: Services,
    jobs: Jobs,
    stated: Annotations,
) -> list[Executions]:
    """Bounds of jobs with the ends of protected actions at which the processor is given away, and,
    if there are any, without them.

    There is at most one after each release of a more urgent task, so it is charged to that release
    or, wherever a job may execute it, to the job.
    """

    def executions(jobs: Jobs, kinds: Kinds, dispatch: int) -> Executions:
        each = [(kind, bound.cycles, turns) for kind, bound, turns in kinds]
        return Executions(longest_kinds(jobs, kinds, facts), each, dispatch)

    found = [executions(jobs, of_jobs.kinds(stated), 0)]
    if any(DISPATCH in job.reached for _, job in jobs):
        without = [*stated, no_cost(DISPATCH)]
        pairs = zip(jobs, of_jobs.under(without, jobs), strict=True)
        jobs = [(t, replace(job, cycles=min(job.cycles, s.cycles))) for (t, job), (_, s) in pairs]
        found.append(executions(jobs, of_jobs.kinds(without), kernel.dispatch))
    return found


def _scheduled(
    of_executions: Callable[[Executions, Change | None], Scheduled],
    executions: Sequence[Executions],
    change: Change | None = None,
) -> Scheduled:
    """Bounds of the first executions, and for each task that of any other if it is closer. With a
    change, they are no closer than is needed to tell whether all deadlines are met."""
    others = (of_executions(each, change) for each in executions)
    found = next(others)
    for other in others:
        if change is not None and all(bound.meets_deadline for bound in found.bounds.values()):
            break
        names = [timing.task.name for timing in found.timings]
        better = {name for name in names if _is_less(other.bounds[name], found.bounds[name])}
        causes = {t.task.name: t.blocking for t in other.timings if t.task.name in better}
        timings = (replace(t, blocking=causes.get(t.task.name, t.blocking)) for t in found.timings)
        closer = found.bounds | {name: other.bounds[name] for name in better}
        found = replace(found, timings=tuple(timings), bounds=closer)
    return found


def _modes(
    facts: Facts,
    of_facts: Callable[[Facts, Executions, Change | None], Scheduled],
    executions_of: Callable[[Annotations], Sequence[Executions]],
) -> tuple[ModeBounds, ...]:
    modes = []
    for mode in facts.modes:
        stated = [(mode.title, mode.annotations)]
        rates = replace(facts, interrupts=(*facts.interrupts, *mode.interrupts))
        found = _scheduled(partial(of_facts, rates), executions_of(stated))
        in_mode = {t.task.name: t.job.cycles for t in found.timings}
        modes.append(ModeBounds(mode, in_mode, found.bounds))
    return tuple(modes)


def _is_less(one: ResponseTimeBound, other: ResponseTimeBound) -> bool:
    if one.bound is None or other.bound is None:
        return one.bound is not None
    return bool(one.bound < other.bound)


def analyse(
    robot: Robot, image: ElfImage, brick: Any, facts: Facts, timing: str = "nominal"
) -> Analysis:
    """Bounds of all tasks and interrupts of an image; `brick` has elaborated it. `timing` is a
    profile of the timing that no document fixes (docs/reference/timing.md).

    Raises `ExecutionTimeError` for what has no bound, `ProjectFileError` where robot.toml and the
    image disagree.
    """
    try:
        return _analyse(robot, image, brick, facts, timing)
    except ExecutionTimeError as question:
        DispatchingCalls(image.path, image.content).explain(question)
        raise


def _analyse(robot: Robot, image: ElfImage, brick: Any, facts: Facts, timing: str) -> Analysis:
    _check_tasks(robot, brick)
    facts = facts.of_image(image)
    attached = attached_handlers(brick, image)
    expiring = handlers_of_events(image, attached)
    objects, annotations = known_facts(robot, image, facts, expiring)
    tasks = [task for task in robot.tasks if task.release != "background"]
    solved, of_paths = _solved(image, facts, annotations, timing)
    annotations += solved
    kernel = services(image, annotations, timing)
    releasing = [expiry_facts(()), *annotations] if expiring else annotations
    costs = interrupt_costs(image, attached, releasing, timing)
    alarm = alarm_costs(image, costs[0], releasing, periods_us(tasks))
    events = event_costs(image, costs[0], expiring, facts, annotations)
    executed = executed_bodies(brick, image)
    background = background_of(
        robot, image, brick, partial(body_of, image, executed), annotations, timing
    )
    of_jobs = JobsOfTasks(image, facts, tasks, annotations, timing, executed)
    jobs = of_jobs.bounds(paths=True)
    stuck = [(task, job) for task, job in jobs if job.endless is not None]
    if stuck:
        background = background.with_never_waiting(stuck)
        tasks = [task for task, job in jobs if job.endless is None]
        of_jobs = replace(of_jobs, tasks=tasks)
        jobs = [pair for pair in jobs if pair[0] in tasks]
    jobs = of_jobs.with_outside(jobs)
    environment = environment_stack(image, brick, annotations)
    jobs = [(task, environment.of_job(task.name, job)) for task, job in jobs]
    background = background.with_stacks(environment)
    for task, job in [*jobs, *background.all_threads]:
        _check_ceilings(robot, job, task, objects)
    facts = with_operations(facts, jobs, of_jobs.bounds)
    blocking = interrupt_blocking(image, costs, events, kernel, releasing)
    transfers = transfer_tasks(image, blocking, facts)
    of_facts = partial(scheduled_bounds, blocking, alarm, background, transfers)
    executions_of = partial(_executions, of_jobs, facts, kernel)
    modes = _modes(
        facts,
        of_facts,
        lambda stated: executions_of(of_jobs.with_outside(of_jobs.under(stated, jobs)), stated),
    )
    executions = executions_of(jobs, [])
    scheduled = partial(_scheduled, partial(of_facts, facts), executions)
    found = scheduled()
    roots = [*of_jobs.bodies, *(cost.handler.symbol for cost in costs)]
    return Analysis(
        found.timings,
        costs,
        objects,
        kernel,
        found.task_set,
        found.overheads,
        found.bounds,
        lambda change: scheduled(change).bounds,
        modes,
        events,
        tuple(task.name for task in transfers),
        background,
        _counted(image, roots, facts, annotations) + of_paths,
        _handlers_stack_bytes(image),
        environment,
        requests_of(facts, costs, [*jobs, *background.all_threads]),
        tuple(executions[0].kinds),
        frozenset(task.name for task in tasks if facts.outside_of(task.name)),
    )


def _counted(
    image: ElfImage,
    roots: Sequence[str],
    facts: Facts,
    annotations: Annotations,
) -> tuple[CountedFact, ...]:
    """Facts of the project, the drivers and the sources, and targets in dispatch tables; then those
    of modes."""
    files = {facts.name, facts.of_jobs[0], "pragma Annotate", DISPATCH_TABLES}
    files |= {name for name, _ in facts.shared}
    known = [*annotations, facts.of_jobs]
    found = counted_facts(image.content, roots, known, files) + turn_facts(image, facts)
    for mode in facts.modes:
        stated = [*known, (mode.title, mode.annotations)]
        more = counted_facts(image.content, roots, stated, {mode.title})
        found += tuple(replace(fact, mode=mode.name) for fact in more)
    return found
