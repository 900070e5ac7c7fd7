# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Causes of overestimation, in words: the terms by which a bound lies most above observations."""

from __future__ import annotations

from typing import Any

from ravenbrick.clock import MASTER_CLOCK

__all__ = ["overestimation"]

# Terms with a smaller share of the difference are not mentioned.
LEAST_SHARE = 0.1
CLOSE = 1.1


def _own(task: dict[str, Any]) -> tuple[int, str]:
    bound, seen = task["execution_bound_cycles"], task["observed"]["execution_cycles"]
    text = f"the longest path of its job takes {bound} cycles, the longest observed job {seen}"
    least = LEAST_SHARE * (bound - seen)
    modes = [mode for mode in task["modes"] if bound - mode["execution_bound_cycles"] > least]
    if modes:
        mode = min(modes, key=lambda mode: int(mode["execution_bound_cycles"]))
        path = f"{mode['execution_bound_cycles']} in mode '{mode['name']}' ({mode['reason']})"
        text += f"; that path takes only {path}"
    text = "; ".join([text, *task["recursions"]])
    return bound - seen, text


def _interference(task: dict[str, Any], handlers: set[str]) -> tuple[int, str]:
    bound = task["terms"]["interference_cycles"]
    seen = task["observed"]["interference_cycles"]
    parts = [p for p in task["terms"]["interference"] if p["task"] not in handlers]
    names = ", ".join(f"{p['jobs']:g} x {p['task']}" for p in parts)
    text = f"more urgent jobs, all at their longest, take {bound} cycles ({names}), observed {seen}"
    return bound - seen, text


def _interrupts(task: dict[str, Any], handlers: set[str]) -> tuple[int, str]:
    bound = task["terms"]["interrupts_cycles"]
    seen = task["observed"]["interrupt_cycles"]
    parts = [p for p in task["terms"]["interference"] if p["task"] in handlers]
    names = ", ".join(f"{p['task']} {p['cycles']}" for p in parts)
    text = f"interrupts at their maximum rates take {bound} cycles ({names}), observed {seen}"
    return bound - seen, text


def _blocking(task: dict[str, Any]) -> tuple[int, str]:
    bound, seen = task["terms"]["blocking_cycles"], task["observed"]["blocking_cycles"]
    cause = task["terms"]["blocked_by"]
    what = f"{cause['task']} may block it ({cause['kind']})"
    return bound - seen, f"{what} for {bound} cycles, observed {seen}"


def _overheads(task: dict[str, Any]) -> str:
    """All of them: a run does not show them separately."""
    cycles = task["terms"]["overheads_cycles"] + task["terms"]["release_jitter_cycles"]
    what = "releases by the alarm, returns of preempted tasks and release jitter"
    return f"{what} are charged {cycles} cycles, which the run does not show separately"


def _of_task(task: dict[str, Any], handlers: set[str]) -> str:
    bound, seen = task["response_bound_cycles"], task["observed"]["response_cycles"]
    apart_us = float((bound - seen) * 1_000_000 / MASTER_CLOCK.hertz)
    head = f"{task['name']}: the bound is {bound - seen} cycles ({apart_us:.0f} us) above"
    if bound <= CLOSE * seen:
        return f"{head} the longest observed response, which is close"
    terms = [_own(task), _interference(task, handlers), _interrupts(task, handlers)]
    terms.append(_blocking(task))
    least = LEAST_SHARE * (bound - seen)
    shown = [text for gap, text in sorted(terms, key=lambda term: -term[0]) if gap >= least]
    shown = shown or [_overheads(task)]
    return f"{head} the longest observed response: " + "; ".join(shown)


def overestimation(result: dict[str, Any]) -> list[str]:
    """A sentence for each task that has a bound and was seen; cycles.

    The bound takes all terms at their worst in one job, which a run seldom meets.
    """
    tasks = {task["name"] for task in result["tasks"]}
    found = []
    for task in result["tasks"]:
        if task["terms"] is None or task["observed"] is None:
            continue
        handlers = {part["task"] for part in task["terms"]["interference"]} - tasks
        found.append(_of_task(task, handlers))
    return found
