# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The section of one run: outcome, signals, path, LCD, tasks and schedule."""

from __future__ import annotations

import re
from collections.abc import Mapping
from html import escape

from ravenbrick.report.page import Drawings, Table, counted
from ravenbrick.report.plots.dynamics import dynamics_drawing
from ravenbrick.report.plots.lcd import lcd_drawing
from ravenbrick.report.plots.path import moved, path_drawing
from ravenbrick.report.plots.responses import responses_drawing
from ravenbrick.report.plots.schedule import (
    Window,
    close_up,
    overview,
    schedule_drawing,
    slowest_job,
)
from ravenbrick.report.plots.signals import signals_drawing
from ravenbrick.report.plots.tasks import TASK_COLUMNS, task_cells
from ravenbrick.trace.summary import Evidence, Run

__all__ = ["anchor", "compared", "outcome", "run_section", "run_title"]

# How a run may end, as the recording names it.
ENDS = {
    "reached": "at the end of the scenario",
    "power_off": "when the brick was switched off",
    "fault": "with a fault of the program",
    "halted": "when the program halted",
}


def run_title(run: Run) -> str:
    """The name of a run: its scenario, and the robot where it is another brick's."""
    return run.title or run.scenario.name


def anchor(run: Run) -> str:
    """The name of the run's section, and the beginning of its drawings' names."""
    return "run-" + re.sub("[^a-z0-9]+", "-", run_title(run).lower()).strip("-")


def outcome(run: Run) -> str:
    """In two words, as HTML."""
    if run.problem is not None:
        return '<b class="bad">failed</b>'
    if not run.criteria:
        return "nothing to check"
    return '<b class="good">met</b>' if run.met else '<b class="bad">not met</b>'


def _problem(run: Run) -> str:
    if run.problem is None:
        return ""
    lines = escape(run.problem.detail)
    detail = f"<pre>{lines}</pre>" if lines else ""
    return f'<div class="problem"><p>{escape(run.problem.sentence)}</p>{detail}</div>'


def _criteria(run: Run) -> str:
    rows = [
        (
            escape(result.label),
            escape(result.shown),
            '<b class="good">met</b>' if result.met else '<b class="bad">not met</b>',
        )
        for result in run.criteria
    ]
    return Table(("criterion", "measured", ""), rows, markup=True).html() if rows else ""


def compared(evidence: Evidence) -> list[Run]:
    """The drives with and without the controller, when both went somewhere."""
    runs = [evidence.with_role(role) for role in ("drive", "open_loop")]
    both = [run for run in runs if run is not None and moved(run.recording)]
    return both if len(both) == 2 else []


def _path(run: Run, evidence: Evidence, drawings: Drawings, name: str) -> str:
    if not moved(run.recording) or run in compared(evidence):
        return ""
    drawing = path_drawing(run.robot, [(run.scenario.name, run.recording)])
    return drawings.figure(f"{name}-path", drawing, "Path from above")


def _pictures(run: Run, drawings: Drawings, name: str) -> str:
    """The last pictures of the LCD that were kept."""
    text = ""
    for number, picture in enumerate(run.recording.pictures, 1):
        at = run.recording.clock.seconds(picture.at_cycles)
        text += drawings.figure(
            f"{name}-lcd-{number}", lcd_drawing(picture), f"LCD after {at:.3f} s"
        )
    return f'<div class="pictures">{text}</div>' if text else ""


def _bounds(run: Run, evidence: Evidence) -> Mapping[str, int]:
    """Bounds of the project's own brick, none of one that ran beside it."""
    return evidence.bounds if run.robot.name == evidence.robot.name else {}


def _task_table(run: Run, evidence: Evidence) -> str:
    measures, bounds = run.measures, _bounds(run, evidence)
    rows = [
        task_cells(run.recording, task, share, bounds.get(task.name))
        for task, share in zip(measures.tasks, measures.shares, strict=True)
    ]
    head = TASK_COLUMNS
    if not any(task.name in bounds for task in measures.tasks):
        place = head.index("bound")
        return Table(
            (*head[:place], *head[place + 1 :]),
            [(*row[:place], *row[place + 1 :]) for row in rows],
            markup=True,
        ).html()
    return Table(head, rows, markup=True).html()


