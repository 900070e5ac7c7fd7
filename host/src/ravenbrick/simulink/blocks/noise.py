# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Random numbers, the same in simulation and C; they are not those that Simulink draws.

The generator is AS 183 of Wichmann and Hill (Applied Statistics 31, 1982, p. 188): its products
stay below 2^24, so that single precision holds them exactly. Its period is 7e12.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from ravenbrick.model import RoundingFunction, UnitDelay
from ravenbrick.simulink.blocks.elementary import ONE, TWO
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.signals import Wire

__all__ = ["NOISE"]

_PARTS = ((171, 30269), (172, 30307), (170, 30323))
_SPREAD = 7919  # seeds that are neighbours begin far apart


def _uniform(b: Builder, seed: int) -> Wire:
    """Between 0 and 1."""
    shares: list[Wire] = []
    for place, (factor, modulus) in enumerate(_PARTS):
        begin = 1 + (seed * _SPREAD + place * 10007 + 12345) % (modulus - 1)
        state = b.add(UnitDelay("B", initial=float(begin)), ending="_seed")
        state.inputs = [TWO["mod"](b, b.scaled(float(factor), state), b.constant(modulus))]
        shares.append(b.scaled(1 / modulus, state))
    total = b.sum(*shares)
    whole = b.add(RoundingFunction("B", function="floor"), total, ending="_whole")
    return b.sum(total, whole, signs="+-")


def _normal(b: Builder, seed: int) -> Wire:
    """With mean 0 and variance 1, by the method of Box and Muller."""
    size, turn = _uniform(b, 2 * seed), _uniform(b, 2 * seed + 1)
    radius = ONE["sqrt"](b, b.scaled(-2.0, ONE["log"](b, size)))
    return b.product(radius, ONE["cos"](b, b.scaled(math.tau, turn)))


def _uniform_numbers(b: Builder) -> None:
    found: list[Wire] = []
    for element in range(b.width("Minimum", "Maximum", "Seed")):
        d = b.dialog(element=element)
        low, high = d.number("Minimum", "-1"), d.number("Maximum", "1")
        share = _uniform(b, int(d.number("Seed", "0")) + element)
        found.append(b.sum(b.scaled(high - low, share), b.constant(low)))
    b.out(found)


def _normal_numbers(b: Builder) -> None:
    found: list[Wire] = []
    for element in range(b.width("Mean", "Variance", "Seed")):
        d = b.dialog(element=element)
        drawn = _normal(b, int(d.number("Seed", "0")) + element)
        scaled = b.scaled(math.sqrt(d.number("Variance", "1")), drawn)
        found.append(b.sum(scaled, b.constant(d.number("Mean", "0"))))
    b.out(found)


def _white_noise(b: Builder) -> None:
    """Of a spectral density, by numbers that are held for the sample time."""
    found: list[Wire] = []
    for element in range(b.width("Cov", "seed")):
        d = b.dialog(element=element)
        drawn = _normal(b, int(d.number("seed", "[23341]")) + element)
        found.append(b.scaled(math.sqrt(d.number("Cov", "[0.1]") / b.sample_time), drawn))
    b.out(found)


NOISE: Mapping[str, Callable[[Builder], None]] = {
    "RandomNumber": _normal_numbers,
    "UniformRandomNumber": _uniform_numbers,
    "simulink/Band-Limited White Noise": _white_noise,
}
