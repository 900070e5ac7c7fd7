# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The analysis and the run as plain data, and in words what to change."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.schedule.demand import window_of
from ravenbrick.schedule.sensitivity import ScalingLimit
from ravenbrick.timing.analysis import Analysis, ModeBounds
from ravenbrick.timing.bounds import recursion_words
from ravenbrick.timing.margins import largest_scaling, longest_execution, smallest_period
from ravenbrick.timing.observation.observed import Observed, ratio
from ravenbrick.timing.results.stacks import stack_lines, stacks_of, stacks_suffice
from ravenbrick.timing.task_set.background import endless_words
from ravenbrick.timing.task_set.scheduled_tasks import TaskTiming, deepest_stack
from ravenbrick.trace.interrupts import source_name
from ravenbrick.trace.recording import ENVIRONMENT

__all__ = ["advice", "microseconds", "result_of"]

ENOUGH = "all deadlines are met"


def microseconds(cycles: Any) -> float:
    """Cycles as microseconds."""
    return float(cycles * 1_000_000 / MASTER_CLOCK.hertz)


def _never_waiting(analysis: Analysis) -> list[dict[str, Any]]:
    """Threads that stay in a loop without a wait, with what they do in words."""
    timed = [timing.task for timing in analysis.tasks]
    return [
        {
            "name": task.name,
            "priority": task.priority,
            "line": bound.endless,
            "words": endless_words(task, bound.endless or "", timed),
        }
        for task, bound in analysis.background.never_waiting
    ]


def _scope(analysis: Analysis) -> list[str]:
    """What the bounds of the main procedure and of background tasks cover, in words."""
    found = [
        f"{task.name} runs in the background at priority {task.priority}: it delays others by "
        "critical sections only, and has neither a deadline nor a response bound"
        for task, _ in analysis.background.threads
    ]
    if any(timing.task.name == ENVIRONMENT for timing in analysis.tasks):
        found.append(
            f"the bounds of {ENVIRONMENT}'s jobs hold, and are compared with the run, from the "
            "first release of all tasks on; the time of the elaboration before has no bound"
        )
    found.append(
        f"the stack bound of {ENVIRONMENT} covers start-up, elaboration and main procedure"
    )
    return found


def _up(cycles: Any) -> int | None:
    return None if cycles is None else math.ceil(cycles)


def _terms(analysis: Analysis, timing: TaskTiming) -> dict[str, Any] | None:
    terms = analysis.bounds[timing.task.name].terms
    if terms is None:
        return None
    handlers = {t.name for t in analysis.task_set if t.release == "interrupt"}
    by_tasks = [p for p in terms.interference if p.task not in handlers]
    by_interrupts = [p for p in terms.interference if p.task in handlers]
    return {
        "own_cycles": _up(terms.own - timing.suspension_cycles),
        "suspension_cycles": timing.suspension_cycles,
        "interference_cycles": _up(sum(part.time for part in by_tasks)),
        "interrupts_cycles": _up(sum(part.time for part in by_interrupts)),
        "blocking_cycles": _up(terms.blocking.time),
        "overheads_cycles": _up(terms.overheads),
        "release_jitter_cycles": _up(terms.release_jitter),
        "interference": [
            {"task": part.task, "jobs": float(part.jobs), "cycles": _up(part.time)}
            for part in terms.interference
        ],
        "blocked_by": {"task": timing.blocking.task, "kind": timing.blocking.kind},
    }


def _task(
    analysis: Analysis,
    timing: TaskTiming,
    observed: tuple[Observed | None, Observed | None],
    left: Mapping[str, str] | None,
    margins: bool,
) -> dict[str, Any]:
    """Of what was `observed`, the second stands beside the bounds of modes."""
    (seen, undisturbed), name = observed, timing.task.name
    found = analysis.bounds[name]
    bound = _up(found.bound)
    limit, limited_by = longest_execution(analysis, name) if margins else (None, "")
    fastest = smallest_period(analysis, name) if margins else None
    return {
        "name": name,
        "priority": timing.task.priority,
        "period_us": timing.task.period_us,
        "deadline_us": timing.task.deadline_us or timing.task.period_us,
        "meets_deadline": found.meets_deadline,
        "execution_bound_cycles": timing.job.cycles,
        "recursions": recursion_words(timing.job.report),
        "execution_max_cycles": None
        if limit is None
        else math.floor(limit) - timing.suspension_cycles,
        "limited_by": limited_by,
        "smallest_period_us": None if fastest is None else round(microseconds(fastest)),
        "response_bound_cycles": bound,
        "terms": _terms(analysis, timing),
        "observed": None if seen is None else dict(vars(seen)),
        "ratio": None if seen is None or bound is None else ratio(bound, seen.response_cycles),
        "modes": [_in_mode(mode, name, undisturbed, left or {}) for mode in analysis.modes],
        "stack_bytes": timing.task.stack_bytes,
        "stack_bound_bytes": timing.stack_bound_bytes,
    }


