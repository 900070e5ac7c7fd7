# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles and seconds.

A brick says the frequency of its clock as a fraction, so that nothing is lost to rounding.
"""

from __future__ import annotations

from collections.abc import Iterable
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
        return self._rounded_up([microseconds], 1_000_000)[0]

    def cycles_of_ms(self, milliseconds: int) -> int:
        """Whole cycles of a whole number of milliseconds, rounded up."""
        return self._rounded_up([milliseconds], 1000)[0]

    def cycles_of_all_ms(self, milliseconds: Iterable[int]) -> list[int]:
        """As `cycles_of_ms`, of many numbers."""
        return self._rounded_up(milliseconds, 1000)

    def _rounded_up(self, counts: Iterable[int], per_second: int) -> list[int]:
        numerator, denominator = self.hertz.as_integer_ratio()
        divisor = per_second * denominator
        return [-(-count * numerator // divisor) for count in counts]


# 18.432 MHz crystal x 73 / 14 / 2 (AT91SAM7S256 with the NXT's PLL setting).
MASTER_CLOCK = Clock(Fraction(336_384_000, 7))
