# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The timing report: one HTML file with everything inside, and the data as JSON beside it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.report.plots.style import data_uri, png_bytes
from ravenbrick.timing.explanation import why_apart
from ravenbrick.timing.result import advice, microseconds

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

REPORT_HEAD = (
    "task",
    "deadline (us)",
    "job at most",
    "bound",
    "observed",
    "bound/observed",
    "stack bound",
    "stack seen",
    "Storage_Size",
)
SHORT_HEAD = ("task", "deadline", "job", "bound", "seen", "ratio", "stack", "seen", "size")
INTERRUPT_HEAD = ("interrupt", "handler", "priority", "at most, all in all", "handler alone")
EVENT_HEAD = ("timing event's handler", "at most, all in all", "done after its time")
OBSERVED_HEAD = (
    "task",
    "",
    "own",
    "interference",
    "interrupts",
    "blocking",
    "overheads",
    "release jitter",
    "response",
)


def _text(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.2f}" if isinstance(value, float) else str(value)


def short_rows(result: dict[str, Any]) -> list[list[str]]:
    """The columns of `SHORT_HEAD` and `REPORT_HEAD`: a row for each task, those of its modes below;
    cycles."""
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
        rows.append(["", "largest seen", *(_text(value) for value in largest)])
    return rows


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f'<div class="scroll"><table><tr>{cells}</tr>{body}</table></div>'


def _image(figure: Figure, caption: str) -> str:
    source = data_uri(png_bytes(figure), "image/png")
    alternative = escape(caption, quote=True)
    return (
        f'<figure><img src="{source}" alt="{alternative}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def _page(
    name: str,
    result: dict[str, Any],
    figures: Sequence[tuple[str, Figure]],
    notes: Sequence[str],
) -> str:
    css = resources.files("ravenbrick.report").joinpath("templates/report.css").read_text("utf-8")
    verdict = "All deadlines are met." if result["schedulable"] else "A deadline can be missed."
    verdict += "" if result["stacks_suffice"] else " A stack can overflow."
    lines = "".join(f"<li>{escape(line)}</li>" for line in (*advice(result), *notes))
    differences = "".join(f"<li>{escape(line)}.</li>" for line in why_apart(result))
    services = [
        (key.removesuffix("_cycles").replace("__", "."), _text(value))
        for key, value in result["services"].items()
    ]
    objects = [(item["name"], str(item["ceiling"])) for item in result["protected_objects"]]
    alarm = microseconds(result["services"]["alarm_cycles"])
    parts = [
        f"<h1>{escape(name)}: timing</h1>",
        f'<p class="lead">{verdict} Times in cycles of 48.054857 MHz, {result["timing"]} timing. '
        "Bounds come from the binary before the run; what is seen comes from the run.</p>",
        f"<ul>{lines}</ul>",
        "<h2>Response times</h2>",
        _table(REPORT_HEAD, short_rows(result)),
        *(_image(figure, caption) for caption, figure in figures),
        "<h2>Each term beside what was seen</h2>",
        "<p>The largest values of a row need not belong to one job.</p>",
        _table(OBSERVED_HEAD, _observed_rows(result)),
        "<h2>Why bound and observation differ</h2>",
        "<p>The bound takes all terms at their worst in one job. A run meets them together only "
        "when inputs and phases fall so; <code>--hunt</code> looks for such runs.</p>",
        f"<ul>{differences}</ul>",
        "<h2>Interrupts</h2>",
        _table(INTERRUPT_HEAD, interrupt_rows(result)),
        *([_table(EVENT_HEAD, event_rows(result))] if result["timing_events"] else []),
        f"<p>All handlers need at most {result['interrupt_stack_bound_bytes']} bytes of the "
        f"handlers' stack. A release costs {alarm:.1f} us at the highest priority.</p>",
        "<h2>The run-time's services</h2>",
        _table(("service", "at most"), services),
        "<h2>Protected objects</h2>",
        _table(("object", "ceiling"), objects),
    ]
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(name)}: timing</title><style>\n{css}</style></head>\n<body>"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )


def write_timing_report(
    name: str,
    result: dict[str, Any],
    figures: Sequence[tuple[str, Figure]],
    notes: Sequence[str],
    folder: Path,
) -> Path:
    """Write timing.html, with `notes` below the advice, and timing.json; returns the report's
    file."""
    report = folder / "timing.html"
    atomic_write(report, _page(name, result, figures, notes))
    atomic_write(folder / "timing.json", json.dumps(result, indent=1) + "\n")
    return report
