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

from ravenbrick.errors import DeadlineError
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot, Task
from ravenbrick.schedule.model import Overheads, TaskSet
from ravenbrick.schedule.offsets import Request
from ravenbrick.schedule.response_time import ResponseTimeBound
from ravenbrick.timing.bounds import (
    Bound,
    ExecutionTimeError,
    JobQuestion,
    execution_times,
    whole_task,
)
from ravenbrick.timing.dispatch.dispatching_calls import DISPATCH_TABLES, DispatchingCalls
from ravenbrick.timing.environment_stack import (
    NO_ENVIRONMENT,
    EnvironmentStack,
    environment_stack,
)
from ravenbrick.timing.facts.counted_facts import CountedFact, counted_facts
from ravenbrick.timing.facts.facts import TIMING_FILE, Facts, KindOfJob, Mode, annotations_of
from ravenbrick.timing.facts.source_facts import source_facts
from ravenbrick.timing.initial_state import (
    ENVIRONMENT,
    ProtectedObject,
    attached_handlers,
)
from ravenbrick.timing.ipet import longest_path
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
    endless_words,
    main_symbol,
)
from ravenbrick.timing.task_set.events import (
    EventCost,
    event_costs,
    event_count,
    handlers_of_events,
)
from ravenbrick.timing.task_set.interrupt_blocking import interrupt_blocking
from ravenbrick.timing.task_set.scheduled_interrupts import transfer_tasks
from ravenbrick.timing.task_set.scheduled_tasks import (
    WAITS,
    Change,
    Executions,
    Scheduled,
    TaskTiming,
    periods_us,
    requests_of,
    scheduled_bounds,
)
from ravenbrick.timing.task_set.suspension import joined_releases, with_operations
from ravenbrick.trace.task_set import check_names