def _in_mode(
    mode: ModeBounds, name: str, seen: Observed | None, left: Mapping[str, str]
) -> dict[str, Any]:
    """Nothing stands beside the bounds of a mode in which the runs are not."""
    bound, words = _up(mode.bounds[name].bound), left.get(mode.mode.name, "")
    seen = None if words else seen
    return {
        "name": mode.mode.name,
        "reason": mode.mode.reason,
        "left": words,
        "execution_bound_cycles": mode.jobs[name],
        "response_bound_cycles": bound,
        "meets_deadline": mode.bounds[name].meets_deadline,
        "execution_max_seen_cycles": None if seen is None else seen.execution_cycles,
        "response_max_seen_cycles": None if seen is None else seen.response_cycles,
        "ratio": None if seen is None or bound is None else ratio(bound, seen.response_cycles),
    }


def _response(analysis: Analysis, name: str) -> dict[str, Any]:
    """Response of an interrupt or an event; the alarm's calls are part of the tasks' overheads."""
    found = analysis.bounds.get(name)
    if found is None:
        return {"response_bound_cycles": None, "meets_deadline": None}
    return {"response_bound_cycles": _up(found.bound), "meets_deadline": found.meets_deadline}


def _misses(analysis: Analysis) -> list[dict[str, Any]]:
    """Tasks, interrupts, events and transfers that can miss their deadlines, the most urgent
    first. The deadline of a burst is the end of its window. Of a task with two releases in a
    period, each meets its deadline or none does."""
    tasks = {timing.task.name for timing in analysis.tasks}
    found = []
    for name, bound in analysis.bounds.items():
        if bound.meets_deadline or (name not in tasks and bound.task.release != "interrupt"):
            continue
        window = window_of(analysis.task_set, bound.task, analysis.overheads)
        found.append(
            {
                "name": name,
                "kind": "task" if name in tasks else "interrupt",
                "deadline_cycles": _up(bound.task.deadline),
                "execution_cycles": _up(bound.task.wcet),
                "response_bound_cycles": _up(bound.bound),
                "utilization": float(window.utilization),
            }
        )
    return found


def result_of(
    analysis: Analysis,
    observed: dict[str, Observed],
    undisturbed: dict[str, Observed] | None = None,
    used_stacks: Mapping[str, int] | None = None,
    left: Mapping[str, str] | None = None,
    *,
    margins: bool = True,
) -> dict[str, Any]:
    """The result as data; times in cycles unless the name says otherwise.

    `undisturbed` stands beside the bounds of modes, where it is not `observed`; `used_stacks` are
    what the run used of each stack, by thread; `left` says of modes where the runs leave them.
    Without `margins`, how far execution times and periods may change is None.
    """
    in_modes = observed if undisturbed is None else undisturbed
    scaling = largest_scaling(analysis) if margins else ScalingLimit(None, "")
    factor = scaling.factor
    stacks = stacks_of(analysis, used_stacks)
    order = sorted(analysis.tasks, key=lambda timing: -timing.task.priority)
    return {
        "timing": analysis.services.timing,
        "schedulable": analysis.schedulable,
        "misses": _misses(analysis),
        "stacks": stacks,
        "stacks_suffice": stacks_suffice(stacks),
        "largest_scaling": None if factor is None else float(factor),
        "scaling_limited_by": scaling.limited_by,
        "utilization": float(analysis.task_set.utilization),
        "tasks": [
            _task(analysis, t, (observed.get(name), in_modes.get(name)), left, margins)
            for name, t in ((timing.task.name, timing) for timing in order)
        ],
        "interrupts": [
            {
                "source": source_name(cost.handler.source),
                "handler": cost.handler.symbol,
                "priority": cost.handler.priority,
                "bound_cycles": cost.cycles,
                "handler_bound_cycles": min(cost.body.cycles, cost.cycles),
                "stack_bound_bytes": cost.stack_bytes,
                **_response(analysis, source_name(cost.handler.source)),
            }
            for cost in analysis.interrupts
        ],
        "timing_events": [
            {
                "handler": event.name,
                "bound_cycles": event.cycles,
                **_response(analysis, event.name),
                "at_most": [[load.at_most, load.window_us] for load in event.loads],
            }
            for event in analysis.events
        ],
        "never_waiting": _never_waiting(analysis),
        "scope": _scope(analysis),
        "background": [
            {
                "name": task.name,
                "priority": task.priority,
                "stack_bytes": task.stack_bytes,
                "stack_bound_bytes": deepest_stack(job),
            }
            for task, job in analysis.background.threads
        ],
        "interrupt_stack_bound_bytes": analysis.interrupt_stack_bytes,
        "services": {
            "delay_until_cycles": analysis.services.delay_until,
            "resume_cycles": analysis.services.resume,
            "alarm_cycles": _up(analysis.overheads.alarm),
            "release_jitter_cycles": analysis.services.release_jitter,
            **{f"{name}_cycles": c for name, c in analysis.services.masking.items()},
        },
        "protected_objects": [
            {"name": item.name, "ceiling": item.ceiling} for item in analysis.objects
        ],
    }


