# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of sheet 10: the balancing robot."""

from __future__ import annotations

from typing import Any

import control
import numpy as np
from numpy.typing import NDArray
from ravenbrick.control import lqr, with_integrators
from ravenbrick.model import NXTWAY_GS

from tools.docs.figures import COLOURS, SERIES, legend, new_figure, picture, run

SAMPLE_TIME = 0.004
GAINS_LINE = "return np.asarray(feedback.gain[0] * scale)"
WHEEL_RATE_SHARE = 0.85
LOW_PASS, REST_SHARE = 0.8, 0.999

Vector = NDArray[np.float64]


def _gain(share: float) -> Vector:
    """The published state feedback with a share of its pitch gain, shape (5,)."""
    plant = with_integrators(NXTWAY_GS.state_space(), [[1.0, 0.0, 0.0, 0.0]])
    feedback = lqr(plant, [1.0, 6e5, 1.0, 1.0, 4e2], [1e3, 1e3])
    return np.asarray(feedback.gain[0] * [1.0, share, WHEEL_RATE_SHARE, 1.0, 1.0])


def _arrow(axis: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    axis.annotate("", end, start, arrowprops={"arrowstyle": "->", "color": "black"})


def geometry() -> str:
    """The robot from the side, to scale in mm."""
    radius, centre = 1000 * NXTWAY_GS.wheel_radius, 500 * NXTWAY_GS.body_height
    pitch, turn = np.radians(18.0), np.radians(50.0)
    figure, (axis,) = new_figure(6.5, 4.2)
    axis.grid(False)
    axis.set_axis_off()
    axis.set_aspect("equal")
    circle = np.linspace(0, 2 * np.pi, 200)
    axis.plot(radius * np.cos(circle), radius + radius * np.sin(circle), color=SERIES[0], lw=2)
    along = np.array([np.sin(pitch), np.cos(pitch)])
    across = np.array([np.cos(pitch), -np.sin(pitch)]) * 20
    axle, top = np.array([0.0, radius]), np.array([0.0, radius]) + 2 * centre * along
    box = np.array([axle - across, axle + across, top + across, top - across, axle - across])
    axis.plot(*box.T, color=SERIES[1], lw=2)
    middle = axle + centre * along
    axis.plot(*np.array([axle, middle]).T, color=SERIES[1], lw=1)
    axis.plot(*middle, "o", color=SERIES[1])
    axis.plot([0, 0], [radius, radius + 2.3 * centre], color=COLOURS["grid"], ls="--")
    axis.plot([-110, 130], [0, 0], color="black", lw=1)
    mark = axle + radius * np.array([np.sin(turn), np.cos(turn)])
    axis.plot(*np.array([axle, mark]).T, color=SERIES[0], lw=1)
    for angle, length in ((pitch, 1.6 * centre), (turn, 0.6 * radius)):
        arc = np.linspace(0, angle, 30)
        axis.plot(length * np.sin(arc), radius + length * np.cos(arc), color="black", lw=1)
    axis.text(0.1 * centre, radius + 1.7 * centre, r"$\psi$", fontsize=14)
    axis.text(10, radius + 0.72 * radius, r"$\theta$", fontsize=14)
    axis.text(middle[0] + 34, middle[1] - 4, f"centre of mass, M\nL = {centre:.0f} mm", fontsize=9)
    axis.text(-radius - 4, radius, f"wheels, m\nR = {radius:.0f} mm", fontsize=9, ha="right")
    _arrow(axis, (-100, 100), (-60, 100))
    axis.text(-100, 106, "forwards", fontsize=9)
    return picture(figure)


def _one_sample(
    state: Vector, gain: Vector, parts: tuple[bool, bool], motion: control.StateSpace
) -> Vector:
    """Robot and program after a sample, with low-pass filter, with tracked offset and delay."""
    low_pass, rest_and_delay = parts
    robot, (pitch, integral, speed, last, rest, waiting) = np.split(state, [4])
    rest = REST_SHARE * rest + (1 - REST_SHARE) * robot[3] if rest_and_delay else 0.0
    rate = robot[3] - rest
    angle = robot[0] - robot[1] + pitch
    slope = (angle - last) / SAMPLE_TIME
    speed = LOW_PASS * speed + (1 - LOW_PASS) * slope if low_pass else robot[2]
    volts = -float(gain @ [angle, pitch, speed, rate, integral])
    robot = motion.A @ robot + motion.B.sum(axis=1) * (waiting if rest_and_delay else volts)
    memory = pitch + SAMPLE_TIME * rate, integral + SAMPLE_TIME * angle, speed, angle, rest, volts
    return np.concatenate([robot, memory])


def _growth(share: float, parts: tuple[bool, bool]) -> float:
    """Real part in 1/s of the oscillation between 3 and 50 rad/s; NaN without one."""
    motion = control.sample_system(NXTWAY_GS.state_space(), SAMPLE_TIME, "zoh")
    gain = _gain(share)
    columns = [_one_sample(unit, gain, parts, motion) for unit in np.eye(10)]
    values = np.linalg.eigvals(np.column_stack(columns)).astype(complex)
    poles = np.log(values[np.abs(values) > 1e-6]) / SAMPLE_TIME
    return max((float(p.real) for p in poles if 3 < p.imag < 50), default=float("nan"))


def growth() -> str:
    """Growth of the pitching oscillation against the share of the pitch gain."""
    shares = np.linspace(0.1, 0.7, 61)
    figure, (axis,) = new_figure(6.5, 3.2)
    for colour, line, parts, name in (
        (SERIES[0], "--", (False, False), "as designed"),
        (SERIES[2], "-.", (True, False), "with the low-pass filter"),
        (SERIES[1], "-", (True, True), "and with tracked offset and a sample of delay"),
    ):
        curve = [_growth(share, parts) for share in shares]
        axis.plot(shares, curve, color=colour, label=name, ls=line)
    axis.axhline(0, color="black", lw=1)
    axis.set_xlabel("pitch gain / published pitch gain")
    axis.set_ylabel("growth (1/s)")
    axis.set_ylim(-3, 2)
    legend(axis, "upper right")
    return picture(figure)


def let_go() -> str:
    """Pitch after the push with three pitch gains, from the virtual brick."""
    figure, axes = new_figure(6.5, 5.0, rows=3)
    for axis, share, colour in zip(axes, (1.0, 0.4, 0.33), SERIES, strict=False):
        edit = GAINS_LINE.replace("scale)", f"scale * [1, {share}, 1, 1, 1])")
        recording = run("balance", "let-go", {"design.py": [(GAINS_LINE, edit)]})
        time, pitch = recording.signal("body.pitch")
        axis.plot(time, np.degrees(pitch), color=colour)
        axis.set_title(f"{share:g} of the published pitch gain", fontsize=9, loc="left")
        axis.set_ylabel("pitch (°)")
        axis.set_ylim(-24, 24)
        axis.set_xlim(5.5, 9.0)
        axis.axvspan(6.0, 6.1, color=COLOURS["grid"])
    axes[-1].set_xlabel("time (s)")
    return picture(figure)


def offset() -> str:
    """The path with and without tracking of the gyro's offset, and the prediction."""
    figure, (axis,) = new_figure(6.5, 3.4)
    share = "Rest_Share : constant := "
    for value, name, colour in (
        ("0.999", "offset tracked", SERIES[0]),
        ("1.0", "offset not tracked", SERIES[1]),
    ):
        edits = {"src/balance.adb": [(f"{share}0.999", share + value)]}
        time, x = run("balance", "stand", edits).signal("body.x")
        axis.plot(time, 1000 * x, color=colour, label=name, lw=1)
    error, gain = np.radians(0.4), _gain(1.0)
    after = np.array([0.0, 60.0])
    angle = -gain[1] / gain[4] * error - error * after
    radius = 1000 * NXTWAY_GS.wheel_radius
    axis.plot(2 + after, radius * angle, color="black", ls="--", lw=1, label="predicted")
    axis.set_xlabel("time (s)")
    axis.set_ylabel("path (mm)")
    axis.set_ylim(-100, 60)
    legend(axis, "lower left", 3)
    return picture(figure)
