# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Lead and lag, feed-forward by the plant's inverse, and the Smith predictor."""

from __future__ import annotations

import cmath
import math

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model.lazy import control

__all__ = ["feed_forward", "lag", "lead", "smith_predictor"]

_MOST_LEAD_DEG = 75.0


def lead(
    plant: control.TransferFunction, phase_margin_deg: float, crossover: float, delay: float = 0.0
) -> control.TransferFunction:
    """k (1 + s a T) / (1 + s T) with which the loop has gain 1 and the margin at `crossover`.

    `crossover` in rad/s; `delay` (s) is that of the sampled loop. The lead is largest at the
    crossover (Franklin, Powell and Emami-Naeini, Feedback Control, 6.7). Raises `DesignError` if
    the plant needs none, or more than 75 degrees.
    """
    if not crossover > 0 or not 0 < phase_margin_deg < 180 or delay < 0:
        raise DesignError("give a crossover > 0 rad/s, a margin within 180 deg and no delay < 0")
    value = complex(plant(1j * crossover)) * cmath.exp(-1j * crossover * delay)
    missing = (phase_margin_deg - 180 - math.degrees(cmath.phase(value)) + 180) % 360 - 180
    if not 0 < missing <= _MOST_LEAD_DEG:
        raise DesignError(
            f"at {crossover:g} rad/s a lead of {missing:.1f} deg would be needed, and one of 0 to "
            f"{_MOST_LEAD_DEG:g} can be had; choose another crossover or margin"
        )
    sine = math.sin(math.radians(missing))
    ratio = (1 + sine) / (1 - sine)
    slow, fast = math.sqrt(ratio) / crossover, 1 / (math.sqrt(ratio) * crossover)
    gain = 1 / (abs(value) * math.sqrt(ratio))
    return control.tf([gain * slow, gain], [fast, 1.0])


def lag(ratio: float, corner: float) -> control.TransferFunction:
    """(s + `corner`) / (s + `corner` / `ratio`): so much more gain below, none above.

    `corner` in rad/s; a tenth of the crossover costs less than 6 degrees of margin.
    """
    if not ratio > 1 or not corner > 0:
        raise DesignError(f"a lag needs a ratio > 1 and a corner > 0, not {ratio:g} and {corner:g}")
    return control.tf([1.0, corner], [1.0, corner / ratio])


def feed_forward(plant: control.TransferFunction, time_constant: float) -> control.TransferFunction:
    """From set-point to control input: the plant's inverse behind as many lags as it needs.

    With it the plant alone follows the set-point with 1 / (1 + s `time_constant`)**n, n the
    excess of its poles over its zeros. Raises `DesignError` for a zero that is not left of 0,
    whose inverse would not be stable.
    """
    if not time_constant > 0:
        raise DesignError(f"the time constant must be > 0 s, not {time_constant:g}")
    wrong = [zero for zero in plant.zeros() if zero.real >= 0]
    if wrong:
        raise DesignError(
            f"the plant has a zero at {complex(wrong[0]):.4g}, whose inverse is not stable; feed "
            "forward the inverse of a plant without it"
        )
    numerator, denominator = plant.num[0][0], plant.den[0][0]
    excess = len(denominator) - len(numerator)
    lags = np.poly1d([time_constant, 1.0]) ** excess
    return control.tf(denominator, np.polymul(numerator, np.atleast_1d(lags.coeffs)))


def smith_predictor(
    controller: control.lti.LTI, plant: control.lti.LTI, delay: float
) -> control.StateSpace:
    """A discrete controller around a model of the plant without its delay (s), error to input.

    Designed for the plant alone, `controller` then controls plant and delay: with the true model
    the closed loop is that without delay, `delay` later (O. Smith, Chemical Engineering Progress
    53, 1957). A continuous `plant` is sampled with a hold. Raises `DesignError` unless the delay
    is some whole samples, and for a plant that is not stable, whose prediction would run away.
    """
    if not control.isdtime(controller, strict=True):
        raise DesignError("the controller must be discrete; discretise it first")
    sample_time = float(controller.dt)
    samples = round(delay / sample_time)
    if samples < 1 or abs(samples * sample_time - delay) > 1e-9:
        raise DesignError(f"the delay must be whole samples of {sample_time:g} s, not {delay:g} s")
    model = control.ss(plant)
    if not control.isdtime(model, strict=True):
        model = control.sample_system(model, sample_time, "zoh")
    if max(np.abs(model.poles()), default=0.0) >= 1:
        raise DesignError("the plant is not stable; a Smith predictor needs one that is")
    shift = control.ss(
        np.eye(samples, k=-1), np.eye(samples)[:, :1], np.eye(samples)[-1:], 0, sample_time
    )
    ahead = model * (control.ss([], [], [], [[1.0]], sample_time) - shift)
    return control.feedback(control.ss(controller), ahead)
