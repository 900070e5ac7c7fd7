# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""PI, PD and PID gains for any plant: by phase margin and crossover, by the closed loop's poles."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model.lazy import control

__all__ = ["PidGains", "pid_by_margin", "pid_by_poles"]

_KINDS = ("PI", "PD", "PID")


@dataclass(frozen=True)
class PidGains:
    """C(s) = P + I / s + D s, with a filter: D s / (1 + s / `filter_pole`), in rad/s."""

    proportional: float
    integral: float = 0.0
    derivative: float = 0.0
    filter_pole: float = math.inf

    def controller(self) -> control.TransferFunction:
        """The continuous controller; with a derivative and no filter it is improper."""
        p, i, d = self.proportional, self.integral, self.derivative
        tail = [1.0] if not i else [1.0, 0.0]
        ideal = control.tf([p, i] if i else [p], tail)
        if not d:
            return ideal
        lag = [1.0] if math.isinf(self.filter_pole) else [1 / self.filter_pole, 1.0]
        return ideal + control.tf([d, 0.0], lag)


def pid_by_margin(
    plant: control.TransferFunction,
    phase_margin_deg: float,
    crossover: float,
    kind: str = "PI",
    delay: float = 0.0,
    filter_pole: float = math.inf,
) -> PidGains:
    """Gains with which the loop has gain 1 and the phase margin at `crossover` (rad/s).

    `delay` (s) is that of the sampled loop: half a sample for the hold, and the computation. A
    PID gets the integral time of four derivative times (Astrom and Hagglund, Advanced PID
    Control, 2006, 4.4). Raises `DesignError` if no positive gains do it: the phase that is
    missing is named.
    """
    if kind not in _KINDS:
        raise DesignError(f"the kind must be one of {', '.join(_KINDS)}, not '{kind}'")
    if not crossover > 0 or not 0 < phase_margin_deg < 180 or delay < 0:
        raise DesignError(
            f"give a crossover > 0 rad/s, a margin between 0 and 180 deg and a delay >= 0 s, not "
            f"{crossover}, {phase_margin_deg} and {delay}"
        )
    response = complex(plant(1j * crossover)) * cmath.exp(-1j * crossover * delay)
    wanted = cmath.rect(1.0, math.radians(phase_margin_deg) - math.pi) / response
    lead = math.atan2(wanted.imag, wanted.real)
    allowed = {"PI": (-math.pi / 2, 0.0), "PD": (0.0, math.pi / 2)}.get(
        kind, (-math.pi / 2, math.pi / 2)
    )
    if not allowed[0] < lead < allowed[1]:
        raise DesignError(
            f"at {crossover:g} rad/s the controller would have to turn the phase by "
            f"{math.degrees(lead):.1f} deg; a {kind} turns it by {math.degrees(allowed[0]):.0f} to "
            f"{math.degrees(allowed[1]):.0f} deg: choose another crossover or margin"
        )
    return _gains(kind, wanted, crossover, filter_pole)


def _gains(kind: str, wanted: complex, crossover: float, filter_pole: float) -> PidGains:
    """P + I / (j w) + D j w / (1 + j w / N) = wanted."""
    lag = 1 / (1 + 1j * crossover / filter_pole)  # of the filter, times j w D
    slope = 1j * crossover * lag
    if kind == "PI":
        return PidGains(wanted.real, -crossover * wanted.imag)
    if kind == "PD":
        derivative = wanted.imag / slope.imag
        gains = (wanted.real - derivative * slope.real, 0.0, derivative)
    else:
        # I = P^2 / (4 D): with x = D / P the phase of 1 + slope x + 1 / (4 x j w) is known.
        share = _derivative_share(wanted, slope, crossover)
        whole = 1 + slope * share - 1j / (4 * share * crossover)
        proportional = abs(wanted) / abs(whole)
        gains = (proportional, proportional / (4 * share), proportional * share)
    if min(gains[0], gains[2]) <= 0:
        raise DesignError(f"the filter at {filter_pole:g} rad/s leaves no positive gains; raise it")
    return PidGains(*gains, filter_pole)


def _derivative_share(wanted: complex, slope: complex, crossover: float) -> float:
    """D / P in s: the positive root of Im((1 + slope x - j / (4 x w)) conj(wanted)) = 0."""
    turned = slope * wanted.conjugate()
    rest = -1j * wanted.conjugate() / (4 * crossover)
    roots = np.roots([turned.imag, wanted.conjugate().imag, rest.imag])
    for root in sorted(roots, key=lambda r: -abs(r)):
        share = float(root.real)
        whole = 1 + slope * share - 1j / (4 * share * crossover) if share > 0 else 0j
        if abs(root.imag) < 1e-12 and (whole * wanted.conjugate()).real > 0:
            return share
    raise DesignError("no PID with an integral time of four derivative times has this margin")


def pid_by_poles(plant: control.TransferFunction, poles: Sequence[complex]) -> PidGains:
    """Gains that give the closed loop these poles (rad/s).

    Two poles with a plant b / (s + a) give a PI, two with b / (s^2 + c s + d) a PD, three with the
    latter a PID; complex poles come in pairs. Raises `DesignError` for other plants and numbers.
    """
    top, bottom = (np.trim_zeros(np.asarray(p[0][0], float), "f") for p in (plant.num, plant.den))
    wanted = np.poly(np.asarray(poles, complex))
    if np.abs(wanted.imag).max() > 1e-9 * np.abs(wanted).max():
        raise DesignError("complex poles must come in pairs; add the conjugate of each")
    order, count = len(bottom) - 1, len(poles)
    if len(top) != 1 or (order, count) not in ((1, 2), (2, 2), (2, 3)):
        raise DesignError(
            f"{count} poles for a plant of order {order} with {len(top) - 1} zeros: give two "
            "poles for order 1, two or three for order 2, and a plant without zeros"
        )
    b, a = top[0] / bottom[0], bottom / bottom[0]
    real = wanted.real
    if order == 1:
        return PidGains((real[1] - a[1]) / b, real[2] / b)
    derivative, proportional = (real[1] - a[1]) / b, (real[2] - a[2]) / b
    integral = real[3] / b if count == 3 else 0.0
    return PidGains(proportional, integral, derivative)