def _slowest(run: Run, drawings: Drawings, name: str) -> str:
    """A close look at the job that came nearest to its deadline."""
    found = slowest_job(run.robot, run.recording)
    if found is None:
        return ""
    thread, number, job = found
    response = job.response_time_cycles or 0
    window = Window(
        max(job.release_cycles - response // 8, 0),
        min(job.release_cycles + response + response // 8, run.recording.stop.at_cycles),
    )
    clock, task = run.recording.clock, run.recording.threads[thread].name
    caption = (
        f"The longest response, measured by its deadline: job {number} of {task}, released at "
        f"{clock.seconds(job.release_cycles):.6f} s, took {response} cycles "
        f"({1e6 * clock.seconds(response):.1f} µs). The arrow is its release; its own lane is "
        "empty while others had the processor"
    )
    return drawings.figure(
        f"{name}-slowest", schedule_drawing(run.robot, run.recording, window), caption
    )


def _processor(run: Run, evidence: Evidence, drawings: Drawings, name: str) -> str:
    """Response times, task table, schedule."""
    recording, shares = run.recording, run.measures.utilization
    if not recording.threads:
        return "<p>The program ended before any task was known.</p>"
    text = "<h3>Tasks and schedule</h3>" + drawings.figure(
        f"{name}-responses",
        responses_drawing(recording, run.measures, _bounds(run, evidence)),
        "Response times: nominal release to completion. Bars: jobs, on a logarithmic scale",
    )
    text += _task_table(run, evidence)
    text += (
        "<p>Times in cycles of the processor's clock of 48.054857 MHz, observed from outside "
        "without instrumentation. Release jitter: spread of the times from nominal release to "
        f"first execution. Interrupt handlers take {100 * shares.interrupts:.2f} % of the "
        f"processor, the kernel outside of tasks {100 * shares.kernel:.2f} %; it sleeps for "
        f"{100 * shares.idle:.2f} %.</p>"
    )
    window = overview(run.robot, recording)
    text += drawings.figure(
        f"{name}-schedule",
        schedule_drawing(run.robot, recording, window),
        f"Schedule of {1000 * recording.clock.seconds(window.end - window.begin):.0f} ms with all "
        "tasks at work",
    )
    near = close_up(recording, window)
    text += drawings.figure(
        f"{name}-schedule-close",
        schedule_drawing(run.robot, recording, near),
        "Its beginning from close by: tasks released together wait for those of higher priority",
    )
    return text + _slowest(run, drawings, name)


def _distributions(run: Run, drawings: Drawings, name: str) -> str:
    recording = run.recording
    handlers = run.handler_dynamics
    if not (run.task_dynamics or handlers):
        return ""
    return drawings.figure(
        f"{name}-dynamics",
        dynamics_drawing(recording.clock, run.task_dynamics, handlers),
        "All jobs and all calls of interrupt handlers of the run; counts on a logarithmic scale. "
        "Blocked: the processor was with tasks of lower base priority between release and "
        "completion",
    )


def run_section(run: Run, evidence: Evidence, drawings: Drawings) -> str:
    """Everything that one run shows; distributions of the main run only."""
    recording, name = run.recording, anchor(run)
    seconds = recording.clock.seconds(recording.stop.at_cycles)
    ended = ENDS.get(recording.stop.reason, recording.stop.reason)
    stale = (
        '<p class="bad">The image was built again after this run: run it again.</p>'
        if run.image_is_newer
        else ""
    )
    drawn = moved(recording)
    signals = signals_drawing(run.robot, run.scenario, recording, drawn)
    text = (
        f'<section id="{name}"><h2>Run: {escape(run_title(run))}</h2>'
        f'<p class="lead">{escape(run.scenario.description)}</p>'
        f"<p>Ended after {seconds:.6f} s, {escape(ended)}. "
        f"{counted(len(recording.inputs), 'input')}, seed {run.scenario.seed}. "
        f"Trace digest <code>{escape(recording.digest)}</code></p>"
        + stale
        + _problem(run)
        + _criteria(run)
        + drawings.figure(f"{name}-signals", signals, "Signals of the run")
        + _path(run, evidence, drawings, name)
        + _pictures(run, drawings, name)
        + _processor(run, evidence, drawings, name)
    )
    if run is evidence.main:
        text += _distributions(run, drawings, name)
    return text + "</section>"
