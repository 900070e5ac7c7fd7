# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""PI gains from a settling-time specification, in continuous and in discrete time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ravenbrick.control.analysis.metrics import SETTLING_BAND, step_metrics
from ravenbrick.errors import DesignError
from ravenbrick.model import IntegrationMethod, LinearSystem, SpeedLoop
from ravenbrick.model.lazy import control, optimize

__all__ = [
    "DiscretePi",
    "PiGains",
    "pi_by_damping",
    "pi_by_lambda",
    "pi_direct",
    "pi_family",
]


@dataclass(frozen=True)
class PiGains:
    """C(s) = Kp + Ki / s: `proportional` in V/V, `integral` in 1/s."""

    proportional: float
    integral: float

    def controller(self) -> control.TransferFunction:
        """The continuous controller."""
        return control.tf([self.proportional, self.integral], [1.0, 0.0])

    def closed_loop(self, loop: SpeedLoop) -> LinearSystem:
        """From set-point to fed-back signal (V); states: integral of the error, the signal."""
        rate = loop.loop_gain / loop.time_constant
        error, integral = rate * self.proportional, rate * self.integral
        return LinearSystem(
            np.array([[0.0, -1.0], [integral, -1 / loop.time_constant - error]]),
            np.array([[1.0], [error]]),
            np.array([[0.0, 1.0]]),
            np.zeros((1, 1)),
        )

    def discretised(self, method: IntegrationMethod, sample_time: float) -> DiscretePi:
        """The same gains with a discrete integrator at `sample_time` (s)."""
        return DiscretePi(self.proportional, self.integral * sample_time, sample_time, method)


@dataclass(frozen=True)
class DiscretePi:
    """PI with a discrete integrator: `proportional` in V/V, `integral_step` = Ki Ts in V/V."""

    proportional: float
    integral_step: float
    sample_time: float
    method: IntegrationMethod

    @property
    def gains(self) -> PiGains:
        """Kp and Ki of the parallel form."""
        return PiGains(self.proportional, self.integral_step / self.sample_time)

    @property
    def coefficients(self) -> tuple[float, float]:
        """b0 and b1 of C(z) = (b0 z + b1) / (z - 1)."""
        first = self.proportional + self.method.present_share * self.integral_step
        return first, self.integral_step - first

    def controller(self) -> control.TransferFunction:
        """The discrete controller."""
        return control.tf(list(self.coefficients), [1.0, -1.0], self.sample_time)

    def system(self) -> LinearSystem:
        """The matrices of `controller`."""
        first, second = self.coefficients
        one = np.ones((1, 1))
        return LinearSystem(one, one, (first + second) * one, first * one, self.sample_time)

    def rounded(self, digits: int) -> DiscretePi:
        """Both gains rounded to so many significant digits, so that a file shows all of them."""
        return DiscretePi(
            float(f"{self.proportional:.{digits}g}"),
            float(f"{self.integral_step:.{digits}g}"),
            self.sample_time,
            self.method,
        )

    @classmethod
    def from_coefficients(
        cls, b0: float, b1: float, sample_time: float, method: IntegrationMethod
    ) -> DiscretePi:
        """The PI with C(z) = (b0 z + b1) / (z - 1) in the form of `method`."""
        step = b0 + b1
        return cls(b0 - method.present_share * step, step, sample_time, method)


def closed_loop_time_constant(settling_time: float, band: float = SETTLING_BAND) -> float:
    """Time constant (s) of the first-order response that enters the band at `settling_time` (s)."""
    if not settling_time > 0:
        raise DesignError(f"the settling time must be > 0 s, not {settling_time}")
    return settling_time / math.log(1.0 / band)


def pi_by_lambda(loop: SpeedLoop, settling_time: float) -> PiGains:
    """Gains with the controller's zero on the plant's pole (lambda tuning).

    The closed loop is 1 / (tc s + 1) with tc = settling_time / ln 50: no overshoot, exactly the
    specified time. Kp = tau / (a tc), Ki = 1 / (a tc) (Rivera, Morari, Skogestad, 1986).
    """
    time_constant = closed_loop_time_constant(settling_time)
    integral = 1.0 / (loop.loop_gain * time_constant)
    return PiGains(loop.time_constant * integral, integral)


def _gains_of_damping(loop: SpeedLoop, damping: float, frequency: float) -> PiGains:
    """Closed-loop denominator s^2 + 2 damping frequency s + frequency^2."""
    tau, gain = loop.time_constant, loop.loop_gain
    return PiGains((2 * damping * frequency * tau - 1) / gain, frequency**2 * tau / gain)


def pi_by_damping(loop: SpeedLoop, damping: float, settling_time: float) -> PiGains:
    """Gains with damping ratio `damping` of the closed loop's poles and the specified time (s).

    The natural frequency is found by root finding on the exact settling time; raises `DesignError`
    if no frequency meets it.
    """

    def excess(frequency: float) -> float:
        gains = _gains_of_damping(loop, damping, frequency)
        return step_metrics(gains.closed_loop(loop)).settling_time - settling_time

    grid = np.geomspace(0.5 / settling_time, 100 / settling_time, 60)
    values = [excess(frequency) for frequency in grid]
    for (left, right), (first, last) in zip(pairwise(grid), pairwise(values), strict=True):
        if first > 0 >= last:
            root = float(optimize.brentq(excess, left, right, xtol=1e-12))
            if abs(excess(root)) < 1e-6:
                return _gains_of_damping(loop, damping, root)
    raise DesignError(
        f"no PI with damping ratio {damping} settles in exactly {settling_time} s; "
        "change the damping ratio"
    )


def pi_family(
    loop: SpeedLoop, settling_time: float, dampings: tuple[float, ...] = (0.9, 1.0, 1.1, 1.2)
) -> dict[float, PiGains]:
    """The gains for several damping ratios: a settling time alone does not fix a PI."""
    return {damping: pi_by_damping(loop, damping, settling_time) for damping in dampings}


def pi_direct(
    loop: SpeedLoop, settling_time: float, sample_time: float, method: IntegrationMethod
) -> DiscretePi:
    """Gains designed in z: zero on the sampled plant's pole, closed-loop pole exp(-Ts/tc).

    With ideal samples and no delay the speed settles in exactly `settling_time` (s).
    """
    pole = math.exp(-sample_time / loop.time_constant)
    wanted = math.exp(-sample_time / closed_loop_time_constant(settling_time))
    b0 = (1 - wanted) / (loop.loop_gain * (1 - pole))
    return DiscretePi.from_coefficients(b0, -b0 * pole, sample_time, method)
