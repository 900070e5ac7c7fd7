# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Transfer functions by their roots: no polynomial beyond second order is ever expanded."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError
from ravenbrick.model.blocks.basic import IntegrationMethod
from ravenbrick.model.lazy import control

__all__ = ["ZeroPoleGain"]

_Array = npt.NDArray[Any]

_HALF_ULP = 2.0**-53
_WORST_CONDITION = 1e-4
_WORST_ROOTS = 1e-6
_STILL_INTEGRATOR = 1e-7
_POINTS_PER_DECADE = 12


@dataclass(frozen=True)
class ZeroPoleGain:
    """`gain` times the product of (x - zero) over that of (x - pole).

    In continuous time (`dt` 0) x is s in rad/s. In discrete time, with `dt` the sample time in s,
    x is delta = z - 1: roots near z = 1 keep their digits there (Middleton and Goodwin, Digital
    Control and Estimation, 1990). Complex roots stand in conjugate pairs.
    """

    zeros: tuple[complex, ...]
    poles: tuple[complex, ...]
    gain: float
    dt: float = 0.0

    def __post_init__(self) -> None:
        if len(self.zeros) > len(self.poles):
            raise DesignError(
                f"{len(self.zeros)} zeros and {len(self.poles)} poles: a controller needs at least "
                "as many poles as zeros; add a pole well above the bandwidth"
            )
        for roots in (self.zeros, self.poles):
            if any(root.conjugate() not in roots for root in roots):
                raise DesignError("complex roots must stand in conjugate pairs")

    @classmethod
    def of(cls, system: control.TransferFunction | ZeroPoleGain) -> ZeroPoleGain:
        """The roots of a transfer function with one input and one output.

        Raises `DesignError` where the coefficients do not determine the response to 1e-4: no form
        in which the polynomial is computed could then be right.
        """
        if isinstance(system, ZeroPoleGain):
            return system
        sampled = bool(control.isdtime(system, strict=True))
        top, bottom = (
            _Polynomial(np.trim_zeros(np.asarray(p[0][0], dtype=float), "f"), sampled)
            for p in (system.num, system.den)
        )
        zeros, poles = top.roots(), bottom.roots()
        return cls(zeros, poles, top.leading / bottom.leading, float(system.dt) if sampled else 0.0)

    def __mul__(self, other: ZeroPoleGain) -> ZeroPoleGain:
        """Both in series."""
        if self.dt != other.dt:
            raise DesignError(f"sample times {self.dt} and {other.dt} s do not fit each other")
        roots = (self.zeros + other.zeros, self.poles + other.poles)
        return ZeroPoleGain(*roots, self.gain * other.gain, self.dt)

    def response(self, frequencies: npt.ArrayLike) -> _Array:
        """Frequency response at these rad/s."""
        points = 1j * np.asarray(frequencies, dtype=float)
        if self.dt:
            points = np.expm1(points * self.dt)
        # One factor of each at a time: a long product alone may leave the range of numbers.
        value = np.full(points.shape, self.gain, dtype=complex)
        for index, pole in enumerate(self.poles):
            value /= points - pole
            if index < len(self.zeros):
                value *= points - self.zeros[index]
        return value

    def sampled(
        self, sample_time: float, method: IntegrationMethod = IntegrationMethod.TUSTIN
    ) -> ZeroPoleGain:
        """Each root of a continuous system on its own, s replaced as `method` says.

        Zeros at infinity become zeros at z = -1 (Tustin) or 0 (backward Euler); those at the rate
        of the method (2 / sample time by Tustin) go to infinity.
        """
        if self.dt or not sample_time > 0:
            raise DesignError(f"a continuous system and a sample time > 0 s, not {sample_time}")
        share = method.present_share

        def lead(root: complex) -> complex:
            return 1 / sample_time - share * root

        def moved(root: complex) -> complex:
            return complex(root / lead(root))

        excess = len(self.poles) - len(self.zeros)
        infinite = (complex(-1 / share),) * excess if share else ()
        gain = complex(self.gain)
        for index, pole in enumerate(self.poles):
            if not abs(lead(pole)) > 0:
                raise DesignError(f"the pole {pole} has no place in z at {sample_time} s")
            gain /= lead(pole)
            if index < len(self.zeros):
                zero = self.zeros[index]
                gain *= lead(zero) or -zero
        if share:
            gain *= share**excess
        zeros = tuple(moved(zero) for zero in self.zeros if lead(zero)) + infinite
        return ZeroPoleGain(zeros, tuple(map(moved, self.poles)), gain.real, sample_time)


