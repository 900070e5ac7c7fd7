# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of sheet 9: an angle controlled over a speed, and the wheels of a vehicle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ravenbrick.trace.recording import Recording

from tools.docs.figures import COLOURS, SERIES, Edits, legend, new_figure, picture, run

LAG_S, BASE_GAIN, DEGREES_PER_VOLT = 0.1, 2.5, 116.0
TARGET, LIMIT = 360.0, 366.0
TRACKING = "Speed_Controller.Parameters.Tracking_Gain_Per_Job := 0.0;"
# From the angle to the voltage without a speed loop, in V per degree: 1 / (4 * 36.9 ms * 116).
SINGLE_GAIN = 0.0584

Values = NDArray[np.float64]


def _edits(factor: float, fastest: float, line: tuple[str, str] | None = None) -> Edits:
    """Of the template `motor`; `line`: a line of bench.adb and what follows it."""
    gain, limit = "return 1.0 / (4", "Fastest      : constant := 5.0"
    bench = [(limit, limit.replace("5.0", str(fastest)))]
    if line:
        bench.append((line[0], "\n      ".join(line)))
    return {
        "design.py": [(gain, gain.replace("1.0", str(float(factor))))],
        "src/bench.adb": bench,
    }


def _turn(edits: Edits) -> tuple[Values, Values]:
    """Time since the start (s) and angle (degrees)."""
    times, angle = run("motor", "position", edits).signal("motor.B.angle")
    return times - 1.0, np.degrees(angle)


def _box(axis: Any, x: float, text: str, width: float = 0.9) -> None:
    style = {"boxstyle": "square,pad=0", "fc": "white"}
    axis.add_patch(_rectangle(x - width / 2, -0.3, width, 0.6))
    axis.text(x, 0, text, ha="center", va="center", fontsize=10, bbox=style | {"ec": "none"})


def _rectangle(x: float, y: float, width: float, height: float) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x, y), width, height, fill=False, lw=1.2)


