# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The report of runs: one HTML file with everything inside, and its charts beside it as SVG."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.report.page import Figure, Figures, milliseconds, page, percent
from ravenbrick.report.plots.path import path_drawing
from ravenbrick.report.plots.step_response import DESIGNED, step_drawing
from ravenbrick.report.plots.style import data_uri
from ravenbrick.report.run_section import compared, run_section
from ravenbrick.trace.design import Response
from ravenbrick.trace.motion import StepMeasures, speed_filter
from ravenbrick.trace.summary import Evidence, summary

__all__ = ["write_report"]


def _length(metres: float | None) -> str:
    return "not measured" if metres is None else f"{1000 * metres:.3g} mm"


def _role_figures(evidence: Evidence) -> list[tuple[str, str]]:
    """Figures of the step and of the drives with and without the controller."""
    figures: list[tuple[str, str]] = []
    step = evidence.step_record
    if step is not None:
        settled = step.measures.settling_time
        figures.append(
            (f"{1000 * settled:.0f} ms" if settled is not None else "never", "settling time (2 %)")
        )
        figures.append((percent(step.measures.overshoot), "overshoot"))
    for role, label in (("drive", "with"), ("open_loop", "without")):
        run = evidence.with_role(role)
        if run is not None and run.measures.path is not None and run.scenario.straight is not None:
            distance = f"{run.scenario.straight.distance:g} m"
            text = f"off the line in {distance}, {label} controller"
            figures.append((_length(run.measures.path.lateral_deviation), text))
    return figures


def _key_figures(evidence: Evidence) -> list[tuple[str, str]]:
    """The most important values, each with what it is."""
    runs = evidence.runs
    met = sum(run.met for run in runs)
    judged = [result for run in runs for result in run.criteria]
    figures = [(f"{met} of {len(runs)}", "runs passed")] if runs[1:] or not met else []
    if judged:
        good = sum(result.met for result in judged)
        figures.append((f"{good} of {len(judged)}", "criteria met"))
    figures += _role_figures(evidence)
    if any(task.deadline_cycles is not None for run in runs for task in run.measures.tasks):
        misses = sum(task.deadline_misses for run in runs for task in run.measures.tasks)
        figures.append((str(misses), "deadlines missed"))
    busy = max(run.measures.utilization.busy for run in runs)
    figures.append((f"{100 * busy:.1f} %", "processor used" + (", at most" if runs[1:] else "")))
    shares = [
        (task.used_bytes / task.storage_size_bytes, task.name)
        for task in (evidence.memory.tasks if evidence.memory else ())
        if task.used_bytes and task.storage_size_bytes
    ]
    if shares:
        share, name = max(shares)
        figures.append((f"{100 * share:.0f} %", f"of the fullest stack used, {name}"))
    return figures


def _step(evidence: Evidence, figures: Figures) -> dict[str, Any] | None:
    """The step response as designed and on the brick; None without a step."""
    record, design = evidence.step_record, evidence.design
    if record is None:
        return None
    responses: list[tuple[str, Response | StepMeasures]] = []
    for name, designed in (design.responses if design else {}).items():
        responses.append((DESIGNED[name][0], designed))
    for run in evidence.runs:
        for motor, step in run.measures.steps.items():
            name = f"on the brick, motor {motor} (scenario '{run.scenario.name}')"
            responses.append((name, step.measures))
    drawing = step_drawing(design, record)
    return {
        "filter": speed_filter(),
        "figure": figures.add("step-response", drawing, "Step of the speed set-point"),
        "rows": [
            (name, milliseconds(found.settling_time), percent(found.overshoot))
            for name, found in responses
        ],
        "estimators": [
            (
                estimator.name,
                f"{estimator.quantum:.3f} V",
                milliseconds(estimator.settling_time),
                percent(estimator.ripple),
                f"{estimator.control_peak_to_peak:.3f} V",
            )
            for estimator in (design.estimators if design else ())
        ],
    }


def _comparison(evidence: Evidence, figures: Figures) -> Figure | None:
    """Paths of the drives with and without the controller; None unless there are both."""
    both = compared(evidence)
    if not both:
        return None
    labels = ("with the controller", "without the controller")
    paths = [(label, run.recording) for label, run in zip(labels, both, strict=True)]
    return figures.add(
        "path",
        path_drawing(evidence.robot, paths),
        "Path from above. Both runs: same image, same motors, same inputs; the second with the "
        "set-point passed to the motors as it is",
    )


def _memory(evidence: Evidence) -> dict[str, Any]:
    """The memory report with the rows of its tables."""
    memory = evidence.memory
    stacks = [
        (task.name, *("unknown" if size is None else size for size in sizes))
        for task in (memory.tasks if memory else ())
        for sizes in [(task.storage_size_bytes, task.used_bytes)]
    ]
    parts = memory.parts.items() if memory else ()
    rows = [(name, *(part[key] for key in ("text", "data", "bss"))) for name, part in parts]
    return {"memory": memory, "stacks": stacks, "memory_parts": rows}


def _controller(evidence: Evidence) -> str:
    """The picture of the designed controller for an `src` attribute, in which no script runs."""
    drawn = evidence.design.diagram if evidence.design else ""
    return data_uri(drawn.encode(), "image/svg+xml") if drawn else ""


def _page(evidence: Evidence, figures: Figures) -> str:
    return page(
        "run_report.html",
        title=f"{evidence.robot.name}: report",
        robot=evidence.robot,
        main=evidence.main.scenario.name,
        same_digest_twice=evidence.same_digest_twice,
        key_figures=_key_figures(evidence),
        controller=_controller(evidence),
        step=_step(evidence, figures),
        comparison=_comparison(evidence, figures),
        sections=[run_section(run, evidence, figures) for run in evidence.runs],
        **_memory(evidence),
    )


def write_report(evidence: Evidence, folder: Path) -> tuple[Path, dict[str, Any]]:
    """Write report.html, summary.json and the drawings into a folder: the report and the summary.

    Drawings of an earlier report that are not drawn any more are removed.
    """
    figures = Figures()
    text = _page(evidence, figures)
    for old in (folder / "figures").glob("*.svg"):
        if old.stem not in figures.named:
            old.unlink()
    for name, figure in figures.named.items():
        atomic_write(folder / "figures" / f"{name}.svg", figure.drawing.svg())
    values = summary(evidence)
    atomic_write(folder / "summary.json", json.dumps(values, indent=1) + "\n")
    report = folder / "report.html"
    atomic_write(report, text)
    return report, values