__all__ = [
    "Analysis",
    "ModeBounds",
    "analyse",
    "body_of",
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
    kinds: tuple[tuple[KindOfJob, int], ...] = ()
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


def body_of(image: ElfImage, facts: Facts, task: Task) -> str:
    """Symbol of a task's body. Raises `ExecutionTimeError` when it cannot be told."""
    named = dict(facts.bodies).get(task.name.lower())
    if named is not None:
        return named
    if task.name == ENVIRONMENT:
        return main_symbol(image)
    end = f"__{task.name.lower()}TKB"
    found = sorted(name for name in image.symbols if name.endswith(end))
    if len(found) == 1:
        return found[0]
    raise ExecutionTimeError(
        f"the image has {len(found)} bodies for the task '{task.name}'; name the subprogram in "
        f'{TIMING_FILE}: [[body]] task = "{task.name}", symbol = "..."'
    )


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


def _jobs(
    image: ElfImage,
    facts: Facts,
    tasks: Sequence[Task],
    annotations: Sequence[tuple[str, str]],
    timing: str,
    more: Sequence[tuple[str, str]],
    paths: bool = False,
) -> list[tuple[Task, Bound]]:
    """Tasks with their jobs, under more annotations; with `paths`, also their worst paths."""

    def asked(questions: Sequence[JobQuestion]) -> tuple[Bound, ...]:
        known = [*annotations, *more]
        return execution_times(
            image.content, jobs=questions, annotations=known, timing=timing, paths=paths
        ).jobs

    bodies = [body_of(image, facts, task) for task in tasks]
    try:
        found = asked([(b, *WAITS[task.release]) for b, task in zip(bodies, tasks, strict=True)])
    except ExecutionTimeError as question:
        _check_endless(question, dict(zip(bodies, tasks, strict=True)))
        raise
    jobs = []
    for task, job, body in zip(tasks, found, bodies, strict=True):
        if facts.suspension(task.name) is None:
            job = joined_releases(task, job, body, lambda question: asked([question])[0])
        jobs.append((task, job))
    return jobs


def _check_endless(question: ExecutionTimeError, tasks: dict[str, Task]) -> None:
    """Whatever the answer to a question is, a task that stays in a loop misses its deadline.

    Raises `DeadlineError` for such a task."""
    for body, line in question.data.get("endless", {}).items():
        task = tasks[body]
        words = f"NOT schedulable: {endless_words(task, line, list(tasks.values()))}"
        raise DeadlineError(words, detail=f"{question}\n{question.detail}") from question


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


Kinds = Sequence[tuple[KindOfJob, Bound]]


def _kinds(
    image: ElfImage,
    facts: Facts,
    questions: Mapping[str, JobQuestion],
    timing: str,
    annotations: Sequence[tuple[str, str]],
    stated: Sequence[tuple[str, str]],
) -> Kinds:
    """Kinds of jobs with their bounds, and with their worst paths if nothing more is stated."""
    found = []
    for kind in facts.kinds:
        if kind.task not in questions:
            continue
        own = (f"{kind.file}, kind of job '{kind.name}'", kind.annotations)
        known = [*annotations, *stated, (f"{facts.name}, [[outside]]", facts.outside), own]
        jobs = [questions[kind.task]]
        times = execution_times(
            image.content, jobs=jobs, annotations=known, timing=timing, paths=not stated
        )
        found.append((kind, times.jobs[0]))
    return found


def _of_kinds(
    jobs: Sequence[tuple[Task, Bound]], kinds: Kinds, facts: Facts
) -> list[tuple[Task, Bound]]:
    """The jobs, each as the longest of its kinds. What a job that waits inside executes and waits
    is longest together, which its kinds do not tell."""
    found = []
    for task, job in jobs:
        own = [bound for kind, bound in kinds if kind.task == task.name]
        if own and task.release == "cyclic" and facts.suspension(task.name) is None:
            longest = max(own, key=lambda bound: bound.cycles)
            if longest.cycles < job.cycles:
                path, report = longest.path, longest.report
                job = replace(job, cycles=longest.cycles, path=path, report=report)
        found.append((task, job))
    return found


def _executions(
    facts: Facts,
    bounded: Callable[[Sequence[tuple[str, str]]], list[tuple[Task, Bound]]],
    kinds_of: Callable[[Sequence[tuple[str, str]]], Kinds],
    kernel: Services,
    jobs: Sequence[tuple[Task, Bound]],
    stated: Sequence[tuple[str, str]],
) -> list[Executions]:
    """Bounds of jobs with the ends of protected actions at which the processor is given away, and,
    if there are any, without them.

    There is at most one after each release of a more urgent task, so it is charged to that release
    or, wherever a job may execute it, to the job.
    """

    def executions(jobs: Sequence[tuple[Task, Bound]], kinds: Kinds, dispatch: int) -> Executions:
        each = [(kind, bound.cycles) for kind, bound in kinds]
        return Executions(_of_kinds(jobs, kinds, facts), each, dispatch)

    found = [executions(jobs, kinds_of(stated), 0)]
    if any(DISPATCH in job.reached for _, job in jobs):
        without = [*stated, no_cost(DISPATCH)]
        pairs = zip(jobs, bounded(without), strict=True)
        jobs = [(t, replace(job, cycles=min(job.cycles, s.cycles))) for (t, job), (_, s) in pairs]
        found.append(executions(jobs, kinds_of(without), kernel.dispatch))
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
    executions_of: Callable[[Sequence[tuple[str, str]]], Sequence[Executions]],
) -> tuple[ModeBounds, ...]:
    modes = []
    for mode in facts.modes:
        stated = [(facts.mode_file(mode.name), mode.annotations)]
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
    annotations += _solved(image, facts, annotations, timing)
    kernel = services(image, annotations, timing)
    releasing = [expiry_facts(()), *annotations] if expiring else annotations
    costs = interrupt_costs(image, attached, releasing, timing)
    alarm = alarm_costs(image, costs[0], releasing, periods_us(tasks))
    events = event_costs(image, costs[0], expiring, facts, annotations)
    background = background_of(
        robot, image, brick, partial(body_of, image, facts), annotations, timing
    )
    places = (f"{facts.name}, [[outside]]", facts.outside)
    bounded = partial(_jobs, image, facts, tasks, [*annotations, places], timing)
    jobs = bounded((), paths=True)
    stuck = [(task, job) for task, job in jobs if job.endless is not None]
    if stuck:
        background = background.with_never_waiting(stuck)
        tasks = [task for task, job in jobs if job.endless is None]
        bounded = partial(_jobs, image, facts, tasks, [*annotations, places], timing)
        jobs = [pair for pair in jobs if pair[0] in tasks]
    questions = [(body_of(image, facts, task), *WAITS[task.release]) for task in tasks]
    asked = dict(zip((task.name for task in tasks), questions, strict=True))
    kinds_of = partial(_kinds, image, facts, asked, timing)
    if facts.outside:
        whole = [whole_task(image.content, annotations, one) for one in questions]
        jobs = [(t, replace(j, **more)) for (t, j), more in zip(jobs, whole, strict=True)]
    environment = environment_stack(image, brick, annotations)
    jobs = [(task, environment.of_job(task.name, job)) for task, job in jobs]
    background = background.with_stacks(environment)
    for task, job in [*jobs, *background.all_threads]:
        _check_ceilings(robot, job, task, objects)
    facts = with_operations(facts, jobs, bounded)
    blocking = interrupt_blocking(image, costs, events, kernel, releasing)
    transfers = transfer_tasks(image, blocking, facts)
    of_facts = partial(scheduled_bounds, blocking, alarm, background, transfers)
    known = partial(kinds_of, annotations)
    executions_of = partial(_executions, facts, bounded, known, kernel)
    modes = _modes(facts, of_facts, lambda stated: executions_of(bounded(stated), stated))
    executions = executions_of(jobs, [])
    scheduled = partial(_scheduled, partial(of_facts, facts), executions)
    found = scheduled()
    roots = [body for body, _, _ in questions] + [cost.handler.symbol for cost in costs]
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
        _counted(image, roots, facts, annotations),
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
    annotations: Sequence[tuple[str, str]],
) -> tuple[CountedFact, ...]:
    """Facts of the project, the drivers and the sources, and targets in dispatch tables; then those
    of modes."""
    outside = f"{facts.name}, [[outside]]"
    files = {facts.name, outside, "pragma Annotate", DISPATCH_TABLES}
    files |= {name for name, _ in facts.shared}
    known = [*annotations, (outside, facts.outside)]
    found = counted_facts(image.content, roots, known, files)
    for mode in facts.modes:
        name = facts.mode_file(mode.name)
        stated = [*known, (name, mode.annotations)]
        more = counted_facts(image.content, roots, stated, {name})
        found += tuple(replace(fact, mode=mode.name) for fact in more)
    return found
