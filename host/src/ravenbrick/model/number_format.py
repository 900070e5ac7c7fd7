# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Binary fixed-point formats and how a value is rounded to one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from ravenbrick.errors import DesignError

__all__ = ["Enumeration", "FixedFormat", "Interval", "Rounding", "finest_fraction"]


class Rounding(Enum):
    """How a fixed-point value loses bits.

    ZERO cuts towards zero: the error is below 1 LSB. NEAREST rounds to the nearest value, halves
    upwards: the error is at most 1/2 LSB, at fewer instructions.
    """

    ZERO = "towards zero"
    NEAREST = "to nearest"

    @property
    def largest_error(self) -> float:
        """Bound of the error's size in LSB of the result."""
        return 1.0 if self is Rounding.ZERO else 0.5

    def divide(self, value: int, bits: int) -> int:
        """`value / 2**bits`, rounded."""
        if self is Rounding.NEAREST:
            return (value + ((1 << bits) >> 1)) >> bits
        size = abs(value) >> bits
        return -size if value < 0 else size


@dataclass(frozen=True)
class FixedFormat:
    """A signed integer of `width` bits that stands for itself times 2**-fraction.

    Variables have 16 or 32 bits, accumulators 32 or 64.
    """

    width: int
    fraction: int

    def __post_init__(self) -> None:
        if self.width not in (16, 32, 64):
            raise DesignError(f"a fixed-point format has 16, 32 or 64 bits, not {self.width}")

    def __str__(self) -> str:
        """The name that Simulink gives the format, such as sfix16_En11."""
        sign = "En" if self.fraction >= 0 else "E"
        return f"sfix{self.width}_{sign}{abs(self.fraction)}"

    @property
    def value(self) -> str:
        """The C type."""
        return f"int{self.width}_T"

    @property
    def scalar(self) -> Callable[[float], int]:
        """Python's integers hold the raw values."""
        return int

    @property
    def size_bytes(self) -> int:
        """Size of one value in memory."""
        return self.width // 8

    @property
    def lsb(self) -> float:
        """What the last bit stands for."""
        return math.ldexp(1.0, -self.fraction)

    @property
    def limits(self) -> tuple[int, int]:
        """Smallest and largest raw value."""
        return -(1 << (self.width - 1)), (1 << (self.width - 1)) - 1

    def raw(self, value: float) -> int:
        """The raw value nearest to `value`; raises `DesignError` if it does not fit."""
        raw = round(math.ldexp(value, self.fraction))
        low, high = self.limits
        if not low <= raw <= high:
            raise DesignError(f"{value} does not fit into {self}")
        return raw

    def real(self, raw: int) -> float:
        """What a raw value stands for."""
        return math.ldexp(raw, -self.fraction)


@dataclass(frozen=True)
class Enumeration:
    """Named alternatives, kept as their places 0, 1, 2 ... in a word."""

    name: str
    members: tuple[str, ...]

    @property
    def value(self) -> str:
        """The name of the type."""
        return self.name

    @property
    def scalar(self) -> Callable[[float], int]:
        """Python's integers hold the places."""
        return int

    @property
    def size_bytes(self) -> int:
        """Size of one value in memory, as the brick's binary interface has it."""
        return 4


@dataclass(frozen=True)
class Interval:
    """All values from `low` to `high`."""

    low: float
    high: float

    def __post_init__(self) -> None:
        if not self.low <= self.high:
            raise DesignError(f"a range needs low <= high, not {self.low} and {self.high}")

    @classmethod
    def around_zero(cls, size: float) -> Interval:
        """[-size, size]."""
        return cls(-abs(size), abs(size))

    @property
    def size(self) -> float:
        """Largest absolute value."""
        return max(abs(self.low), abs(self.high))

    def __add__(self, other: Interval) -> Interval:
        """All sums."""
        return Interval(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Interval) -> Interval:
        """All differences."""
        return Interval(self.low - other.high, self.high - other.low)

    def __mul__(self, other: Interval) -> Interval:
        """All products."""
        ends = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return Interval(min(ends), max(ends))

    def limited(self, low: float, high: float) -> Interval:
        """What is left after limiting each value to [low, high]."""
        return Interval(min(max(self.low, low), high), max(min(self.high, high), low))

    def hull(self, other: Interval) -> Interval:
        """The smallest interval with both in it."""
        return Interval(min(self.low, other.low), max(self.high, other.high))

    def within(self, other: Interval) -> bool:
        """Whether each value is also in `other`."""
        return other.low <= self.low and self.high <= other.high


def finest_fraction(interval: Interval, width: int) -> int:
    """The most fractional bits with which every value of the interval fits into `width` bits."""
    if interval.size == 0.0:
        return width - 1
    fraction = width - 1 - math.floor(math.log2(interval.size))
    high = (1 << (width - 1)) - 1
    low = -high - 1
    while not (
        low <= round(math.ldexp(interval.low, fraction))
        and round(math.ldexp(interval.high, fraction)) <= high
    ):
        fraction -= 1
    return fraction