def _lines(axis: Any, *points: tuple[float, float]) -> None:
    """Straight lines through the points, the last with a head."""
    if len(points) > 2:
        axis.plot(*np.array(points[:-1]).T, color="black", lw=1.2)
    arrow = {"arrowstyle": "->", "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    axis.annotate("", points[-1], points[-2], arrowprops=arrow)


def cascade() -> str:
    """The block diagram."""
    figure, (axis,) = new_figure(8.0, 2.6)
    axis.grid(False)
    axis.set_axis_off()
    axis.set(xlim=(-0.6, 9.3), ylim=(-1.75, 1.0))
    for x in (0.6, 4.0):
        axis.plot(x, 0, "o", ms=14, mfc="white", mec="black")
        axis.text(x, 0, "Σ", ha="center", va="center", fontsize=9)
        axis.text(x + 0.12, -0.48, "-", fontsize=12)
    for x, text in ((1.6, "$k$"), (2.8, "limit"), (5.1, "PI"), (6.3, "motor"), (8.0, r"$\int$")):
        _box(axis, x, text, 0.8)
    ends = ((-0.5, 0.42), (0.78, 1.2), (2.0, 2.4), (3.2, 3.82), (4.18, 4.7), (5.5, 5.9))
    for begin, end in (*ends, (6.7, 7.6), (8.4, 9.2)):
        _lines(axis, (begin, 0), (end, 0))
    _lines(axis, (7.1, 0), (7.1, -0.9), (4.0, -0.9), (4.0, -0.22))
    _lines(axis, (8.7, 0), (8.7, -1.5), (0.6, -1.5), (0.6, -0.22))
    for x, y, text in (
        (-0.05, 0.15, "target"),
        (3.5, 0.62, "set-point\nof the speed"),
        (7.15, 0.15, "speed"),
        (8.85, 0.15, "angle"),
        (5.55, -0.84, "inner loop"),
        (4.65, -1.44, "outer loop"),
    ):
        axis.text(x, y, text, ha="center", va="bottom" if y < 0.5 else "center", fontsize=9)
    return picture(figure)


def load() -> str:
    """The angle under a load, with the cascade and with one proportional loop."""
    figure, (axis,) = new_figure(7.0, 3.0)
    own = "Now.Control := Outputs.Corrected_Voltage;"
    wanted = f"{SINGLE_GAIN} * Float (Target_Angle - Now.Angle)"
    single = f"Now.Control := Float'Max (-Supply, Float'Min (Supply, {wanted}));"
    for edits, name, colour in (
        (_edits(1, 5.0), "cascade", SERIES[0]),
        (_edits(1, 5.0, (own, single)), "one proportional loop", SERIES[1]),
    ):
        times, angle = _turn(edits)
        axis.plot(times - 3.0, angle, color=colour, label=name, lw=2)
    axis.axhline(TARGET, color="black", ls=":", lw=1)
    axis.set(xlabel="time since the load (s)", ylabel="angle (°)", xlim=(-0.3, 1.5))
    axis.set_ylim(351, 361.5)
    legend(axis, "center right")
    return picture(figure)


def _limited(ratio: Values, fastest: float) -> Values:
    """Overshoot in degrees when the set-point leaves the limit."""
    damping = np.sqrt(ratio) / 2
    under = np.sqrt(1 - damping**2)
    share = np.sqrt(ratio) * np.exp(-damping * (math.pi - np.arccos(damping)) / under)
    return np.asarray(fastest * DEGREES_PER_VOLT * LAG_S * share)


def damping() -> str:
    """Overshoot over the ratio of the bandwidths, by the formulas and recorded."""
    figure, (axis,) = new_figure(7.0, 3.6)
    ratio = np.linspace(0.45, 3.999, 300)
    zeta = np.sqrt(ratio) / 2
    free = TARGET * np.exp(-math.pi * zeta / np.sqrt(1 - zeta**2))
    axis.plot(ratio, free, "--", color="0.4", label="no limit")
    for fastest, factors, colour in (
        (5.0, (1, 1.5, 2, 3, 4, 8), SERIES[0]),
        (2.0, (1, 2, 4, 8), SERIES[1]),
    ):
        axis.plot(ratio, _limited(ratio, fastest), color=colour, label=f"limit {fastest:g} V")
        for factor in factors:
            times, angle = _turn(_edits(factor, fastest))
            peak = max(0.0, float(angle[times < 3.0].max()) - TARGET)
            axis.plot(1 / (factor * BASE_GAIN * LAG_S), peak, "o", color=colour)
    axis.axhline(LIMIT - TARGET, color="black", ls=":", lw=1)
    axis.set(xlabel="n, inner bandwidth / outer bandwidth", ylabel="overshoot (°)")
    axis.set(xlim=(0.4, 4.1), ylim=(-1, 62))
    legend(axis, "upper right")
    return picture(figure)


def turns() -> str:
    """A whole turn with three outer gains, and with a lower limit."""
    figure, (axis,) = new_figure(7.0, 3.4)
    for (factor, fastest, style), colour in zip(
        ((1, 5.0, "-"), (2, 5.0, "-"), (4, 5.0, "-"), (4, 2.0, "--")), SERIES, strict=False
    ):
        times, angle = _turn(_edits(factor, fastest))
        name = f"gain x {factor}, limit {fastest:g} V"
        axis.plot(times, angle, style, color=colour, label=name, lw=1.8)
    axis.axhline(LIMIT, color="black", ls=":", lw=1)
    axis.set(xlabel="time since the start (s)", ylabel="angle (°)", xlim=(0, 2.6), ylim=(0, 400))
    legend(axis, "lower right")
    return picture(figure)


def windup() -> str:
    """Four times the gain with limit, without limit, and without limit and tracking."""
    figure, (axis,) = new_figure(7.0, 3.2)
    off = ("Speed_Controller.Parameters.Saturation := Supply;", TRACKING)
    for edits, name, colour in (
        (_edits(4, 5.0), "limit 5 V", SERIES[0]),
        (_edits(4, 50.0), "no limit", SERIES[1]),
        (_edits(4, 50.0, off), "no limit, no tracking", SERIES[2]),
    ):
        times, angle = _turn(edits)
        axis.plot(times, angle, color=colour, label=name, lw=1.8)
    axis.axhline(TARGET, color="black", ls=":", lw=1)
    axis.set(xlabel="time since the start (s)", ylabel="angle (°)", xlim=(0, 2.4), ylim=(0, 600))
    legend(axis, "lower right")
    return picture(figure)


def _drives() -> list[tuple[str, str, Recording]]:
    return [
        ("without the controller", SERIES[1], run("vehicle", "drive-open-loop")),
        ("with the controller", SERIES[0], run("vehicle", "drive")),
    ]


def paths() -> str:
    """The vehicle from above until the first curve of the joystick."""
    figure, (axis,) = new_figure(7.0, 4.0)
    for name, colour, recording in _drives():
        times, x = recording.signal("body.x")
        y = recording.signal("body.y")[1]
        before = times < 9.9
        axis.plot(x[before], y[before], color=colour, label=name, lw=2)
    axis.axhline(0, color=COLOURS["grid"], ls="--")
    axis.set_aspect("equal")
    axis.set(xlabel="x (m)", ylabel="y (m)", xlim=(-0.1, 2.6), ylim=(-0.2, 1.45))
    legend(axis, "upper left")
    return picture(figure)


def heading() -> str:
    """The heading with the controller, and the formula for its error."""
    figure, (axis,) = new_figure(7.0, 2.8)
    recording = run("vehicle", "drive")
    times, angle = recording.signal("body.heading")
    voltages = [recording.signal(f"motor.{port}.voltage")[1] for port in "BC"]
    steady = (times > 3.0) & (times < 9.0)
    left, right = (float(values[steady].mean()) for values in voltages)
    predicted = 28 / 115 * DEGREES_PER_VOLT * (left - right) / 8.06
    axis.plot(times, np.degrees(angle), color=SERIES[0], label="recorded", lw=2)
    axis.axhline(predicted, color=SERIES[1], ls="--", label="by the two voltages")
    axis.set(xlabel="time (s)", ylabel="heading (°)", xlim=(0.8, 6.0), ylim=(-0.1, 1.6))
    legend(axis, "lower right")
    return picture(figure)
