# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Task table as a picture, for slides and lab reports."""

from __future__ import annotations

from matplotlib.figure import Figure

from ravenbrick.trace.measures import RunMeasures
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import TaskMeasures

__all__ = ["TASK_COLUMNS", "task_cells", "tasks_figure"]

TASK_COLUMNS = (
    "task",
    "releases",
    "response min",
    "response mean",
    "response max",
    "release jitter",
    "deadline",
    "misses",
    "processor",
)


def _cycles(recording: Recording, cycles: float | None) -> str:
    if cycles is None:
        return "none"
    microseconds = 1e6 * cycles / float(recording.clock.hertz)
    return f"{cycles:,.0f} ({microseconds:,.1f} µs)".replace(",", " ")


def _deadline(recording: Recording, task: TaskMeasures) -> str:
    if task.deadline_cycles is None:
        return "none"
    return f"{1000 * recording.clock.seconds(task.deadline_cycles):,.0f} ms"


def task_cells(recording: Recording, task: TaskMeasures, share: float) -> tuple[str, ...]:
    """The row of a task: cycles with microseconds in brackets."""
    return (
        task.name,
        str(task.releases),
        _cycles(recording, task.response_time_cycles_min),
        _cycles(recording, task.response_time_cycles_mean),
        _cycles(recording, task.response_time_cycles_max),
        _cycles(recording, task.release_jitter_cycles),
        _deadline(recording, task),
        str(task.deadline_misses) if task.deadline_cycles is not None else "none",
        f"{100 * share:.2f} %",
    )


def tasks_figure(recording: Recording, measures: RunMeasures) -> Figure:
    """All tasks of a run; times in cycles (µs)."""
    rows = [
        task_cells(recording, t, s) for t, s in zip(measures.tasks, measures.shares, strict=True)
    ]
    figure = Figure(figsize=(11.5, 0.3 + 0.32 * (len(rows) + 1)))
    axis = figure.add_axes((0.01, 0.02, 0.98, 0.96))
    axis.set_axis_off()
    table = axis.table(cellText=rows, colLabels=TASK_COLUMNS, loc="center", cellLoc="right")
    table.auto_set_font_size(False)
    table.set_fontsize(9)
    table.scale(1.0, 1.5)
    table.auto_set_column_width(list(range(len(TASK_COLUMNS))))
    for (row, _column), cell in table.get_celld().items():
        cell.set_edgecolor("#d0d0d0")
        cell.visible_edges = "B"
        if row == 0:
            cell.get_text().set_fontweight("bold")
    return figure
