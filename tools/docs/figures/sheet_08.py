# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of sheet 8: rounding of a controller in integers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ravenbrick.control import pi_direct
from ravenbrick.model import NXT_MOTOR, IntegrationMethod, SpeedLoop

from tools.docs.figures import SERIES, legend, new_figure, picture

SAMPLE_TIME = 0.004
LOOP = SpeedLoop.of_motor(NXT_MOTOR, 116.0)
PI = pi_direct(LOOP, 0.4, SAMPLE_TIME, IntegrationMethod.FORWARD_EULER)
GAIN_BITS = 14
KP = round(PI.proportional * 2**GAIN_BITS)
KI = round(PI.integral_step * 2**GAIN_BITS)
POLE = math.exp(-SAMPLE_TIME / LOOP.time_constant)
INPUT = LOOP.gain * math.degrees(1) / LOOP.degrees_per_volt * (1 - POLE)
Divide = Callable[[int, int], int]


def _nearest(value: int, unit: int) -> int:
    return (value + unit // 2) // unit


def _towards_zero(value: int, unit: int) -> int:
    return value // unit if value >= 0 else -(-value // unit)


def rounding() -> str:
    """The error of both roundings over the exact value, in LSB."""
    unit = 200
    exact = np.arange(-3 * unit, 3 * unit + 1)
    figure, axes = new_figure(6.5, 3.6, rows=2)
    for axis, divide, name, colour in (
        (axes[0], _towards_zero, "cut towards zero", SERIES[1]),
        (axes[1], _nearest, "to the nearest number", SERIES[0]),
    ):
        error = np.array([divide(int(value), unit) for value in exact]) - exact / unit
        error[1:][np.abs(np.diff(error)) > 0.5] = np.nan
        axis.plot(exact / unit, error, color=colour)
        axis.set_title(name, fontsize=9, loc="left")
        axis.set_ylabel("error (LSB)")
        axis.set_ylim(-1.2, 1.2)
    axes[-1].set_xlabel("exact value (LSB)")
    return picture(figure)


def _response(errors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Speed in V after each of these errors of the motor voltage in V, with the gains as held."""
    kp, ki = KP / 2**GAIN_BITS, KI / 2**GAIN_BITS
    speed, integral, seen = 0.0, 0.0, []
    for error in errors:
        voltage = integral - kp * speed + error
        integral, speed = integral - ki * speed, POLE * speed + INPUT * voltage
        seen.append(speed)
    return np.array(seen)


def peak() -> str:
    """The pulse response, and the speed's error under the worst rounding errors."""
    count, unit_mv = 200, 1000 * 2.0**-11
    pulse = _response(np.eye(1, count)[0])
    worst = unit_mv / 2 * np.sign(pulse[::-1])
    figure, axes = new_figure(6.5, 4.6, rows=2)
    samples = np.arange(1, count + 1)
    axes[0].vlines(samples, 0, pulse, color=SERIES[0])
    axes[0].set_ylabel("pulse response (V/V)")
    total = float(np.abs(_response(np.eye(1, 3000)[0])).sum())
    axes[0].set_title(f"sum of the absolute values: {total:.3f}", fontsize=9, loc="left")
    dashed: dict[str, Any] = {"color": SERIES[1], "ls": "--", "drawstyle": "steps"}
    axes[1].plot(samples, worst, label="rounding error", **dashed)
    axes[1].plot(samples, _response(worst), color=SERIES[0], label="error of the speed")
    bound = total * unit_mv / 2
    axes[1].axhline(bound, color="black", lw=1)
    axes[1].text(2, bound + 0.03, f"bound {bound:.3f} mV", fontsize=9)
    axes[1].set_ylabel("mV")
    axes[1].set_ylim(-0.35, 0.42)
    axes[1].set_xlabel("sample")
    legend(axes[1], "center")
    return picture(figure)


def _deviation(bits: int, divide: Divide) -> float:
    """Largest difference in mV between the loop in integers and the one in real numbers."""
    generator = np.random.default_rng(1)
    kp, ki = KP / 2**GAIN_BITS, KI / 2**GAIN_BITS
    rounded, exact, integer, real, largest, wanted = 0.0, 0.0, 0, 0.0, 0.0, 0
    for sample in range(20_000):
        if sample % 50 == 0:
            wanted = int(generator.integers(-2 << bits, (2 << bits) + 1))
        error = wanted - _nearest(math.floor(rounded * 2 ** (bits + 20)), 1 << 20)
        output = divide(KP * error + integer, 1 << GAIN_BITS) / 2**bits
        integer += KI * error
        difference = wanted / 2**bits - exact
        rounded = POLE * rounded + INPUT * output
        exact = POLE * exact + INPUT * (kp * difference + real)
        real += ki * difference
        largest = max(largest, abs(rounded - exact))
    return 1000 * largest


def bits() -> str:
    """Bound and simulated deviation over the number of fractional bits."""
    counts = np.arange(3, 14)
    total = float(np.abs(_response(np.eye(1, 3000)[0])).sum())
    figure, (axis,) = new_figure(6.5, 3.4)
    for divide, error, name, colour in (
        (_towards_zero, 1.0, "cut towards zero", SERIES[1]),
        (_nearest, 0.5, "to nearest", SERIES[0]),
    ):
        axis.plot(counts, 1000 * (total * error + 0.5) / 2.0**counts, color=colour, label=name)
        found = [_deviation(int(count), divide) for count in counts]
        axis.plot(counts, found, "o" if error < 1 else "s", color=colour)
    axis.set_yscale("log")
    axis.set_xlabel("fractional bits of input and output")
    axis.set_ylabel("error of the speed (mV)")
    legend(axis, "upper right")
    return picture(figure)
