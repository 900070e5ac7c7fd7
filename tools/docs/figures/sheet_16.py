# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the term project: its requirements on the step and on the straight line."""

from __future__ import annotations

import math

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, run

SETTLING_TIMES = (0.4, 0.3)
PRESSED_S = 1.0
SPEED = math.radians(4 * 116.0)


def _design(settling_time: float) -> Edits:
    """Of the template `vehicle`: a design for another settling time."""
    return {"design.py": [("SETTLING_TIME = 0.4", f"SETTLING_TIME = {settling_time}")]}


def step() -> str:
    """Speed after a step on the bench with two designs, and the limits of R5."""
    figure, (axes,) = new_figure(7.0, 3.2)
    axes.axhspan(0.98 * SPEED, 1.02 * SPEED, color="0.9")
    for limit in (0.25, 0.35):
        axes.axvline(limit, color="black", linestyle=":", linewidth=1)
    for settling_time, colour in zip(SETTLING_TIMES, (SERIES[1], SERIES[0]), strict=True):
        seconds, speed = run("vehicle", "step", _design(settling_time)).signal(
            "motor.B.angular_velocity"
        )
        name = f"design for {settling_time} s"
        axes.plot(seconds - PRESSED_S, speed, color=colour, label=name, linewidth=2)
    axes.set(xlabel="time since the touch sensor was pressed (s)", ylabel="left wheel (rad/s)")
    axes.set(xlim=(0, 0.6), ylim=(0, 9))
    legend(axes, "lower right")
    return picture(figure)


def line() -> str:
    """Paths over 2 m without a controller and with two designs, and the limit of R6."""
    figure, (axes,) = new_figure(7.0, 3.2)
    runs = [("without a controller", run("vehicle", "drive-open-loop"))]
    for settling_time in SETTLING_TIMES:
        name = f"design for {settling_time} s"
        runs.append((name, run("vehicle", "drive", _design(settling_time))))
    for (name, recording), colour in zip(runs, (SERIES[2], SERIES[1], SERIES[0]), strict=True):
        (_, x), (_, y) = recording.signal("body.x"), recording.signal("body.y")
        shown = (x < 2.05) & (y < 0.35)
        last = shown.argmin() if not shown.all() else len(x)
        axes.plot(x[:last], 100 * y[:last], color=colour, label=name, linewidth=2)
    axes.plot(2.0, 6.0, "x", color="black", markersize=10, label="limit of R6")
    axes.set(xlabel="along the line (m)", ylabel="beside it (cm)", ylim=(-1, 32))
    legend(axes, "upper left")
    return picture(figure)
