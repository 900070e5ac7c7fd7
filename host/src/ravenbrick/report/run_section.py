# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What the report shows of one run: signals, path, LCD, tasks and schedule."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from ravenbrick.report.page import Figure, Figures, Row
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

__all__ = ["compared", "run_section"]

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


def compared(evidence: Evidence) -> list[Run]:
    """The drives with and without the controller, when both went somewhere."""
    runs = [evidence.with_role(role) for role in ("drive", "open_loop")]
    both = [run for run in runs if run is not None and moved(run.recording)]
    return both if len(both) == 2 else []


def _task_table(run: Run, bounds: Mapping[str, int]) -> tuple[Row, list[Row]]:
    """Head and rows; without the column of bounds where none is known."""
    rows = [
        task_cells(run.recording, task, share, bounds.get(task.name))
        for task, share in zip(run.measures.tasks, run.measures.shares, strict=True)
    ]
    if any(task.name in bounds for task in run.measures.tasks):
        return TASK_COLUMNS, rows
    place = TASK_COLUMNS.index("bound")
    head, *rows = ((*row[:place], *row[place + 1 :]) for row in (TASK_COLUMNS, *rows))
    return head, rows


def _slowest(run: Run, figures: Figures, name: str) -> Figure | None:
    """A close look at the job that came nearest to its deadline."""
    found = slowest_job(run.robot, run.recording)
    if found is None:
        return None
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
    drawing = schedule_drawing(run.robot, run.recording, window)
    return figures.add(f"{name}-slowest", drawing, caption)


def _schedules(run: Run, figures: Figures, name: str) -> Iterator[Figure | None]:
    """The schedule: some periods, their beginning, and the longest response."""
    recording = run.recording
    window = overview(run.robot, recording)
    milliseconds = 1000 * recording.clock.seconds(window.end - window.begin)
    yield figures.add(
        f"{name}-schedule",
        schedule_drawing(run.robot, recording, window),
        f"Schedule of {milliseconds:.0f} ms with all tasks at work",
    )
    yield figures.add(
        f"{name}-schedule-close",
        schedule_drawing(run.robot, recording, close_up(recording, window)),
        "Its beginning from close by: tasks released together wait for those of higher priority",
    )
    yield _slowest(run, figures, name)


def _processor(run: Run, evidence: Evidence, figures: Figures, name: str) -> dict[str, Any]:
    """Response times, task table, schedule; distributions of the main run only."""
    recording = run.recording
    if not recording.threads:
        return {"distributions": None}
    # None for a brick that ran beside the project's own.
    bounds = evidence.bounds if run.robot.name == evidence.robot.name else {}
    responses = figures.add(
        f"{name}-responses",
        responses_drawing(recording, run.measures, bounds),
        "Response times: nominal release to completion. Bars: jobs, on a logarithmic scale",
    )
    schedules = list(_schedules(run, figures, name))
    distributions = None
    if run is evidence.main and (run.task_dynamics or run.handler_dynamics):
        distributions = dynamics_drawing(recording.clock, run.task_dynamics, run.handler_dynamics)
    head, rows = _task_table(run, bounds)
    return {
        "responses": responses,
        "task_head": head,
        "task_rows": rows,
        "schedules": schedules,
        "distributions": figures.add(
            f"{name}-dynamics",
            distributions,
            "All jobs and all calls of interrupt handlers of the run; counts on a logarithmic "
            "scale. Blocked: the processor was with tasks of lower base priority between release "
            "and completion",
        ),
    }


def run_section(run: Run, evidence: Evidence, figures: Figures) -> dict[str, Any]:
    """What the template shows of one run."""
    recording, name = run.recording, anchor(run)
    path = None
    if moved(recording) and run not in compared(evidence):
        path = path_drawing(run.robot, [(run.scenario.name, recording)])
    signals = signals_drawing(run.robot, run.scenario, recording, moved(recording))
    return {
        "run": run,
        "anchor": name,
        "title": run_title(run),
        "seconds": recording.clock.seconds(recording.stop.at_cycles),
        "ended": ENDS.get(recording.stop.reason, recording.stop.reason),
        "signals": figures.add(f"{name}-signals", signals, "Signals of the run"),
        "path": figures.add(f"{name}-path", path, "Path from above"),
        "pictures": [
            figures.add(
                f"{name}-lcd-{number}",
                lcd_drawing(picture),
                f"LCD after {recording.clock.seconds(picture.at_cycles):.3f} s",
            )
            for number, picture in enumerate(recording.pictures, 1)
        ],
        **_processor(run, evidence, figures, name),
    }
