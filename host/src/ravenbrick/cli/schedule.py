# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick schedule`: is the task set of a file schedulable, and what limits it?"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.schedule.quantity import exact, shown
from ravenbrick.schedule.report import advice, analysis
from ravenbrick.schedule.task_file import Rule, read_task_file

__all__ = ["schedule_command"]

LONG_DIGITS = 3
_HEAD = ("task", "P", "T", "D", "C", "I", "B", "overhead", "R", "slack", "C max")


def _row(task: dict[str, Any]) -> list[str]:
    terms = task["terms"]
    interference = blocking = overheads = "-"
    if terms is not None:
        interference = _sum(part["time"] for part in terms["interference"])
        blocking = terms["blocking"]["time"]
        overheads = _sum(terms[k] for k in ("context_switches", "interrupt_entries", "clock"))
    times = (task["period"], task["deadline"], task["wcet"], interference, blocking, overheads)
    return [
        task["name"],
        str(task["priority"]),
        *(_whole(text, round) for text in times),
        _whole(task["response_time_bound"] or "no bound", math.ceil),
        _whole(task["slack"] or "-", math.floor),
        _whole(task["wcet_max"] or "-", math.floor),
    ]


def _whole(text: str, to_whole: Callable[[Fraction], int]) -> str:
    """Long decimals as whole numbers: times in cycles need no fraction."""
    whole, point, _ = text.partition(".")
    return str(to_whole(Fraction(text))) if point and len(whole) > LONG_DIGITS else text


def _sum(times: Any) -> str:
    return shown(sum((exact(time) for time in times), start=exact(0)))


def _print(reporter: Reporter, result: dict[str, Any]) -> None:
    reporter.print(f"{result['name']}: times in {result['unit']}, most urgent first")
    reporter.table(_HEAD, [_row(task) for task in result["tasks"]])
    edf = "meets" if result["schedulable_earliest_deadline_first"] else "can miss"
    reporter.print(
        f"utilisation {result['utilization']} (bound {result['liu_layland_bound']:.3f}), "
        f"largest scaling {result['largest_scaling'] or 'none'}; "
        f"earliest deadline first, without overheads, {edf} the deadlines"
    )
    reporter.print("schedulable" if result["schedulable"] else "NOT schedulable")
    for line in advice(result):
        reporter.print(f"  {line}")


@command("ravenbrick schedule taskset.toml")
def schedule_command(
    file: Annotated[Path, typer.Argument(help="Task set, TOML or JSON.")],
    priorities: Annotated[Rule | None, typer.Option(help="Rule in place of the file's.")] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    """Bound the response times of a task set given as a file."""
    result = analysis(read_task_file(file, priorities))
    _print(Reporter(json_output), result)
    return {**result, "advice": advice(result)}
