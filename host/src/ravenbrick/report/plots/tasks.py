# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The cells of the task table."""

from __future__ import annotations

from ravenbrick.report.page import Row, percent
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import TaskMeasures

__all__ = ["TASK_COLUMNS", "task_cells"]

TASK_COLUMNS = (
    "task",
    "releases",
    "response min",
    "response mean",
    "response max",
    "release jitter",
    "bound",
    "deadline",
    "misses",
    "processor",
)


def _cycles(recording: Recording, cycles: float | None) -> str | tuple[str, str]:
    """Cycles with microseconds below."""
    if cycles is None:
        return "none"
    microseconds = 1e6 * cycles / float(recording.clock.hertz)
    return f"{cycles:,.0f}".replace(",", " "), f"{microseconds:,.1f} µs".replace(",", " ")


def _deadline(recording: Recording, task: TaskMeasures) -> str:
    if task.deadline_cycles is None:
        return "none"
    return f"{1000 * recording.clock.seconds(task.deadline_cycles):,.0f} ms"


def task_cells(
    recording: Recording, task: TaskMeasures, share: float, bound_cycles: int | None = None
) -> Row:
    """The row of a task."""
    return (
        task.name,
        str(task.releases),
        _cycles(recording, task.response_time_cycles_min),
        _cycles(recording, task.response_time_cycles_mean),
        _cycles(recording, task.response_time_cycles_max),
        _cycles(recording, task.release_jitter_cycles),
        _cycles(recording, bound_cycles),
        _deadline(recording, task),
        str(task.deadline_misses) if task.deadline_cycles is not None else "none",
        percent(share),
    )
