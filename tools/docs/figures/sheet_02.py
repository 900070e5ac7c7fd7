# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of sheet 2: counts, measured speeds, the window's price, the voltage it smooths."""

from __future__ import annotations

import numpy as np
from ravenbrick.control import SampledLoop, pi_by_lambda, pi_with_estimator
from ravenbrick.control.estimation.estimator import LoopSpecification
from ravenbrick.model import NXT_MOTOR, Encoder, IntegrationMethod, SpeedLoop

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, run

_DEGREES_PER_VOLT = 116.0
_LOOP = SpeedLoop.of_motor(NXT_MOTOR, _DEGREES_PER_VOLT)
_SAMPLE_TIME, _DELAY = 0.004, 0.0023
_WINDOWS = (1, 2, 4, 8, 16, 32)


def _window(samples: int) -> Edits:
    return {"design.py": [("SPEED_WINDOW = 8", f"SPEED_WINDOW = {samples}")]}


def _sampled(begin: float, end: float, window: int) -> tuple[np.ndarray, np.ndarray]:
    """Sample instants of the step's recording and the speed (deg/s) from its counts."""
    times, counts = run("motor", "step").signal("motor.B.encoder")
    samples = np.arange(begin, end, _SAMPLE_TIME)

    def at(instants: np.ndarray) -> np.ndarray:
        return counts[np.searchsorted(times, instants, side="right") - 1]

    length = window * _SAMPLE_TIME
    return samples, (at(samples) - at(samples - length)) / length


def counts() -> str:
    """Angle and counts at a constant speed, and the speeds that two windows make of them."""
    figure, (angles, speeds) = new_figure(7, 4.4, rows=2)
    recording = run("motor", "step")
    times, angle = recording.signal("motor.B.angle")
    _, count = recording.signal("motor.B.encoder")
    shown = (times >= 2.5) & (times <= 2.55)
    since = 1000 * (times[shown] - 2.5)
    origin = count[shown][0]
    angles.plot(since, np.degrees(angle[shown]) - origin, color="0.5", label="angle")
    angles.step(since, count[shown] - origin, where="post", color=SERIES[0], label="counts")
    for window, colour, mark in zip((1, 8), SERIES, ("o", "s"), strict=False):
        samples, measured = _sampled(2.5, 2.55, window)
        speeds.plot(1000 * (samples - 2.5), measured, mark, color=colour, label=f"window {window}")
    speeds.axhline(4 * _DEGREES_PER_VOLT, color="0.5", linestyle=":")
    angles.set(ylabel="angle (deg)")
    speeds.set(xlabel="time (ms)", ylabel="speed (deg/s)", ylim=(200, 600))
    legend(angles, "upper left")
    legend(speeds, "center", columns=2)
    return picture(figure)


def delay() -> str:
    """The speed during a step, true and as three windows measure it."""
    figure, (axes,) = new_figure(7, 3.2)
    times, speed = run("motor", "step").signal("motor.B.angular_velocity")
    axes.plot(times - 1, np.degrees(speed), color="0.3", linewidth=2.5, alpha=0.5, label="true")
    styles = (":", "-", "--")
    for window, colour, style in zip((1, 8, 32), SERIES, styles, strict=False):
        samples, measured = _sampled(0.95, 1.32, window)
        axes.step(
            samples - 1, measured, style, where="post", color=colour, label=f"window {window}"
        )
    axes.set(xlabel="time since the touch sensor was pressed (s)", ylabel="speed (deg/s)")
    axes.set(xlim=(0, 0.3), ylim=(-20, 560))
    legend(axes, "lower right")
    return picture(figure)


def settling() -> str:
    """Settling time with the formula's gains, and phase margin of the designs, over the window."""
    figure, (times, margins) = new_figure(7, 4.2, rows=2)
    formula = pi_by_lambda(_LOOP, 0.4).discretised(IntegrationMethod.FORWARD_EULER, _SAMPLE_TIME)
    lengths = np.arange(1, 33)
    settled, margin = [], []
    for length in lengths:
        loop = SampledLoop(_LOOP, formula.system(), int(length), _DELAY)
        settled.append(1000 * loop.step_metrics().settling_time)
        wanted = LoopSpecification(0.4, 0.005, _SAMPLE_TIME, int(length), _DELAY)
        design = pi_with_estimator(_LOOP, wanted)
        loop = SampledLoop(_LOOP, design.system(), int(length), _DELAY)
        margin.append(loop.margins().phase_margin_deg)
    times.plot(lengths, settled, ".-", color=SERIES[0])
    times.axhline(400, color="0.5", linestyle=":")
    margins.plot(lengths, margin, ".-", color=SERIES[1])
    times.set(ylabel="settling time (ms)", ylim=(0, 560))
    margins.set(xlabel="window (samples)", ylabel="phase margin (deg)", ylim=(65, 90))
    return picture(figure)


def voltage() -> str:
    """The motor's voltage in steady state with windows of one and of eight samples."""
    figure, (axes,) = new_figure(7, 2.8)
    for window, colour, width in zip((1, 8), SERIES, (1, 2), strict=False):
        times, volts = run("motor", "step", _window(window)).signal("motor.B.voltage")
        shown = (times >= 2.5) & (times <= 2.7)
        axes.step(
            1000 * (times[shown] - 2.5),
            volts[shown],
            where="post",
            color=colour,
            linewidth=width,
            label=f"window {window}",
        )
    axes.set(xlabel="time (ms)", ylabel="motor voltage (V)", ylim=(3.6, 5.0))
    legend(axes, "upper right", columns=2)
    return picture(figure)


def ripple() -> str:
    """Standard deviation of the voltage over the window, recorded and by the formula."""
    figure, (axes,) = new_figure(7, 3)
    recorded, computed = [], []
    for window in _WINDOWS:
        times, volts = run("motor", "step", _window(window)).signal("motor.B.voltage")
        recorded.append(volts[(times > 2.0) & (times < 3.4)].std())
        wanted = LoopSpecification(0.4, 0.005, _SAMPLE_TIME, window, _DELAY)
        quantum = Encoder().speed_quantum(window * _SAMPLE_TIME) * _LOOP.feedback_gain
        share = 4.0 / quantum % 1.0
        gain = pi_with_estimator(_LOOP, wanted).proportional
        computed.append(gain * quantum * np.sqrt(share * (1 - share)))
    axes.loglog(_WINDOWS, recorded, "o-", color=SERIES[0], label="recorded")
    axes.loglog(_WINDOWS, computed, "s--", color=SERIES[1], label="formula")
    axes.set_xticks(_WINDOWS, [str(window) for window in _WINDOWS])
    axes.set(xlabel="window (samples)", ylabel="standard deviation (V)")
    legend(axes, "upper right")
    return picture(figure)
