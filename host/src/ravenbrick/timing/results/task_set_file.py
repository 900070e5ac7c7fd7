# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The task set that was analysed, as a file for `ravenbrick schedule`: other priorities, earliest
deadline first and changed tasks are tried on it without a binary."""

from __future__ import annotations

import json
from dataclasses import fields
from fractions import Fraction
from typing import Any

from ravenbrick.schedule.model import Overheads, Task, TaskSet

__all__ = ["task_set_text"]

HEAD = """\
# Written by 'ravenbrick analyse'; read it with 'ravenbrick schedule FILE [--priorities RULE]'.
# Blocking is what the declared priorities give.
"""


def _time(value: Any) -> str:
    exact = Fraction(value)
    return str(exact.numerator) if exact.denominator == 1 else json.dumps(str(exact))


def _task(task: Task) -> list[str]:
    period = "period" if task.release == "cyclic" else "minimum_interrelease_time"
    lines = [
        "",
        "[[tasks]]",
        f"name = {json.dumps(task.name)}",
        f"release = {json.dumps(task.release)}",
        f"{period} = {_time(task.period)}",
        f"deadline = {_time(task.deadline)}",
        f"wcet = {_time(task.wcet)}",
        f"priority = {task.priority}",
    ]
    if task.blocking:
        lines.append(f"blocking = {_time(task.blocking)}")
    if task.limits:
        limits = (
            f"{{ share = {_time(share)}, window = {_time(span)}"
            + (f", late = {_time(late)} }}" if late else " }")
            for share, span, late in task.limits
        )
        lines.append(f"limits = [{', '.join(limits)}]")
    return lines


def task_set_text(name: str, task_set: TaskSet, overheads: Overheads) -> str:
    """The file; times are in cycles."""
    lines = ["schema_version = 1", f"name = {json.dumps(name)}", 'unit = "cycles"']
    costs = [(item.name, getattr(overheads, item.name)) for item in fields(overheads)]
    lines += ["", "[overheads]", *(f"{key} = {_time(cost)}" for key, cost in costs if cost)]
    for task in task_set.by_priority():
        lines += _task(task)
    return HEAD + "\n".join(lines) + "\n"
