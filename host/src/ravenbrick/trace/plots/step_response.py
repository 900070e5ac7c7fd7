# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step response: continuous design, sampled simulation, on the brick."""

from __future__ import annotations

import math

from matplotlib.figure import Figure

from ravenbrick.trace.design import Design
from ravenbrick.trace.measures import StepRecord
from ravenbrick.trace.motion import SETTLING_BAND, WINDOW
from ravenbrick.trace.plots.style import COLOURS, degrees_per_second, legend, new_figure

__all__ = ["step_response_figure"]

SHOWN = 0.8


def step_response_figure(design: Design | None, record: StepRecord) -> Figure:
    """Response of one motor's speed to a step of the set-point, in degrees/s over s."""
    figure, (axis,) = new_figure(8.0, 4.4)
    height = math.degrees(record.measures.setpoint)
    axis.step(
        record.difference_times,
        degrees_per_second(record.difference),
        color=COLOURS["faint"],
        linewidth=0.6,
        zorder=1,
        where="post",
        label="difference of counts over 4 ms, as read (250 °/s per count)",
    )
    axis.axhline(height, color=COLOURS["setpoint"], linewidth=1, linestyle=":", label="set-point")
    axis.axhspan(
        height * (1 - SETTLING_BAND),
        height * (1 + SETTLING_BAND),
        color=COLOURS["grid"],
        zorder=0,
        label=f"±{100 * SETTLING_BAND:.0f} %",
    )
    if design is not None:
        axis.plot(
            design.continuous.times,
            design.continuous.values * height,
            color=COLOURS["design"],
            linewidth=1.2,
            linestyle="--",
            zorder=3,
            label="continuous design",
        )
        axis.plot(
            design.sampled.times,
            design.sampled.values * height,
            color=COLOURS["sampled"],
            linewidth=1.2,
            linestyle="-.",
            zorder=4,
            label="sampled simulation",
        )
    axis.plot(
        record.times,
        degrees_per_second(record.fitted),
        color=COLOURS["left"],
        linewidth=2.4,
        alpha=0.75,
        label=f"on the brick (slope fit, {1000 * WINDOW:.0f} ms)",
    )
    settled = record.measures.settling_time
    if settled is not None:
        axis.axvline(settled, color=COLOURS["left"], linewidth=0.8, linestyle=":")
        axis.annotate(
            f"settled after {1000 * settled:.0f} ms",
            (settled, 0.45 * height),
            xytext=(6, 0),
            textcoords="offset points",
            fontsize=9,
            color=COLOURS["left"],
        )
    axis.set_xlim(0, min(SHOWN, float(record.times[-1])))
    axis.set_ylim(-0.05 * height, 1.6 * height)
    axis.set_xlabel("time after the step (s)")
    axis.set_ylabel(f"speed of motor {record.motor} (°/s)")
    legend(axis, "upper right", 2)
    return figure
