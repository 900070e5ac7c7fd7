# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Times of a model in a smaller unit, in which they are whole numbers: fractions are slow."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from typing import Any, TypeVar, cast

from ravenbrick.schedule.model import Task

__all__ = ["common_denominator", "multiplied"]

Model = TypeVar("Model")
# Numbers and shares that are no times.
OTHERS = frozenset({"priority", "job", "jobs", "most"})


def multiplied(value: Model, factor: Fraction | int) -> Model:
    """A model, or several, with each time multiplied."""
    if factor == 1:
        return value
    result: Any = value
    if isinstance(value, int | Fraction):
        result = value * factor
        if isinstance(result, Fraction) and result.denominator == 1:
            result = result.numerator
    elif isinstance(value, tuple):
        result = tuple(multiplied(each, factor) for each in value)
    elif is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in fields(value) if field.name not in OTHERS]
        times = {name: multiplied(getattr(value, name), factor) for name in names}
        if isinstance(value, Task):
            limits = zip(value.limits, times["limits"], strict=True)
            times["limits"] = tuple((share, *spans) for (share, *_), (_, *spans) in limits)
        result = replace(value, **times)
    return cast("Model", result)


def common_denominator(values: Iterable[Any]) -> int:
    """The least factor that makes all times whole numbers; shares count as times."""
    found = 1
    for value in values:
        if isinstance(value, Fraction):
            found = math.lcm(found, value.denominator)
        elif isinstance(value, tuple):
            found = math.lcm(found, common_denominator(value))
        elif is_dataclass(value):
            inner = (getattr(value, f.name) for f in fields(value) if f.name not in OTHERS)
            found = math.lcm(found, common_denominator(inner))
    return found
