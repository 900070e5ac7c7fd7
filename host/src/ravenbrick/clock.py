# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles and seconds.

A brick says the frequency of its clock as a fraction, so that nothing is lost to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

__all__ = ["MASTER_CLOCK", "Clock"]


@dataclass(frozen=True)
class Clock:
    """A clock of exactly `hertz` cycles per second."""

    hertz: Fraction

    def seconds(self, cycles: int) -> float:
        """Duration of a number of cycles."""
        return float(cycles / self.hertz)

    def instants(self, cycles: NDArray[np.uint64]) -> NDArray[np.float64]:
        """Seconds of many cycle counts at once."""
        return cycles.astype(np.float64) / float(self.hertz)

    def cycles(self, seconds: float) -> int:
        """The nearest whole number of cycles."""
        return round(Fraction(seconds) * self.hertz)

    def cycles_of_us(self, microseconds: int) -> int:
        """Whole cycles of a whole number of microseconds, rounded up."""
        return -(-microseconds * self.hertz.numerator // (1_000_000 * self.hertz.denominator))

    def cycles_of_ms(self, milliseconds: int) -> int:
        """Whole cycles of a whole number of milliseconds, rounded up."""
        return self.cycles_of_us(1000 * milliseconds)


# 18.432 MHz crystal x 73 / 14 / 2 (AT91SAM7S256 with the NXT's PLL setting).
MASTER_CLOCK = Clock(Fraction(336_384_000, 7))
