# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Why the bound of a program's least urgent task lies far above its response at the synchronous
release.

A response that ends a few cycles before a release of a more urgent task misses one job; a bound
that is a few cycles longer than the run meets it. Whether that is so is tried out on the brick: at
other phases the same program may run into that release, and with a job of the least urgent task
that is a little longer it must.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol, TypeVar

__all__ = ["CLOSE", "MISSED", "REACHED", "UNEXPLAINED", "Outcome", "explain"]

CLOSE = 1.05
TRIALS = 400
FRESH = 0.5
SPANS_US = (20, 50, 100, 200)
# A round takes 8 cycles, so that all steps make the job longer by half a percent of the response.
STEP, STEPS = 40_000, 25

REACHED = "reached at other phases"
MISSED = "ends just before a release of a more urgent task"
UNEXPLAINED = "not explained"


class Load(Protocol):
    """A task of a program."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def slot(self) -> int:
        """Rank by urgency; 0 is the least urgent."""

    @property
    def rounds(self) -> int:
        """Rounds of its loop."""

    @property
    def phase_us(self) -> int:
        """First release."""


L = TypeVar("L", bound=Load)


@dataclass(frozen=True)
class Outcome:
    """What was found for one program; `longer` is by how much its job grew, as a share of the
    response."""

    reason: str
    ratio: float
    longer: float = 0.0


def _with_other_phases(loads: Sequence[L], dice: random.Random) -> list[L]:
    """One phase changed, or all."""
    span = dice.choice(SPANS_US)
    if dice.random() < FRESH:
        return [replace(load, phase_us=dice.randrange(span)) for load in loads]
    chosen = dice.randrange(len(loads))
    found = list(loads)
    found[chosen] = replace(found[chosen], phase_us=dice.randrange(span))
    return found


def _longest_found(loads: Sequence[L], bound: int, longest: Callable[[list[L]], int]) -> int:
    """Longest response found with other phases; above the bound at once."""
    dice = random.Random(1)
    best, most = list(loads), longest(list(loads))
    for _ in range(TRIALS):
        tried = _with_other_phases(best, dice)
        seen = longest(tried)
        if seen > most:
            best, most = tried, seen
        if bound <= CLOSE * most:
            break
    return most


def explain(
    loads: list[L],
    any_bound: int,
    longest: Callable[[list[L]], int],
    together: Callable[[list[L]], tuple[int, int]],
) -> Outcome:
    """Why the bound is far above the response.

    `any_bound` holds for any phases, `longest` is the longest response of the least urgent task in
    a run, `together` its bound and response at the synchronous release, in cycles.
    """
    seen = _longest_found(loads, any_bound, longest)
    if any_bound <= CLOSE * seen:
        return Outcome(REACHED, any_bound / seen)
    bound, first = together(loads)
    grown, more = loads, max(1, first // STEP)
    for _ in range(STEPS):
        grown = [replace(x, rounds=x.rounds + more) if x.slot == 0 else x for x in grown]
        new_bound, response = together(grown)
        if response and new_bound <= CLOSE * response:
            return Outcome(MISSED, new_bound / response, (new_bound - bound) / first)
    return Outcome(UNEXPLAINED, bound / first)