def _shown(cycles: int) -> str:
    return f"{cycles} cycles ({microseconds(cycles):.1f} us)"


def advice(result: dict[str, Any]) -> list[str]:
    """Deadlines and stacks that do not fit with remedies, the verdict's cause first; otherwise the
    margins."""
    stacks, deadlines = stack_lines(result["stacks"]), _deadline_lines(result)
    return [*stacks, *deadlines] if result["schedulable"] else [*deadlines, *stacks]


def _largest_term(task: dict[str, Any]) -> str:
    """The largest term of a bound, for when no single job can be shortened enough."""
    if task["terms"] is None:
        return f"{task['name']} and what is more urgent need more than the whole processor"
    keys = ("own", "interference", "interrupts", "blocking", "overheads")
    name = max(keys, key=lambda key: int(task["terms"][f"{key}_cycles"]))
    largest = task["terms"][f"{name}_cycles"]
    return (
        f"no shorter job alone is enough for {task['name']}: give it a longer deadline, or begin "
        f"with the largest term of its bound, {name} with {_shown(largest)}"
    )


def _miss(miss: dict[str, Any]) -> str:
    """The cause of a missed deadline: who, how long, and against what."""
    name, bound = miss["name"], miss["response_bound_cycles"]
    deadline_us = round(microseconds(miss["deadline_cycles"]))
    if miss["kind"] == "task":
        head = f"{name} can miss its deadline of {deadline_us} us: "
        response = "its response time may be"
    else:
        own = _shown(miss["execution_cycles"])
        head = f"the calls of {name} in a window of {deadline_us} us, {own}, can outlast it: "
        response = "their response time may be"
    if bound is not None:
        return f"{head}{response} {_shown(bound)}"
    share = f"{100 * miss['utilization']:.0f} % of the processor"
    return f"{head}it has no bound, since with all that is more urgent it needs {share}"


def _deadline_lines(result: dict[str, Any]) -> list[str]:
    if result["never_waiting"]:
        return [thread["words"] for thread in result["never_waiting"]]
    lines = [_miss(miss) for miss in result["misses"]]
    for task in result["tasks"]:
        limit, own = task["execution_max_cycles"], task["execution_bound_cycles"]
        if lines and limit is not None and 0 < limit < own:
            lines.append(
                f"{ENOUGH} if a job of {task['name']} takes {own - limit} cycles less:"
                f" at most {_shown(limit)}"
            )
    if lines and not any(line.startswith(ENOUGH) for line in lines):
        lines += [_largest_term(task) for task in result["tasks"] if not task["meets_deadline"]]
    if lines:
        return lines
    for task in result["tasks"]:
        limit, own = task["execution_max_cycles"], task["execution_bound_cycles"]
        if limit is not None and limit >= own:
            fastest = task["smallest_period_us"]
            faster = f", or come each {fastest} us" if fastest else ""
            lines.append(
                f"a job of {task['name']} may take {limit - own} cycles more{faster} before "
                f"{task['limited_by'] or 'it'} can miss a deadline"
            )
    return lines
