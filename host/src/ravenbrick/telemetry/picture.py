# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of live signals: one axis per unit, and steps over the design."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ravenbrick.errors import printable
from ravenbrick.report.plots.style import COLOURS, legend, new_figure, task_colour
from ravenbrick.telemetry.log import RunLog
from ravenbrick.telemetry.messages import SignalDescription
from ravenbrick.telemetry.steps import LiveStep
from ravenbrick.trace.design import Design

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_signals", "signals_figure", "steps_figure", "units_of", "verbatim"]

_US = 1_000_000
_HEIGHT_PER_AXIS = 2.2
_LEGEND_SHARE = 0.2


def verbatim(text: str) -> str:
    """A text from a brick for a picture: no formula begins in it, and nothing is unprintable."""
    return printable(text).replace("\n", "?").replace("$", r"\$")


def units_of(run: RunLog) -> list[str]:
    """Units of the signals, in the order in which the program names them."""
    signals = (
        s for _, group in sorted(run.groups.items()) for _, s in sorted(group.signals.items())
    )
    return list(dict.fromkeys(signal.unit for signal in signals))


def _plot_signal(
    axis: Axes, run: RunLog, signal: SignalDescription, colour: str, last_s: float | None
) -> None:
    group = run.groups[signal.group]
    column = group.columns.get(signal.position)
    if column is None:
        return
    values = np.array(column)
    times = np.array(group.times_us)[-len(values) :] / _US
    if last_s is not None and times.size:
        shown = times >= times[-1] - last_s
        times, values = times[shown], values[shown]
    axis.plot(times, values, color=colour, linewidth=1.2, label=verbatim(signal.name))


def draw_signals(axes: Sequence[Axes], run: RunLog, last_s: float | None = None) -> None:
    """Draw all signals, or their last seconds, on one axis per unit."""
    for axis, unit in zip(axes, units_of(run), strict=True):
        axis.clear()
        axis.grid(True, color=COLOURS["grid"], linewidth=0.7)
        mine = [
            signal
            for _, group in sorted(run.groups.items())
            for _, signal in sorted(group.signals.items())
            if signal.unit == unit
        ]
        for index, signal in enumerate(mine):
            _plot_signal(axis, run, signal, task_colour(index), last_s)
        axis.set_ylabel(verbatim(f"({unit})") if unit else "value")
        if axis.get_legend_handles_labels()[1]:
            low, high = axis.get_ylim()
            axis.set_ylim(low, high + _LEGEND_SHARE * (high - low))
            legend(axis, "upper left", 4)
    axes[-1].set_xlabel("time since power-on (s)")


def signals_figure(run: RunLog) -> Figure:
    """All signals of a run over its time."""
    count = max(1, len(units_of(run)))
    figure, axes = new_figure(9.0, 0.6 + _HEIGHT_PER_AXIS * count, count)
    if units_of(run):
        draw_signals(axes, run)
    return figure


def steps_figure(steps: Sequence[LiveStep], design: Design, setpoint: str, output: str) -> Figure:
    """Live step responses and the designed ones, per unit of the set-point, over s."""
    figure, (axis,) = new_figure(8.0, 4.4)
    for name, response in design.responses.items():
        label = f"{name} design"
        axis.plot(
            response.times,
            response.values,
            color=COLOURS["design" if name == "continuous" else "sampled"],
            linestyle="--" if name == "continuous" else "-.",
            linewidth=2.0,
            zorder=3,
            label=label,
        )
    for index, step in enumerate(steps):
        axis.plot(
            step.times,
            step.values,
            color=task_colour(index),
            linewidth=0.9,
            alpha=0.8,
            label=f"live, step of {step.height:.3g} at {step.at_s:.2f} s",
        )
    axis.axhline(1.0, color=COLOURS["setpoint"], linewidth=1, linestyle=":", label=setpoint)
    if "sampled" in design.responses:
        axis.set_xlim(0, float(design.responses["sampled"].times[-1]))
    axis.set_xlabel("time after the step (s)")
    axis.set_ylabel(f"{output} per step of {setpoint}")
    legend(axis, "lower right")
    return figure
