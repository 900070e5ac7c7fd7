# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet about line following."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ravenbrick.model import NXT_MOTOR

from tools.docs.figures import COLOURS, SERIES, Edits, legend, new_figure, picture, project, run
from tools.docs.lessons import SHEETS, edited, files_of, steps

SHEET = SHEETS / "11-line.md"
RADIUS, TRACK, YAW_INERTIA = 0.028, 0.115, 0.003
TURN_GAIN = RADIUS * NXT_MOTOR.gain / TRACK
TURN_TIME = NXT_MOTOR.time_constant * (
    1 + 2 * YAW_INERTIA * (RADIUS / TRACK) ** 2 / NXT_MOTOR.inertia
)
DELAY = 0.010
SHIFT_AT, SHIFT = 0.6, 0.016
EDGE_GAIN = 7.5 * 12.5
SPOT = 4.0  # radius in mm
BLACK, WHITE = 0.0784, 0.902
CURVE_ERROR = 0.226851

Vector = NDArray[np.float64]


def _arrow(axis: Any, start: tuple[float, float], end: tuple[float, float], style: str) -> None:
    axis.annotate("", end, start, arrowprops={"arrowstyle": style, "color": "black"})


def geometry() -> str:
    """The vehicle beside the edge, seen from above; lengths in mm."""
    figure, (axis,) = new_figure(7.0, 3.6)
    axis.grid(False)
    axis.set_axis_off()
    axis.set_aspect("equal")
    axis.axhspan(-30, 0, color="0.25")
    angle, middle = np.radians(20.0), np.array([0.0, 55.0])
    ahead = np.array([np.cos(angle), np.sin(angle)])
    left = np.array([-ahead[1], ahead[0]])
    sensor = middle + 110 * ahead
    for side in (-57.5, 57.5):
        wheel = middle + side * left
        axis.plot(*np.array([wheel - 28 * ahead, wheel + 28 * ahead]).T, color=SERIES[0], lw=7)
    axle = np.array([middle - 57.5 * left, middle + 57.5 * left])
    axis.plot(*axle.T, color=SERIES[0], lw=2)
    axis.plot(*np.array([middle, sensor]).T, color=SERIES[1], lw=2)
    axis.plot(*middle, "o", color=SERIES[0])
    axis.plot(*sensor, "o", color=SERIES[1], markersize=9)
    axis.plot([middle[0], 165], [middle[1]] * 2, color=COLOURS["grid"], ls="--")
    turn = np.linspace(0, angle, 20)
    axis.plot(80 * np.cos(turn), middle[1] + 80 * np.sin(turn), color="black", lw=1)
    axis.text(84, middle[1] + 9, r"$\psi$", fontsize=13)
    _arrow(axis, (0.0, 0.0), (middle[0], middle[1] - 3), "<->")
    axis.text(5, 18, "$y$", fontsize=13)
    _arrow(axis, (sensor[0], 0.0), (sensor[0], sensor[1] - 5), "<->")
    axis.text(sensor[0] + 4, 36, "$e$", fontsize=13)
    above, behind = middle + 45 * ahead + 7 * left, middle - 75 * ahead + 8 * left
    axis.text(above[0], above[1], "$a$", fontsize=13)
    axis.text(sensor[0] + 8, sensor[1] + 4, "sensor", fontsize=9)
    _arrow(axis, tuple(middle - 75 * ahead), tuple(middle - 35 * ahead), "->")
    axis.text(behind[0], behind[1], "$v$", fontsize=13)
    axis.text(-115, -20, "line", color="white", fontsize=9)
    axis.set(xlim=(-120, 180), ylim=(-30, 125))
    return picture(figure)


def _brightness(reflectance: Vector) -> Vector:
    return np.asarray((reflectance - BLACK) / (WHITE - BLACK))


def characteristic() -> str:
    """Brightness over the offset: recorded, of a disc, and straight."""
    edits = {
        "src/following.adb": [("Half := Now.Steering * 0.5;", "Half := 0.1;")],
        "robot.toml": [("x = 0.07, y = 0.0 }", "x = 0.07, y = -0.007 }")],
    }
    recording = run("line", "lap", edits)
    (_, y), (_, heading) = recording.signal("body.y"), recording.signal("body.heading")
    _, reflectance = recording.signal("light.3.reflectance")
    offset = 1000 * (y + 0.07 * np.sin(heading) - 0.007 * np.cos(heading))
    last = int(np.argmax(offset > 6))
    figure, (axis,) = new_figure(7.0, 3.2)
    seen = _brightness(reflectance[:last])
    axis.plot(offset[:last], seen, color=SERIES[0], lw=2, label="recorded")
    share = np.clip(np.linspace(-6, 6, 400) / SPOT, -1, 1)
    disc = 0.5 + (share * np.sqrt(1 - share**2) + np.arcsin(share)) / np.pi
    axis.plot(np.linspace(-6, 6, 400), disc, color=SERIES[1], lw=1.5, label="disc")
    axis.plot([-SPOT, SPOT], [0, 1], color="black", ls="--", lw=1, label="design")
    axis.set(xlabel="offset of the sensor (mm)", ylabel="brightness", xlim=(-6, 6))
    legend(axis, "upper left")
    return picture(figure)


