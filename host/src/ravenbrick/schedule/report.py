# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Analysis of a task file as plain data, for `--json` and for tables."""

from __future__ import annotations

from typing import Any

from ravenbrick.schedule.bounds import (
    hyperbolic_product,
    liu_layland_bound,
    passes_hyperbolic_bound,
    passes_liu_layland_bound,
)
from ravenbrick.schedule.demand import AnalysisLimitError
from ravenbrick.schedule.edf import earliest_deadline_bounds, processor_demand_test
from ravenbrick.schedule.model import TaskSet
from ravenbrick.schedule.offsets import phased_response_time_bounds
from ravenbrick.schedule.quantity import Time, Toward, exact, shown
from ravenbrick.schedule.response_time import ResponseTimeBound
from ravenbrick.schedule.sensitivity import largest_scaling, largest_wcet
from ravenbrick.schedule.task_file import TaskFile

__all__ = ["advice", "analysis"]


def _text(time: Time | None, toward: Toward = "nearest") -> str | None:
    return None if time is None else shown(time, toward=toward)


def _terms(found: ResponseTimeBound) -> dict[str, Any] | None:
    terms = found.terms
    if terms is None:
        return None
    return {
        "job": terms.job,
        "own": shown(terms.own),
        "previous_jobs": shown(terms.previous_jobs),
        "interference": [
            {"task": part.task, "jobs": part.jobs, "time": shown(part.time)}
            for part in terms.interference
        ],
        "blocking": {
            "time": shown(terms.blocking.time),
            "cause": terms.blocking.cause,
            "task": terms.blocking.task,
            "resource": terms.blocking.resource,
        },
        "context_switches": shown(terms.context_switches),
        "interrupt_entries": shown(terms.interrupt_entries),
        "clock": shown(terms.clock),
        "release_jitter": shown(terms.release_jitter),
        "waited": shown(terms.waited),
    }


def _earliest_deadline(task_set: TaskSet) -> dict[str, str | None]:
    """Response times under earliest deadline first by the task's name, where they can be told."""
    try:
        found = earliest_deadline_bounds(task_set)
    except AnalysisLimitError:
        return {}
    return {bound.task.name: _text(bound.bound, "up") for bound in found}


def _task(file: TaskFile, found: ResponseTimeBound, edf: dict[str, str | None]) -> dict[str, Any]:
    task = found.task
    wcet_max, limited_by = largest_wcet(file.task_set, task.name, file.overheads)
    return {
        "name": task.name,
        "release": task.release,
        "priority": task.priority,
        "period": shown(task.period),
        "deadline": shown(task.deadline),
        "wcet": shown(task.wcet),
        "wcet_max": _text(wcet_max, "down"),
        "wcet_limited_by": limited_by,
        "response_time_bound": _text(found.bound, "up"),
        "response_time_bound_earliest_deadline_first": edf.get(task.name),
        "slack": _text(found.slack, "down"),
        "meets_deadline": found.meets_deadline,
        "terms": _terms(found),
    }


def _quick_tests(task_set: TaskSet) -> dict[str, Any]:
    demand = processor_demand_test(task_set)
    return {
        "utilization": shown(task_set.utilization),
        "liu_layland_bound": round(liu_layland_bound(len(task_set)), 6),
        "passes_liu_layland_bound": passes_liu_layland_bound(task_set),
        "hyperbolic_product": shown(hyperbolic_product(task_set)),
        "passes_hyperbolic_bound": passes_hyperbolic_bound(task_set),
        "schedulable_earliest_deadline_first": demand.schedulable,
        "overload": _text(demand.instant),
    }


def analysis(file: TaskFile) -> dict[str, Any]:
    """All results; times are decimal texts in the file's unit.

    Response times use the phases that are declared; `wcet_max` and `largest_scaling` do not.
    """
    bounds = phased_response_time_bounds(file.task_set, file.overheads)
    edf = _earliest_deadline(file.task_set)
    scaling = largest_scaling(file.task_set, file.overheads)
    return {
        "name": file.name,
        "unit": file.unit,
        "priorities": file.priorities,
        "schedulable": all(found.meets_deadline for found in bounds),
        **_quick_tests(file.task_set),
        "largest_scaling": _text(scaling.factor, "down"),
        "scaling_limited_by": scaling.limited_by,
        "tasks": [_task(file, found, edf) for found in bounds],
    }


def advice(result: dict[str, Any]) -> list[str]:
    """Which task to change and by how much when a deadline can be missed."""
    unit = result["unit"]
    missed = [task for task in result["tasks"] if not task["meets_deadline"]]
    if not missed:
        return []
    lines = [
        f"{task['name']}: response time "
        + (
            f"{task['response_time_bound']} {unit} is above the deadline {task['deadline']} {unit}"
            if task["response_time_bound"]
            else "has no bound: the processor is overloaded at its priority"
        )
        for task in missed
    ]
    for task in result["tasks"]:
        if task["wcet_max"] is not None and 0 < exact(task["wcet_max"]) < exact(task["wcet"]):
            lines.append(
                f"all deadlines are met if {task['name']} executes for {task['wcet_max']} {unit} "
                f"instead of {task['wcet']} {unit}"
            )
    factor = result["largest_scaling"]
    if factor is not None:
        lines.append(f"or if all execution times are multiplied by {factor}")
    return lines
