# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of sheet 5: hold, aliases, margins over the period, and recorded runs."""

from __future__ import annotations

import math

import numpy as np
from ravenbrick.control import SampledLoop, pi_with_estimator
from ravenbrick.control.estimation.estimator import LoopSpecification
from ravenbrick.model import NXT_MOTOR, SpeedLoop

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, run

_LOOP = SpeedLoop.of_motor(NXT_MOTOR, 116.0)
_DELAY = 0.0023
_VOLTS = 180 / math.pi / 116.0
_CRITERIA = """[[criteria]]
measure = "settling_time"
minimum = 0.35
maximum = 0.45

[[criteria]]
measure = "overshoot"
maximum = 0.02

"""


def hold() -> str:
    """A sine, what a hold makes of it, and the same sine half a period late."""
    figure, (axes,) = new_figure(7, 2.8)
    period, turns = 0.04, 2 * math.pi * 3.0
    time = np.linspace(0, 0.4, 2001)
    held = np.sin(turns * np.floor(time / period + 1e-9) * period)
    axes.plot(time, np.sin(turns * time), color=SERIES[0], label="sampled signal")
    axes.plot(time, held, color="0.45", linewidth=1, label="held, 40 ms")
    late = np.sinc(3.0 * period) * np.sin(turns * (time - period / 2))
    axes.plot(time, late, "--", color=SERIES[1], label="its 3 Hz part, 20 ms late")
    axes.set(xlabel="time (s)", ylabel="signal", xlim=(0, 0.4))
    legend(axes, "lower left")
    return picture(figure)


def alias() -> str:
    """An oscillation of 24 Hz and its samples at 25 Hz."""
    figure, (axes,) = new_figure(7, 2.4)
    time, samples = np.linspace(0, 1, 4001), np.arange(0, 1.001, 0.04)
    axes.plot(time, np.cos(2 * math.pi * 24 * time), color="0.7", linewidth=0.8, label="24 Hz")
    axes.plot(time, np.cos(2 * math.pi * time), "--", color=SERIES[1], label="1 Hz")
    axes.plot(
        samples, np.cos(2 * math.pi * 24 * samples), "o", color=SERIES[0], label="samples at 25 Hz"
    )
    axes.set(xlabel="time (s)", ylabel="signal", xlim=(0, 1))
    legend(axes, "lower left")
    return picture(figure)


def margins() -> str:
    """Phase margin and crossover frequency of designs with one settling time, over the period."""
    figure, (phases, crossovers) = new_figure(7, 4.2, rows=2)
    rows = []
    for period_ms in range(4, 121, 4):
        period = period_ms / 1000
        pi = pi_with_estimator(_LOOP, LoopSpecification(0.4, 0.005, period, 1, _DELAY))
        found = SampledLoop(_LOOP, pi.system(), 1, _DELAY).margins()
        late = math.degrees(found.crossover * (period + _DELAY))
        rows.append((period_ms, found.phase_margin_deg, 90 - late, found.crossover))
    periods, exact, formula, crossover = np.array(rows).T
    phases.plot(periods, exact, color=SERIES[0], label="sampled design")
    phases.plot(periods, formula, "--", color=SERIES[1], label="formula")
    crossovers.plot(periods, crossover, color=SERIES[0])
    phases.set(ylabel="phase margin (deg)", ylim=(55, 90))
    crossovers.set(xlabel="period (ms)", ylabel="crossover (rad/s)", ylim=(0, 10))
    legend(phases, "lower left")
    return picture(figure)


def _slow(period_ms: int) -> Edits:
    return {
        "design.py": [("SPEED_WINDOW = 8", "SPEED_WINDOW = 1")],
        "robot.toml": [
            ("period_us = 4_000", f"period_us = {period_ms}_000"),
            ("deadline_us = 4_000", f"deadline_us = {period_ms}_000"),
        ],
    }


def _wrong() -> Edits:
    """The design for 4 ms, called each 40 ms."""
    fixed = 'SAMPLE_TIME_MS = ROBOT.period_ms("control_task")'
    return {
        "design.py": [(fixed, "SAMPLE_TIME_MS = 4")],
        "robot.toml": _slow(40)["robot.toml"],
        "src/tasks.adb": [("Milliseconds (Controller_Design.Sample_Time_Ms)", "Milliseconds (40)")],
        # The speed never settles, and the run would be refused.
        "scenarios/step.toml": [(_CRITERIA, "")],
    }


def step() -> str:
    """The step with 4 ms, with 40 ms, and with a period that the design does not know."""
    figure, (axes,) = new_figure(7, 3.2)
    cases: tuple[tuple[str, Edits, str, str], ...] = (
        ("designed and called each 4 ms", {}, SERIES[0], "-"),
        ("designed and called each 40 ms", _slow(40), SERIES[1], "--"),
        ("designed for 4 ms, called each 40 ms", _wrong(), SERIES[2], "-"),
    )
    for name, edits, colour, style in cases:
        time, speed = run("motor", "step", edits).signal("motor.B.angular_velocity")
        axes.plot(time - 1, speed * _VOLTS, style, color=colour, label=name)
    axes.set(xlabel="time since the touch sensor was pressed (s)", ylabel="speed (V)")
    axes.set(xlim=(-0.1, 2), ylim=(-0.5, 4.6))
    legend(axes, "center right")
    return picture(figure)


def load() -> str:
    """The load of sheet 4 with three periods."""
    figure, (axes,) = new_figure(7, 3)
    periods: tuple[tuple[str, Edits], ...]
    periods = (("4 ms", {}), ("40 ms", _slow(40)), ("120 ms", _slow(120)))
    for (name, edits), colour, style in zip(periods, SERIES, ("-", "--", "-"), strict=False):
        time, speed = run("motor", "load", edits).signal("motor.B.angular_velocity")
        axes.plot(time - 3, speed, style, color=colour, label=name)
    axes.set(xlabel="time since the load (s)", ylabel="speed (rad/s)", xlim=(-0.1, 1))
    axes.set(ylim=(5.5, 8.7))
    legend(axes, "lower right")
    return picture(figure)
