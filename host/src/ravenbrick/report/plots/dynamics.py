# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Distributions as small multiples: a row per task and per interrupt source."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ravenbrick.clock import Clock
from ravenbrick.report.chart import COLOURS, Drawing, Panel, task_colour, ticks
from ravenbrick.trace.dynamics import HandlerDynamics, TaskDynamics, histogram

__all__ = ["dynamics_drawing"]

Cycles = NDArray[np.int64]
TASK_TITLES = ("response time (µs)", "release latency (µs)", "execution (µs)")
HANDLER_TITLES = ("duration (µs)", "interval (µs)")
WIDTH, LEFT, ROW, COLUMN, GAP = 930, 200, 104, 228, 18


def _bars(panel: Panel, clock: Clock, values: Cycles, colour: str) -> None:
    """Heights grow with the logarithm of the count, so that a single late job is seen."""
    shown = histogram(values)
    edges = panel.at_x(1e6 * shown.edges_cycles / float(clock.hertz))
    most = math.log(1 + int(shown.counts.max()))
    boxes = []
    for left, right, count in zip(edges[:-1], edges[1:], shown.counts, strict=True):
        if count:
            height = 5 + (panel.height - 22) * math.log(1 + count) / most
            boxes.append((left, panel.bottom - height, max(right - left, 1.2), height))
    panel.drawing.rectangles(boxes, colour)
    worst = f"max {1e6 * int(values.max()) / float(clock.hertz):,.1f}".replace(",", " ")
    right = panel.left + panel.width
    panel.drawing.text(right, panel.top + 10, worst, anchor="end", size=10)


def _cell(
    drawing: Drawing, clock: Clock, left: float, top: float, title: str, values: Cycles, colour: str
) -> None:
    low, high = (1e6 * int(end) / float(clock.hertz) for end in (values.min(), values.max()))
    margin = max(0.06 * (high - low), 0.02 * high, 0.1)
    ranges = (max(low - margin, 0.0), high + margin)
    panel = Panel(drawing, left, top, COLUMN - GAP, ROW - 56, ranges, (0, 1))
    panel.x_axis(title, ticks(*ranges, 4))
    panel.horizontal(0, COLOURS["grid"])
    _bars(panel, clock, values, colour)


def _task_lines(clock: Clock, task: TaskDynamics) -> list[str]:
    blocking = 1e6 * int(task.blocking_cycles.max()) / float(clock.hertz)
    lines = [
        task.name,
        f"priority {task.priority}, {task.response_time_cycles.size} jobs",
        f"preempted {int(task.preemptions.sum())} times",
        f"blocked at most {blocking:.1f} µs",
    ]
    if task.deadline_cycles is not None:
        due = 1000 * clock.seconds(task.deadline_cycles)
        lines.append(f"deadline {due:,.0f} ms, {task.deadline_misses} missed")
    return lines


def _handler_lines(clock: Clock, handler: HandlerDynamics) -> list[str]:
    lines = [f"interrupt {handler.name}", f"{handler.duration_cycles.size} calls"]
    if handler.interval_jitter_cycles is not None:
        spread = 1e6 * handler.interval_jitter_cycles / float(clock.hertz)
        lines.append(f"intervals spread {spread:,.0f} µs".replace(",", " "))
    return lines


def dynamics_drawing(
    clock: Clock, tasks: Sequence[TaskDynamics], handlers: Sequence[HandlerDynamics]
) -> Drawing:
    """Histograms of each task's jobs and of each source's handlers; heights are logarithmic."""
    rows: list[tuple[list[str], list[tuple[str, Cycles]], str]] = []
    for number, task in enumerate(tasks):
        values = (task.response_time_cycles, task.release_latency_cycles, task.execution_cycles)
        columns = list(zip(TASK_TITLES, values, strict=True))
        rows.append((_task_lines(clock, task), columns, task_colour(number)))
    for handler in handlers:
        columns = list(
            zip(HANDLER_TITLES, (handler.duration_cycles, handler.interval_cycles), strict=True)
        )
        rows.append((_handler_lines(clock, handler), columns, COLOURS["interrupts"]))
    drawing = Drawing(WIDTH, ROW * max(len(rows), 1) + 12, "Distributions of jobs and handlers")
    for number, (lines, columns, colour) in enumerate(rows):
        top = ROW * number + 8
        for place, line in enumerate(lines):
            drawing.text(8, top + 14 + 15 * place, line, bold=place == 0, size=11.5)
        for place, (title, shown) in enumerate(columns):
            if shown.size:
                _cell(drawing, clock, LEFT + COLUMN * place, top, title, shown, colour)
    return drawing
