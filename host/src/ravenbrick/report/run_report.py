# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The report: one HTML file with everything inside, and its drawings beside it as SVG."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.report.chart import Drawing
from ravenbrick.report.page import Drawings, Table, counted, table
from ravenbrick.report.plots.path import path_drawing
from ravenbrick.report.plots.step_response import step_drawing
from ravenbrick.report.run_section import anchor, compared, outcome, run_section, run_title
from ravenbrick.trace.design import Design
from ravenbrick.trace.motion import SPEED_FILTER
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
        figures.append((f"{100 * step.measures.overshoot:.2f} %", "overshoot"))
    for role, label in (("drive", "with"), ("open_loop", "without")):
        run = evidence.with_role(role)
        if run is not None and run.measures.path is not None and run.scenario.straight is not None:
            distance = f"{run.scenario.straight.distance:g} m"
            text = f"off the line in {distance}, {label} controller"
            figures.append((_length(run.measures.path.lateral_deviation), text))
    return figures


def _key_figures(evidence: Evidence) -> str:
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
    stacks = [task for task in evidence.memory.tasks if task.used_bytes] if evidence.memory else []
    shares = [
        (t.used_bytes / t.storage_size_bytes, t.name)
        for t in stacks
        if t.used_bytes and t.storage_size_bytes
    ]
    if shares:
        share, name = max(shares)
        figures.append((f"{100 * share:.0f} %", f"of the fullest stack used, {name}"))
    boxes = "".join(f"<div><b>{escape(v)}</b><span>{escape(t)}</span></div>" for v, t in figures)
    return f'<div class="figures">{boxes}</div>'


def _step_section(evidence: Evidence, drawings: Drawings) -> str:
    record = evidence.step_record
    if record is None:
        return ""
    rows = []
    design = evidence.design
    if design is not None:
        for name, response in (
            ("continuous design", design.continuous),
            ("sampled simulation", design.sampled),
        ):
            rows.append((name, _ms(response.settling_time), f"{100 * response.overshoot:.2f} %"))
    for run in evidence.runs:
        for motor, step in run.measures.steps.items():
            settling = _ms(step.measures.settling_time)
            overshoot = f"{100 * step.measures.overshoot:.2f} %"
            name = f"on the brick, motor {motor} (scenario '{run.scenario.name}')"
            rows.append((name, settling, overshoot))
    return (
        "<h2>Step response</h2>"
        "<p>One count of the encoder is 1°, so the difference of two counts 4 ms apart knows only "
        "multiples of 250 °/s (pale). The speed on the brick is therefore measured as the "
        f"{escape(SPEED_FILTER)}.</p>"
        + drawings.figure(
            "step-response", step_drawing(design, record), "Step of the speed set-point"
        )
        + table(("", "settling time (2 %)", "overshoot"), rows)
        + _estimator_table(design)
    )


def _estimator_table(design: Design | None) -> str:
    """What the design found for each way of getting a speed from counts; volts."""
    if design is None or not design.estimators:
        return ""
    rows = [
        (
            estimator.name,
            f"{estimator.quantum:.3f} V",
            _ms(estimator.settling_time),
            f"{100 * estimator.ripple:.2f} %",
            f"{estimator.control_peak_to_peak:.3f} V",
        )
        for estimator in design.estimators
    ]
    head = ("speed from counts", "one count", "settling time", "ripple", "control peak to peak")
    return (
        "<p>Ways to get the speed from counts, simulated in the loop with the same design:</p>"
        + table(head, rows)
    )


def _ms(seconds: float | None) -> str:
    return "never" if seconds is None else f"{1000 * seconds:.1f} ms"


def _comparison_section(evidence: Evidence, drawings: Drawings) -> str:
    """Paths of the drives with and without the controller; nothing unless there are both."""
    both = compared(evidence)
    if not both:
        return ""
    paths = [
        (f"{label} the controller", run.recording)
        for label, run in zip(("with", "without"), both, strict=True)
    ]
    return "<h2>With and without the controller</h2>" + drawings.figure(
        "path",
        path_drawing(evidence.robot, paths),
        "Path from above. Both runs: same image, same motors, same inputs; the second with the "
        "set-point passed to the motors as it is",
    )


