# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The timing report: one HTML file with everything inside, and the data as JSON beside it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.report.page import page
from ravenbrick.report.plots.style import data_uri, png_bytes
from ravenbrick.timing.results.explanation import overestimation
from ravenbrick.timing.results.result import advice, microseconds
from ravenbrick.timing.results.worst_path import Executed, PathLine, WorstPath

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "EVENT_HEAD",
    "INTERRUPT_HEAD",
    "SHORT_HEAD",
    "event_rows",
    "interrupt_rows",
    "short_rows",
    "write_timing_report",
]

SHORT_HEAD = ("task", "deadline", "job", "bound", "observed", "ratio", "stack", "observed", "size")
INTERRUPT_HEAD = (
    "interrupt",
    "handler",
    "priority",
    "bound with entry and exit",
    "handler's bound",
)
EVENT_HEAD = ("timing event's handler", "bound with entry and exit", "response bound")


def _text(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.2f}" if isinstance(value, float) else str(value)


def short_rows(result: dict[str, Any]) -> list[list[str]]:
    """The columns of `SHORT_HEAD`: a row for each task, those of its modes below; cycles."""
    rows = []
    for task in result["tasks"]:
        seen = task["observed"] or {}
        cells = [
            task["name"],
            task["deadline_us"],
            task["execution_bound_cycles"],
            task["response_bound_cycles"],
            seen.get("response_cycles"),
            task["ratio"],
            task["stack_bound_bytes"],
            seen.get("stack_bytes"),
            task["stack_bytes"],
        ]
        rows.append([_text(cell) for cell in cells])
        rows += [_mode_row(mode) for mode in task["modes"]]
    return rows


def _mode_row(mode: dict[str, Any]) -> list[str]:
    bounds = [mode["response_bound_cycles"], mode["response_max_seen_cycles"], mode["ratio"]]
    cells = [f"- {mode['name']}", "", mode["execution_bound_cycles"], *bounds, "", "", ""]
    return [_text(cell) for cell in cells]


def interrupt_rows(result: dict[str, Any]) -> list[list[str]]:
    """One row for each interrupt; cycles."""
    keys = ("source", "handler", "priority", "bound_cycles", "handler_bound_cycles")
    return [[_text(row[key]) for key in keys] for row in result["interrupts"]]


def event_rows(result: dict[str, Any]) -> list[list[str]]:
    """One row for each handler of timing events; cycles."""
    keys = ("handler", "bound_cycles", "response_bound_cycles")
    return [[_text(row[key]) for key in keys] for row in result["timing_events"]]


def _stack_rows(result: dict[str, Any]) -> list[list[str]]:
    keys = ("name", "bound_bytes", "used_bytes", "size_bytes", "verdict")
    return [[_text(stack[key]) for key in keys] for stack in result["stacks"]]


def _observed_rows(result: dict[str, Any]) -> list[list[str]]:
    rows = []
    keys = ("interference_cycles", "interrupts_cycles", "blocking_cycles")
    seen_keys = ("interference_cycles", "interrupt_cycles", "blocking_cycles")
    for task in result["tasks"]:
        terms, seen = task["terms"], task["observed"]
        if terms is None or seen is None:
            continue
        bounds = [terms["own_cycles"], *(terms[key] for key in keys)]
        bounds += [terms["overheads_cycles"], terms["release_jitter_cycles"]]
        bounds.append(task["response_bound_cycles"])
        largest = [seen["execution_cycles"], *(seen[key] for key in seen_keys)]
        largest += ["", "", seen["response_cycles"]]
        rows.append([task["name"], "bound", *(_text(value) for value in bounds)])
        rows.append(["", "largest observed", *(_text(value) for value in largest)])
    return rows


def _plain_paths(paths: Sequence[WorstPath]) -> dict[str, list[dict[str, Any]]]:
    """By task: each line with the function and its executions and cycles on both paths."""

    def plain(name: str, line: PathLine) -> dict[str, Any]:
        own = {"function": name, "place": line.place}
        for side, value in (("worst", line.worst), ("run", line.run)):
            own |= {f"{side}_{key}": number for key, number in vars(value or Executed()).items()}
        return own

    return {
        path.task: [plain(owner.name, line) for owner, line in path.function.all_lines()]
        for path in paths
    }


def write_timing_report(
    name: str,
    result: dict[str, Any],
    figures: Sequence[tuple[str, Figure]],
    notes: Sequence[str],
    paths: Sequence[WorstPath],
    folder: Path,
) -> Path:
    """Write timing.html, with `notes` below the advice, and timing.json; returns the report's
    file."""
    services = result["services"].items()
    text = page(
        "timing_report.html",
        title=f"{name}: timing",
        result=result,
        notes=(*advice(result), *notes),
        responses=short_rows(result),
        figures=[(text, data_uri(png_bytes(figure), "image/png")) for text, figure in figures],
        paths=paths,
        terms=_observed_rows(result),
        differences=overestimation(result),
        interrupt_head=INTERRUPT_HEAD,
        interrupts=interrupt_rows(result),
        event_head=EVENT_HEAD,
        events=event_rows(result),
        release_us=microseconds(result["services"]["alarm_cycles"]),
        services=[(k.removesuffix("_cycles").replace("__", "."), _text(v)) for k, v in services],
        stacks=_stack_rows(result),
        objects=[(item["name"], item["ceiling"]) for item in result["protected_objects"]],
    )
    report = folder / "timing.html"
    atomic_write(report, text)
    atomic_write(
        folder / "timing.json",
        json.dumps({**result, "worst_paths": _plain_paths(paths)}, indent=1) + "\n",
    )
    return report
