# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Analysis of a task file as plain data, for `--json` and for tables."""

from __future__ import annotations

from fractions import Fraction
from itertools import zip_longest
from typing import Any

from ravenbrick.schedule.best_case import best_case_response_time
from ravenbrick.schedule.blocking import ceilings
from ravenbrick.schedule.bounds import (
    hyperbolic_product,
    liu_layland_bound,
    passes_hyperbolic_bound,
    passes_liu_layland_bound,
)
from ravenbrick.schedule.demand import AnalysisLimitError
from ravenbrick.schedule.edf import earliest_deadline_bounds, processor_demand_test
from ravenbrick.schedule.model import TaskSet
from ravenbrick.schedule.quantity import Time, Toward, exact, shown
from ravenbrick.schedule.response_time import ResponseTimeBound
from ravenbrick.schedule.sensitivity import largest_section_scaling
from ravenbrick.schedule.task_file import TaskFile
from ravenbrick.schedule.task_models.mixed_criticality import MixedCriticalityBound
from ravenbrick.schedule.task_models.servers import ServedBound, Server
from ravenbrick.schedule.task_models.system import Solution
from ravenbrick.schedule.task_models.transactions import Transaction

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


def _percent(factor: Time | None) -> str | None:
    """By how much something may grow: a factor as a percentage, rounded down."""
    return None if factor is None else shown((factor - 1) * 100, digits=2, toward="down")


def _best_case(file: TaskFile, found: ResponseTimeBound) -> dict[str, Any]:
    """Least response time and output jitter of a task whose least execution time is known."""
    task = found.task
    if not task.bcet:
        return {"response_time_best": None, "output_jitter": None}
    best = best_case_response_time(file.system.solution.task_set, task, file.overheads)
    return {
        "response_time_best": shown(best, toward="down"),
        "output_jitter": None if found.bound is None else shown(found.bound - best, toward="up"),
    }


