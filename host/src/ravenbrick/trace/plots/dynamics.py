# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Distributions as small multiples: a row per task and per interrupt source."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ravenbrick.target.clock import Clock
from ravenbrick.trace.dynamics import HandlerDynamics, TaskDynamics, histogram
from ravenbrick.trace.plots.style import COLOURS, task_colour

__all__ = ["dynamics_figure"]

Cycles = NDArray[np.int64]
TASK_TITLES = ("response time (µs)", "release latency (µs)", "execution (µs)")
HANDLER_TITLES = ("duration (µs)", "interval (µs)", "")
COLUMNS = len(TASK_TITLES)


def _bars(axis: Axes, clock: Clock, values: Cycles, colour: str) -> None:
    """Counts on a logarithmic axis, so that a single late job is seen."""
    shown = histogram(values)
    edges = 1e6 * shown.edges_cycles / float(clock.hertz)
    axis.bar(edges[:-1], shown.counts, np.diff(edges), align="edge", color=colour)
    axis.set_yscale("log")
    axis.set_ylim(0.7, 30 * max(int(values.size), 2))
    low, high = float(edges[0]), float(edges[-1])
    margin = max(0.06 * (high - low), 0.02 * high, 0.1)
    axis.set_xlim(max(low - margin, 0.0), high + margin)
    axis.xaxis.set_major_locator(MaxNLocator(4))
    worst = 1e6 * int(values.max()) / float(clock.hertz)
    axis.text(
        0.98, 0.95, f"max {worst:,.1f}", transform=axis.transAxes, ha="right", va="top", fontsize=8
    )


def _plain(axis: Axes) -> None:
    axis.grid(True, color=COLOURS["grid"], linewidth=0.7)
    axis.set_axisbelow(True)
    axis.spines[["top", "right"]].set_visible(False)
    axis.tick_params(labelsize=8)


def _task_text(clock: Clock, task: TaskDynamics) -> str:
    blocking = 1e6 * int(task.blocking_cycles.max()) / float(clock.hertz)
    lines = [
        task.name,
        f"priority {task.priority}, {task.response_time_cycles.size} jobs",
        f"preempted {int(task.preemptions.sum())} times",
        f"blocked ≤ {blocking:.1f} µs",
    ]
    if task.deadline_cycles is not None:
        due = 1000 * clock.seconds(task.deadline_cycles)
        lines.append(f"deadline {due:,.0f} ms, {task.deadline_misses} missed")
    return "\n".join(lines)


def _handler_text(clock: Clock, handler: HandlerDynamics) -> str:
    lines = [f"interrupt {handler.name}", f"{handler.duration_cycles.size} calls"]
    if handler.interval_jitter_cycles is not None:
        spread = 1e6 * handler.interval_jitter_cycles / float(clock.hertz)
        lines.append(f"intervals spread {spread:,.0f} µs")
    return "\n".join(lines)


def _row(
    axes: Sequence[Axes],
    clock: Clock,
    text: str,
    columns: Sequence[tuple[str, Cycles]],
    colour: str,
) -> None:
    axes[0].set_axis_off()
    axes[0].text(0.0, 0.95, text, transform=axes[0].transAxes, va="top", fontsize=9)
    for axis, (title, values) in zip(axes[1:], columns, strict=True):
        if not title or not values.size:
            axis.set_axis_off()
            continue
        _plain(axis)
        _bars(axis, clock, values, colour)
        axis.set_xlabel(title, fontsize=8)


def dynamics_figure(
    clock: Clock, tasks: Sequence[TaskDynamics], handlers: Sequence[HandlerDynamics]
) -> Figure:
    """Histograms of each task's jobs and of each source's handlers; counts are logarithmic."""
    rows = max(len(tasks) + len(handlers), 1)
    figure = Figure(figsize=(10.0, 0.3 + 1.45 * rows), layout="constrained")
    grid = figure.subplots(rows, 1 + COLUMNS, squeeze=False, width_ratios=[0.9, 1, 1, 1])
    nothing: Cycles = np.zeros(0, np.int64)
    for place, task in enumerate(tasks):
        values = (task.response_time_cycles, task.release_latency_cycles, task.execution_cycles)
        columns = list(zip(TASK_TITLES, values, strict=True))
        _row(list(grid[place]), clock, _task_text(clock, task), columns, task_colour(place))
    for place, handler in enumerate(handlers, len(tasks)):
        values = (handler.duration_cycles, handler.interval_cycles, nothing)
        columns = list(zip(HANDLER_TITLES, values, strict=True))
        text = _handler_text(clock, handler)
        _row(list(grid[place]), clock, text, columns, COLOURS["interrupts"])
    return figure