class _Polynomial:
    """Coefficients of a polynomial, in falling powers, with what their rounding leaves open.

    In discrete time it is expanded about z = 1 with rational numbers, so that nothing more is lost.
    A whole number is taken as exact, any other as rounded to double.
    """

    def __init__(self, falling: npt.NDArray[np.float64], sampled: bool) -> None:
        if not len(falling):
            raise DesignError("a transfer function that is 0 has no roots")
        given = [Fraction(float(value)) for value in falling[::-1]]
        open_ = [
            Fraction(0) if value.denominator == 1 else abs(value) * Fraction(_HALF_ULP)
            for value in given
        ]
        if sampled:
            given = _about_one(given)
            open_ = _about_one(open_)
        self._exact, self._open = given, open_
        self._sampled = sampled
        self.leading = float(given[-1])

    def roots(self) -> tuple[complex, ...]:
        """All roots; those at 0 exactly there. Raises `DesignError`."""
        flat = self._integrators()
        values = np.array([float(c) for c in self._exact[flat:]])
        spread = np.array([float(c) for c in self._open[flat:]])
        if len(values) == 1:
            return (0j,) * flat
        found = np.roots(values[::-1])
        sizes = np.abs(found)
        low, high = sizes.min() / 10, sizes.max() * 10
        if self._sampled:
            low, high = min(low, 0.1), math.pi
        count = math.ceil(_POINTS_PER_DECADE * math.log10(high / low)) + 2
        frequencies = np.geomspace(low, high, count)
        points = np.expm1(1j * frequencies) if self._sampled else 1j * frequencies
        # A zero on the axis makes the value itself 0: the neighbours give the scale.
        exact = np.polyval(values[::-1], points)
        scale = np.array([np.abs(exact[max(k - 3, 0) : k + 4]).max() for k in range(count)])
        condition = float(np.max(np.polyval(spread[::-1], np.abs(points)) / scale))
        if condition > _WORST_CONDITION:
            raise DesignError(
                "the coefficients do not determine the response: their last digit changes it by "
                f"up to {condition:.2g} of its value; give the roots or factors (ZeroPoleGain), "
                "or a state space"
            )
        product = np.full(points.shape, values[-1], dtype=complex)
        for root in found:
            product *= points - root
        if float(np.max(np.abs(product - exact) / scale)) > _WORST_ROOTS:
            raise DesignError(
                "the roots of the polynomial cannot be found to 1e-6; give the roots or factors "
                "(ZeroPoleGain), or a state space"
            )
        return (0j,) * flat + _paired(found)

    def _integrators(self) -> int:
        """How many of the last coefficients are 0, or cannot be told from it."""
        count = 0
        while count + 1 < len(self._exact):
            value, spread = self._exact[count], self._open[count]
            if abs(value) > 2 * spread:
                break
            slope = abs(self._exact[count + 1])
            if value and spread > Fraction(_STILL_INTEGRATOR) * slope:
                raise DesignError(
                    "the coefficients do not tell slow poles from integrators: double precision "
                    "has too few digits for them; give the roots or factors (ZeroPoleGain), or a "
                    "state space"
                )
            count += 1
        return count


def _about_one(rising: Sequence[Fraction]) -> list[Fraction]:
    """Coefficients in delta = z - 1, rising."""
    return [
        sum((value * math.comb(n, k) for n, value in enumerate(rising) if n >= k), Fraction(0))
        for k in range(len(rising))
    ]


def _paired(roots: _Array) -> tuple[complex, ...]:
    """Real roots real, complex ones as exact conjugates; each with its partner."""
    upper = [complex(root) for root in roots if root.imag > 0]
    real = [complex(root.real) for root in roots if root.imag == 0]
    return tuple(real + [one for root in upper for one in (root, root.conjugate())])
