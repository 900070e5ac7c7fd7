# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step response: continuous design, sampled simulation, on the brick."""

from __future__ import annotations

import math

import numpy as np

from ravenbrick.installation import brick_module
from ravenbrick.report.chart import COLOURS, SERIES, Drawing, Panel
from ravenbrick.trace.design import Design
from ravenbrick.trace.measures import StepRecord

__all__ = ["DESIGNED", "step_drawing"]

WIDTH, HEIGHT, LEFT, TOP = 930, 400, 62, 62
SHOWN = 0.8
DESIGNED = {
    "continuous": ("continuous design", COLOURS["design"], "6 3"),
    "sampled": ("sampled simulation", COLOURS["sampled"], "7 2 2 2"),
}


def _band(panel: Panel, height: float, share: float) -> None:
    """The tolerance that a settled response stays in."""
    top, bottom = (float(panel.at_y(height * (1 + s * share))) for s in (1, -1))
    panel.drawing.rectangles([(panel.left, top, panel.width, bottom - top)], "#d5d8dc")
    panel.horizontal(height, COLOURS["setpoint"], 1.2, "2 3")


def step_drawing(design: Design | None, record: StepRecord) -> Drawing:
    """Response of one motor's speed to a step of the set-point, in degrees/s over s."""
    brick = brick_module()
    height = math.degrees(record.measures.setpoint or record.measures.final_value)
    drawing = Drawing(WIDTH, HEIGHT, f"Step response of motor {record.motor}")
    low, high = sorted((-0.08 * height, 1.45 * height)) if height else (-1.0, 1.0)
    place = (LEFT, TOP, WIDTH - LEFT - 14, HEIGHT - TOP - 40)
    panel = Panel(drawing, *place, (0.0, min(SHOWN, float(record.times[-1]))), (low, high))
    _band(panel, height, brick.SETTLING_BAND)
    panel.x_axis("time after the step (s)")
    panel.y_axis()
    drawing.text(LEFT, 16, f"speed of motor {record.motor} (°/s)", bold=True)
    fitted = f"on the brick (slope fit, {1000 * brick.SPEED_WINDOW:.0f} ms)"
    entries = [("difference of counts over 4 ms", COLOURS["raw"], ""), (fitted, SERIES[0], "")]
    shown = record.difference_times <= panel.x[1]
    panel.line(
        record.difference_times[shown], np.degrees(record.difference[shown]), COLOURS["raw"], 0.8,
        held=True,
    )  # fmt: skip
    within = record.times <= panel.x[1]
    panel.line(record.times[within], np.degrees(record.fitted[within]), SERIES[0], 3)
    lines = [(f"set-point ±{100 * brick.SETTLING_BAND:.0f} %", COLOURS["setpoint"], "2 3")]
    for name, response in (design.responses if design else {}).items():
        label, colour, dash = DESIGNED[name]
        near = response.times <= panel.x[1]
        panel.line(response.times[near], response.values[near] * height, colour, 1.6, dash=dash)
        lines.append((label, colour, dash))
    panel.legend(lines)
    Panel(drawing, LEFT, TOP - 20, *place[2:], panel.x, panel.y).legend(entries)
    settled = record.measures.settling_time
    if settled is not None and settled <= panel.x[1]:
        panel.vertical(settled, SERIES[0], 1, "3 3")
        x, y = float(panel.at_x(settled)) + 7, float(panel.at_y(0.4 * height))
        drawing.text(x, y, f"settled after {1000 * settled:.0f} ms", colour=SERIES[0])
    return drawing