def _memory_section(evidence: Evidence) -> str:
    memory = evidence.memory
    if memory is None:
        return ""
    sizes = [
        ("code and constants (text)", str(memory.text)),
        ("initialised data (data)", str(memory.data)),
        ("zeroed data and stacks (bss)", str(memory.bss)),
        (f"used of {memory.available}", str(memory.used)),
        ("free", str(memory.available - memory.used)),
    ]
    stacks = [
        (
            task.name,
            *(
                ("unknown" if n is None else str(n))
                for n in (task.storage_size_bytes, task.used_bytes)
            ),
        )
        for task in memory.tasks
    ]
    parts = [
        (name, *(str(part[k]) for k in ("text", "data", "bss")))
        for name, part in memory.parts.items()
    ]
    text = f"<h2>Memory ({escape(memory.kind)} image)</h2>" + table(("", "bytes"), sizes)
    text += table(("stack of", "Storage_Size", "high-water mark"), stacks)
    return text + (table(("part", "text", "data", "bss"), parts) if parts else "")


def _runs_section(evidence: Evidence) -> str:
    """All runs at a glance; each name leads to the run's own section."""
    rows: list[Sequence[str]] = []
    for run in evidence.runs:
        recording = run.recording
        name = f'<a href="#{anchor(run)}">{escape(run_title(run))}</a>'
        seconds = recording.clock.seconds(recording.stop.at_cycles)
        misses = sum(task.deadline_misses for task in run.measures.tasks)
        rows.append(
            (
                name,
                escape(run.scenario.description),
                outcome(run),
                f"{seconds:.3f} s",
                str(misses),
                f"{100 * run.measures.utilization.busy:.1f} %",
            )
        )
    head = ("run", "", "outcome", "ended after", "misses", "processor")
    text = "<h2>Runs</h2>" + Table(head, rows, text_columns=2, markup=True).html()
    if evidence.same_digest_twice is not None:
        answer = "the same digest" if evidence.same_digest_twice else "ANOTHER digest"
        name = escape(evidence.main.scenario.name)
        text += f"<p>'{name}' was run twice; the second run gave {answer}.</p>"
    return text


def _page(evidence: Evidence, drawings: Drawings) -> str:
    css = resources.files("ravenbrick.report").joinpath("templates/report.css").read_text("utf-8")
    robot = evidence.robot
    sections = [
        _key_figures(evidence),
        _runs_section(evidence),
        _step_section(evidence, drawings),
        _comparison_section(evidence, drawings),
        *(run_section(run, evidence, drawings) for run in evidence.runs),
        _memory_section(evidence),
    ]
    many = counted(len(evidence.runs), "run")
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(robot.name)}: report</title><style>\n{css}</style></head>\n<body>"
        f"<h1>{escape(robot.name)}</h1>"
        f'<p class="lead">{escape(robot.description)}. {many} on the virtual brick.</p>\n'
        + "\n".join(section for section in sections if section)
        + "\n</body></html>\n"
    )


def write_report(evidence: Evidence, folder: Path) -> tuple[Path, dict[str, Any]]:
    """Write report.html, summary.json and the drawings into a folder: the report and the summary.

    Drawings of an earlier report that are not drawn any more are removed.
    """
    drawings = Drawings()
    page, figures = _page(evidence, drawings), summary(evidence)
    kept: dict[str, Drawing] = drawings.drawn
    for old in (folder / "figures").glob("*.svg"):
        if old.stem not in kept:
            old.unlink()
    for name, drawing in kept.items():
        atomic_write(folder / "figures" / f"{name}.svg", drawing.svg())
    atomic_write(folder / "summary.json", json.dumps(figures, indent=1) + "\n")
    report = folder / "report.html"
    atomic_write(report, page)
    return report, figures
