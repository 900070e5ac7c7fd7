# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick schedule`: schedulability and response-time bounds of a task set in a file."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import DeadlineError, UsageError
from ravenbrick.schedule.assignment import Rule
from ravenbrick.schedule.quantity import Time, exact, shown
from ravenbrick.schedule.report import advice, analysis
from ravenbrick.schedule.task_file import TaskFile, read_task_file

__all__ = ["schedule_command"]

LONG_DIGITS = 3
PICTURES = (".png", ".svg", ".pdf")
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


def _responses_edf(result: dict[str, Any]) -> str:
    key = "response_time_bound_earliest_deadline_first"
    known = [(task["name"], task[key]) for task in result["tasks"] if task[key]]
    text = ", ".join(f"{name} {_whole(bound, math.ceil)}" for name, bound in known)
    return f" (R: {text})" if text else ""


def _print(reporter: Reporter, result: dict[str, Any]) -> None:
    reporter.print(f"{result['name']}: times in {result['unit']}, most urgent first")
    reporter.table(_HEAD, [_row(task) for task in result["tasks"]])
    _print_models(reporter, result)
    text = (
        f"utilisation {result['utilization']} (bound {result['liu_layland_bound']:.3f}), "
        f"largest scaling {result['largest_scaling'] or 'none'}"
    )
    if not (result["servers"] or result["transactions"] or result["mixed_criticality"]):
        edf = "meets" if result["schedulable_earliest_deadline_first"] else "can miss"
        text += f"; earliest deadline first, without overheads, {edf} the deadlines"
        text += _responses_edf(result)
    reporter.print(text)
    if result["schedulable"]:
        reporter.print("schedulable")


def _print_models(reporter: Reporter, result: dict[str, Any]) -> None:
    """Best cases, frames, servers, criticalities, transactions and slack, as far as there are."""
    for task in result["tasks"]:
        if task["response_time_best"] is not None:
            text = f"{task['name']}: best response time {task['response_time_best']}"
            reporter.print(f"{text}, output jitter {task['output_jitter'] or 'without bound'}")
        if task["frames"]:
            times = ", ".join(frame["response_time_bound"] or "-" for frame in task["frames"])
            reporter.print(f"{task['name']}: response times of its frames: {times}")
    for server in result["servers"]:
        for task in server["tasks"]:
            bound = task["response_time_bound"] or "no bound"
            text = f"R {bound}, deadline {task['deadline']}"
            reporter.print(f"{task['name']}, served by {server['name']} ({server['kind']}): {text}")
    mixed = result["mixed_criticality"]
    for task in mixed["tasks"] if mixed else ():
        low, high = (task[f"response_time_bound_{mode}"] or "none" for mode in ("low", "high"))
        text = f"{task['name']}: {task['criticality']} criticality, R {low} in the low mode"
        high_mode = f", {high} in the high one ({mixed['method']})"
        reporter.print(text + (high_mode if task["criticality"] == "high" else ""))
    for each in result["transactions"]:
        times = f"{each['response_time_best']} to {each['response_time_bound'] or 'no bound'}"
        reporter.print(f"transaction {each['name']}: {times}, deadline {each['deadline']}")
    for each in result["objects"]:
        grow = each["slack_percent"]
        reporter.print(f"sections on {each['name']} may grow by {grow or '-'} %")


@command("ravenbrick schedule taskset.toml")
def schedule_command(
    file: Annotated[Path, typer.Argument(help="Task set (TOML or JSON).")],
    priorities: Annotated[
        Rule | None, typer.Option(help="Priority assignment (default: as in the file).")
    ] = None,
    gantt: Annotated[
        Path | None, typer.Option(help="Gantt chart to write (.png, .svg or .pdf).")
    ] = None,
    until: Annotated[
        str | None, typer.Option(help="End of the Gantt chart in the file's time unit.")
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    end = _end_of_picture(gantt, until)
    found = read_task_file(file, priorities)
    result = analysis(found)
    answer = {**result, "advice": advice(result)}
    if gantt is not None:
        answer["gantt"] = str(_drawn(found, gantt, end))
    reporter = Reporter(json_output)
    _print(reporter, result)
    if gantt is not None:
        reporter.print(f"schedules, without overheads: {gantt}")
    if not result["schedulable"]:
        cause, *changes = answer["advice"]
        error = DeadlineError(f"NOT schedulable: {cause}", detail="\n".join(changes))
        error.data = answer
        raise error
    return answer


def _end_of_picture(path: Path | None, until: str | None) -> Time | None:
    """What the options ask for, checked; None for all there is to see."""
    if path is None and until is not None:
        raise UsageError("--until is the end of the picture; name its file with --gantt")
    if path is not None and path.suffix not in PICTURES:
        raise UsageError(f"{path}: cannot be drawn; end its name in {', '.join(PICTURES)}")
    try:
        end = None if until is None else exact(until)
    except ValueError:
        raise UsageError(f"--until {until}: expected a number, or a text such as 1/3") from None
    if end is not None and end <= 0:
        raise UsageError(f"--until {until}: expected more than 0")
    return end


def _drawn(found: TaskFile, path: Path, end: Time | None) -> Path:
    """The picture's file."""
    from ravenbrick.schedule.report.gantt import gantt_figure

    figure = gantt_figure(found.task_set, found.unit, end)
    content = io.BytesIO()
    kind = path.suffix.removeprefix(".")
    dated = {"svg": "Date", "pdf": "CreationDate"}.get(kind)
    figure.savefig(content, format=kind, dpi=150, metadata={dated: None} if dated else None)
    atomic_write(path, content.getvalue())
    return path
