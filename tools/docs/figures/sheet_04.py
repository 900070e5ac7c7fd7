# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of sheet 4: the speed loop designed, sampled and recorded."""

from __future__ import annotations

import math

import numpy as np
from ravenbrick.control import DiscretePi, SampledLoop, pi_by_lambda, pi_diagram, pi_with_estimator
from ravenbrick.control.estimation.estimator import LoopSpecification
from ravenbrick.errors import DesignError
from ravenbrick.model import NXT_MOTOR, Execution, IntegrationMethod, SpeedLoop, diagram_svg

from tools.docs.figures import SERIES, legend, new_figure, picture, run

_EULER = IntegrationMethod.FORWARD_EULER
_LOOP = SpeedLoop.of_motor(NXT_MOTOR, 116.0)
_SAMPLE_TIME, _WINDOW, _DELAY = 0.004, 8, 0.0023
_SETPOINT = math.radians(4 * 116.0)


def _design(settling_time: float) -> DiscretePi:
    wanted = LoopSpecification(settling_time, 0.02, _SAMPLE_TIME, _WINDOW, _DELAY)
    return pi_with_estimator(_LOOP, wanted)


def _sampled(pi: DiscretePi) -> SampledLoop:
    return SampledLoop(_LOOP, pi.system(), _WINDOW, _DELAY)


def controller() -> str:
    """The controller's diagram."""
    return diagram_svg(pi_diagram(_design(0.4), 8.0, _LOOP.time_constant))


def sampled() -> str:
    """One pair of gains in the ideal and in the sampled loop, and the gains of the design."""
    figure, (axes,) = new_figure(7, 3)
    gains = pi_by_lambda(_LOOP, 0.4)
    time = np.linspace(0, 0.6, 601)
    tuned = 1 - np.exp(-time * _LOOP.loop_gain * gains.integral)
    curves = [("formula, ideal loop", time, tuned)]
    for name, pi in (
        ("formula, sampled loop", gains.discretised(_EULER, _SAMPLE_TIME)),
        ("design tool, sampled loop", _design(0.4)),
    ):
        response = _sampled(pi).step_response(0.6)
        curves.append((name, response.time, response.output))
    axes.axhspan(0.98, 1.02, color="0.9")
    for (name, times, values), colour, style in zip(curves, SERIES, ("-", "--", "-"), strict=False):
        axes.plot(times, values, style, color=colour, label=name)
    axes.set(xlabel="time (s)", ylabel="speed / set-point", xlim=(0, 0.6), ylim=(0, 1.08))
    legend(axes, "lower right")
    return picture(figure)


def fastest() -> str:
    """Settling time and overshoot over the gain, the ratio of the two gains kept."""
    figure, (times, shares) = new_figure(7, 4, rows=2)
    base = _design(0.4)
    rows = []
    for factor in np.geomspace(0.8, 4.0, 240):
        first, second = (factor * value for value in base.coefficients)
        pi = DiscretePi.from_coefficients(first, second, _SAMPLE_TIME, _EULER)
        try:
            metrics = _sampled(pi).step_metrics()
        except DesignError:
            break
        rows.append((pi.proportional, metrics.settling_time, 100 * metrics.overshoot))
    gains, settling, overshoot = np.array(rows).T
    times.plot(gains, settling, color=SERIES[0])
    shares.plot(gains, overshoot, color=SERIES[1])
    shares.axhline(2, color="0.5", linestyle=":")
    for wanted in (0.4, 0.25):
        times.plot(_design(wanted).proportional, wanted, "o", color=SERIES[0])
    times.set(ylabel="settling time (s)", ylim=(0, 0.55))
    shares.set(xlabel="proportional gain Kp (V/V)", ylabel="overshoot (%)", ylim=(0, 12))
    return picture(figure)


def step() -> str:
    """Step responses of two designs beside those that the virtual brick recorded."""
    figure, (axes,) = new_figure(7, 3)
    axes.axhspan(0.98 * _SETPOINT, 1.02 * _SETPOINT, color="0.9")
    for settling_time, colour in zip((0.4, 0.25), SERIES, strict=False):
        edit = ("SETTLING_TIME = 0.4", f"SETTLING_TIME = {settling_time}")
        times, speed = run("motor", "step", {"design.py": [edit]}).signal(
            "motor.B.angular_velocity"
        )
        name = f"{1000 * settling_time:.0f} ms"
        axes.plot(
            times - 1.0, speed, color=colour, linewidth=2.5, alpha=0.5, label=f"{name}, recorded"
        )
        response = _sampled(_design(settling_time)).step_response(0.6)
        start = times[np.flatnonzero(speed > 0.01)[0]] - 1.0
        designed = response.output * _SETPOINT
        axes.plot(
            response.time + start, designed, color=colour, linewidth=1, label=f"{name}, designed"
        )
    axes.set(xlabel="time since the touch sensor was pressed (s)", ylabel="speed (rad/s)")
    axes.set(xlim=(0, 0.6), ylim=(0, 9))
    legend(axes, "lower right")
    return picture(figure)


def load() -> str:
    """Speed under a sudden load, recorded and by the formula without delays."""
    figure, (axes,) = new_figure(7, 3)
    times, speed = run("motor", "load").signal("motor.B.angular_velocity")
    since = times - 3.0
    steady = speed[(since > -0.5) & (since < 0)].mean()
    missing = NXT_MOTOR.resistance * 0.05 / NXT_MOTOR.torque_constant
    tau, closed = NXT_MOTOR.time_constant, 1 / _sampled(_design(0.4)).margins().crossover
    after = np.linspace(0, 0.6, 601)
    fall = np.exp(-after / closed) - np.exp(-after / tau)
    fall *= NXT_MOTOR.gain * missing * closed / (closed - tau)
    shown = (since > -0.1) & (since < 0.6)
    axes.plot(since[shown], speed[shown], color=SERIES[0], label="recorded")
    axes.plot(after, steady - fall, "--", color=SERIES[1], label="formula")
    axes.set(xlabel="time since the load (s)", ylabel="speed (rad/s)")
    legend(axes, "lower right")
    return picture(figure)


def windup() -> str:
    """Set-point of 10 V for a second, then 4 V, with and without the tracking gain; ideal speed."""
    figure, (speeds, voltages) = new_figure(7, 4, rows=2)
    tracking = _SAMPLE_TIME / _LOOP.time_constant
    decay = math.exp(-_SAMPLE_TIME / _LOOP.time_constant)
    time = np.arange(600) * _SAMPLE_TIME
    for name, gain, colour in zip(
        ("with tracking", "without"), (tracking, 0.0), SERIES, strict=False
    ):
        program = Execution(pi_diagram(_design(0.4), 8.0, _LOOP.time_constant))
        program.set_parameter("Kt_Ts", gain)
        speed, rows = 0.0, []
        for now in time:
            inputs = {"Input_Voltage": 10.0 if now < 1.0 else 4.0, "Real_Voltage": speed}
            voltage = float(program.step(inputs)["correctedvoltage"])
            rows.append((speed, voltage))
            speed = decay * speed + (1 - decay) * _LOOP.loop_gain * voltage
        measured, applied = np.array(rows).T
        speeds.plot(time, measured, color=colour, label=name)
        voltages.step(time, applied, where="post", color=colour)
    speeds.set(ylabel="speed (V)")
    voltages.set(xlabel="time (s)", ylabel="motor voltage (V)")
    legend(speeds, "upper right")
    return picture(figure)