def _task(file: TaskFile, found: ResponseTimeBound, edf: dict[str, str | None]) -> dict[str, Any]:
    task = found.task
    wcet_max, limited_by = file.system.longest_execution(file.task_set.task(task.name))
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
        "slack_percent": None if wcet_max is None else _percent(Fraction(wcet_max) / task.wcet),
        "meets_deadline": found.meets_deadline,
        **_best_case(file, found),
        "frames": [
            {
                "wcet": shown(frame.wcet),
                "separation": shown(frame.separation),
                "deadline": shown(frame.deadline),
                "response_time_bound": _text(time, "up"),
            }
            for frame, time in zip_longest(task.frames, found.frames)
        ],
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

    Response times use the phases that are declared; `wcet_max` and `largest_scaling` of a plain
    task set do not. Raises `AnalysisLimitError`.
    """
    solution = file.system.solution
    plain = file.system.is_plain
    edf = _earliest_deadline(file.task_set) if plain else {}
    factor, limited_by = file.system.scaling()
    return {
        "name": file.name,
        "unit": file.unit,
        "priorities": file.priorities,
        "schedulable": solution.schedulable,
        **_quick_tests(file.task_set),
        "largest_scaling": _text(factor, "down"),
        "scaling_limited_by": limited_by,
        "slack_percent": _percent(factor),
        "tasks": [_task(file, found, edf) for found in solution.bounds],
        "objects": _objects(file) if plain else [],
        "servers": [_server(server, solution.served) for server in file.system.servers],
        "mixed_criticality": _mixed(file, solution.mixed),
        "transactions": [_transaction(each, solution) for each in file.system.transactions],
    }


def _objects(file: TaskFile) -> list[dict[str, Any]]:
    """How much all sections on each object may grow."""
    rows = []
    for name, ceiling in ceilings(file.task_set).items():
        limit = largest_section_scaling(file.task_set, name, file.overheads)
        rows.append(
            {
                "name": name,
                "ceiling": ceiling,
                "slack_percent": _percent(limit.factor),
                "limited_by": limit.limited_by,
            }
        )
    return rows


def _server(server: Server, served: tuple[ServedBound, ...]) -> dict[str, Any]:
    return {
        "name": server.name,
        "kind": server.kind,
        "period": shown(server.period),
        "capacity": shown(server.capacity),
        "tasks": [
            {
                "name": found.task.name,
                "wcet": shown(found.task.wcet),
                "deadline": shown(found.task.deadline),
                "response_time_bound": _text(found.bound, "up"),
                "meets_deadline": found.meets_deadline,
            }
            for found in served
            if found.server == server.name
        ],
    }


def _mixed(file: TaskFile, bounds: tuple[MixedCriticalityBound, ...]) -> dict[str, Any] | None:
    if not bounds:
        return None
    rows = [
        {
            "name": found.task.name,
            "criticality": "low" if found.task.wcet_high is None else "high",
            "wcet_high": _text(found.task.wcet_high),
            "deadline": shown(found.task.deadline),
            "response_time_bound_low": _text(found.low, "up"),
            "response_time_bound_high": _text(found.high, "up"),
            "meets_deadline": found.meets_deadline,
        }
        for found in bounds
    ]
    return {"method": file.system.method, "tasks": rows}


def _transaction(transaction: Transaction, solution: Solution) -> dict[str, Any]:
    assert solution.chains is not None
    response = solution.chains.responses[transaction.name]
    return {
        "name": transaction.name,
        "tasks": list(transaction.tasks),
        "deadline": shown(transaction.deadline),
        "response_time_bound": _text(response, "up"),
        "response_time_best": shown(solution.chains.earliest[transaction.name], toward="down"),
        "meets_deadline": response is not None and response <= transaction.deadline,
    }


def _late(name: str, found: dict[str, Any], unit: str, unbounded: str) -> str:
    """Why something is not in time."""
    bound = found["response_time_bound"]
    if bound is None:
        return f"{name}: response time has no bound: {unbounded}"
    return f"{name}: response time {bound} {unit} is above the deadline {found['deadline']} {unit}"


def _reasons(result: dict[str, Any]) -> list[str]:
    """Why the system is not schedulable, one sentence for each deadline that can be missed."""
    unit = result["unit"]
    steps = {name for each in result["transactions"] for name in each["tasks"]}
    overloaded = "the processor is overloaded at its priority"
    lines = [
        _late(f"transaction {each['name']}", each, unit, "its tasks delay one another without end")
        for each in result["transactions"]
        if not each["meets_deadline"]
    ]
    lines += [
        _frames_late(task, unit) or _late(task["name"], task, unit, overloaded)
        for task in result["tasks"]
        if not task["meets_deadline"] and not (task["name"] in steps and lines)
    ]
    lines += [
        _late(task["name"], task, unit, f"the budget of server '{server['name']}' does not suffice")
        for server in result["servers"]
        for task in server["tasks"]
        if not task["meets_deadline"]
    ]
    mixed = result["mixed_criticality"] or {"tasks": []}
    lines += [
        f"{task['name']}: the deadline {task['deadline']} {unit} can be missed once a task of high "
        "criticality takes longer than its 'wcet'"
        for task in mixed["tasks"]
        if task["response_time_bound_low"] is not None and not task["meets_deadline"]
    ]
    return lines


def _frames_late(task: dict[str, Any], unit: str) -> str:
    """The first frame that can miss its deadline, if it is one of several."""
    for number, frame in enumerate(task["frames"], 1):
        bound = frame["response_time_bound"]
        if bound is not None and exact(bound) > exact(frame["deadline"]):
            name = f"frame {number} of {task['name']}"
            return _late(name, frame, unit, "")
    return ""


def advice(result: dict[str, Any]) -> list[str]:
    """Which task to change and by how much when a deadline can be missed."""
    unit = result["unit"]
    lines = _reasons(result)
    if not lines:
        return []
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
