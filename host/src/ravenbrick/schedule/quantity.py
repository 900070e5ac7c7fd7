# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Exact times: whole numbers where possible, otherwise fractions; never rounded."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction
from typing import Literal

__all__ = ["Time", "ceiling", "common_multiple", "exact", "shown"]

Time = int | Fraction
# A number with a larger one would take for ever to write down.
LARGEST_EXPONENT = 400
EXPONENT = re.compile(r"[eE]([-+]?\d{1,4000})\s*$")
Toward = Literal["nearest", "up", "down"]


def exact(value: object) -> Time:
    """The number as written: 2.5, '2.5' and Fraction(5, 2) are the same time.

    A float means its shortest decimal text. Raises `ValueError` for a number that is not finite.
    """
    if isinstance(value, bool):
        raise ValueError(f"{value} is not a number")
    if isinstance(value, int):
        return value
    if isinstance(value, float):
        value = repr(value)
    if not isinstance(value, str | Fraction | Decimal):
        raise ValueError(f"{value!r} is not a number")
    exponent = EXPONENT.search(str(value))
    if exponent and abs(int(exponent[1])) > LARGEST_EXPONENT:
        raise ValueError(f"'{value}' has an exponent beyond {LARGEST_EXPONENT}")
    try:
        number = Fraction(value)
    except (ValueError, OverflowError, ZeroDivisionError):
        raise ValueError(f"'{value}' is not a finite number") from None
    return number.numerator if number.denominator == 1 else number


def ceiling(dividend: Time, divisor: Time) -> int:
    """Smallest whole number at least `dividend / divisor`."""
    return -(-dividend // divisor)


def common_multiple(times: Iterable[Time]) -> Time:
    """Least common multiple of positive times, exact for fractions too."""
    fractions = [Fraction(time) for time in times]
    denominator = math.lcm(*(fraction.denominator for fraction in fractions))
    numerator = math.lcm(*(int(fraction * denominator) for fraction in fractions))
    return exact(Fraction(numerator, denominator))


def shown(time: Time, digits: int = 6, toward: Toward = "nearest") -> str:
    """Decimal text; exact where it has at most `digits` decimals, else rounded as told."""
    if isinstance(time, int):
        return str(time)
    parts = time * 10**digits
    count = {"nearest": round(parts), "up": math.ceil(parts), "down": math.floor(parts)}[toward]
    text = f"{Decimal(count).scaleb(-digits):f}"
    return text.rstrip("0").rstrip(".")