def _edge_project(arm: float) -> Edits:
    """Of the template `line`: the sheet's second project, with another arm."""
    folder, files = project("line"), {}
    for step in steps(SHEET.read_text("utf-8")):
        name = step.argument.removeprefix("edge11/")
        if step.kind == "edit" and name != step.argument:
            files[name] = edited((folder / name).read_text("utf-8"), step.content)
    # The picture takes the place of the template's: a project is built before it can be drawn.
    files["robot.toml"] = files["robot.toml"].replace("x = 0.07,", f"x = {arm},")
    files["robot.toml"] = files["robot.toml"].replace("shift.png", "floor.png")
    files["scenarios/shift.toml"] = files_of(SHEET)["edge11/scenarios/shift.toml"]
    return files


def _after_shift(arm: float) -> tuple[Vector, Vector, float]:
    """Seconds since the sensor met the shift, path of the axle (m), and speed (m/s)."""
    edits = _edge_project(arm)
    folder = project("line", edits)
    drawing = files_of(SHEET)["draw_shift.py"].replace('"edge11"', f'"{folder.name}"')
    drawing = drawing.replace("shift.png", "floor.png")
    subprocess.run([sys.executable, "-c", drawing], cwd=folder.parent, check=True)
    recording = run("line", "shift", edits)
    (time, x), (_, y) = recording.signal("body.x"), recording.signal("body.y")
    shown = (x > SHIFT_AT - 0.1) & (x < 2.1)
    time, x, y = time[shown], x[shown], y[shown]
    start = time[np.argmax(x + arm > SHIFT_AT)]
    return time - start, y, float((x[-1] - x[0]) / (time[-1] - time[0]))


def _damping(arm: float, speed: float) -> float:
    return float(arm / 2 * np.sqrt(TURN_GAIN * EDGE_GAIN / speed))


def _step(seconds: Vector, damping: float, speed: float) -> Vector:
    """Step response of the second order."""
    frequency = np.sqrt(TURN_GAIN * EDGE_GAIN * speed)
    root = np.sqrt(1 - damping**2)
    phase = root * frequency * np.maximum(seconds, 0)
    decay = np.exp(-damping * frequency * np.maximum(seconds, 0))
    return np.asarray(1 - decay * (np.cos(phase) + damping / root * np.sin(phase)))


def response() -> str:
    """Path of the axle after the shift, recorded and by both formulas."""
    seconds, y, speed = _after_shift(0.07)
    figure, (axis,) = new_figure(7.0, 3.2)
    axis.plot(seconds, 1000 * y, color=SERIES[0], lw=2, label="recorded")
    shortened = 0.07 - (TURN_TIME + DELAY) * speed
    for arm, style, name in ((0.07, "--", "with $D$"), (shortened, ":", "with $D_e$")):
        path = 1000 * SHIFT * _step(seconds, _damping(arm, speed), speed)
        axis.plot(seconds, path, color="black", ls=style, lw=1.3, label=name)
    axis.set(xlabel="time since the sensor met the shift (s)", ylabel="axle (mm)", xlim=(-0.3, 4))
    legend(axis, "lower right")
    return picture(figure)


def lap() -> str:
    """Brightness in the first part of the lap, and the error predicted for the half circle."""
    time, reflectance = run("line", "lap").signal("light.3.reflectance")
    shown = (time > 2) & (time < 10)
    time, seen = time[shown], _brightness(reflectance[shown])
    figure, (axis,) = new_figure(7.0, 3.0)
    axis.plot(time, seen, color=SERIES[0], lw=0.8, label="recorded")
    width = 500
    mean = np.convolve(seen, np.ones(width) / width, "valid")
    axis.plot(time[width // 2 :][: len(mean)], mean, color=SERIES[1], lw=2, label="mean over 0.5 s")
    axis.axhline(0.5 - CURVE_ERROR, color="black", ls="--", lw=1)
    axis.set(xlabel="time (s)", ylabel="brightness", ylim=(0, 1), xlim=(2, 10))
    legend(axis, "upper right", 2)
    return picture(figure)


def arms() -> str:
    """Overshoot of the axle over the arm: by both formulas and in runs."""
    figure, (axis,) = new_figure(7.0, 3.4)
    recorded = (0.015, 0.02, 0.03, 0.05, 0.07, 0.09)
    runs = [_after_shift(arm) for arm in recorded]
    found = [100 * (max(y) / SHIFT - 1) for _, y, _ in runs]
    arm = np.linspace(0.0, 0.1, 200)
    speed = runs[-1][2]
    lag = (TURN_TIME + DELAY) * speed
    for shorter, style, name in ((0.0, "--", "with $D$"), (lag, ":", "with $D_e$")):
        damping = np.array([_damping(a, speed) for a in np.maximum(arm - shorter, 0)])
        overshoot = 100 * np.exp(-np.pi * damping / np.sqrt(1 - damping**2))
        axis.plot(1000 * arm, overshoot, color="black", ls=style, lw=1.3, label=name)
    axis.plot(1000 * np.array(recorded), found, "o", color=SERIES[0], label="recorded")
    axis.axvspan(0, 1000 * lag, color="0.92")
    axis.set(xlabel="sensor before the axle (mm)", ylabel="overshoot of the axle (%)")
    axis.set(xlim=(0, 100), ylim=(0, 105))
    legend(axis, "upper right")
    return picture(figure)
