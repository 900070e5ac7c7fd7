# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of a design over the tolerances of its plant: random samples and worst case."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError

__all__ = ["Extreme", "MonteCarlo", "Tolerance", "monte_carlo", "worst_case"]

_MOST_CORNERS = 1 << 12
_REFINEMENTS = 3

Figures = Callable[[Mapping[str, float]], Mapping[str, float]]
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Tolerance:
    """A parameter between `low` and `high`."""

    name: str
    low: float
    high: float

    def __post_init__(self) -> None:
        if not self.low <= self.high:
            raise DesignError(f"tolerance of '{self.name}': low {self.low} is above {self.high}")

    @classmethod
    def relative(cls, name: str, nominal: float, share: float) -> Tolerance:
        """`nominal` with the same share up and down, such as 0.2 for 20 %."""
        ends = sorted((nominal * (1 - share), nominal * (1 + share)))
        return cls(name, *ends)


@dataclass(frozen=True)
class Extreme:
    """A figure's least or largest value and the parameters that give it."""

    value: float
    parameters: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class MonteCarlo:
    """Random samples: `parameters` and `figures` by name, arrays over the samples that work.

    `failures` holds the parameters of those that do not, such as unstable loops, with the reason.
    """

    parameters: Mapping[str, npt.NDArray[np.float64]]
    figures: Mapping[str, npt.NDArray[np.float64]]
    failures: tuple[tuple[Mapping[str, float], str], ...]

    def percentile(self, figure: str, share: float) -> float:
        """The value that `share` (0 to 1) of the samples do not exceed."""
        return float(np.percentile(self.figures[figure], 100 * share))


def monte_carlo(
    figures: Figures,
    tolerances: Sequence[Tolerance],
    count: int,
    seed: int,
    progress: Progress | None = None,
) -> MonteCarlo:
    """`count` evenly distributed samples, the same for the same seed.

    `figures` raises `DesignError` where it has none. `progress` is told the number done and the
    total after each sample.
    """
    random = np.random.default_rng(seed)
    low = np.array([tolerance.low for tolerance in tolerances])
    high = np.array([tolerance.high for tolerance in tolerances])
    good: list[tuple[Mapping[str, float], Mapping[str, float]]] = []
    failures: list[tuple[Mapping[str, float], str]] = []
    for index in range(count):
        values = low + (high - low) * random.random(len(low))
        point = {t.name: float(v) for t, v in zip(tolerances, values, strict=True)}
        try:
            good.append((point, figures(point)))
        except DesignError as error:
            failures.append((point, error.sentence))
        if progress is not None:
            progress(index + 1, count)
    if not good:
        reason = failures[0][1] if failures else "no samples were asked for"
        raise DesignError(f"no sample has figures: {reason}")
    names = good[0][1]
    return MonteCarlo(
        {t.name: np.array([point[t.name] for point, _ in good]) for t in tolerances},
        {name: np.array([values[name] for _, values in good]) for name in names},
        tuple(failures),
    )


def worst_case(
    figures: Figures, tolerances: Sequence[Tolerance], progress: Progress | None = None
) -> dict[str, tuple[Extreme, Extreme]]:
    """Least and largest value of each figure over the box of tolerances.

    All corners are tried; from the best corner on, one parameter at a time is searched on a grid
    that becomes finer, which finds extremes inside. Not a proof for figures with several extremes.
    Raises the `DesignError` of a corner without figures: the design does not hold there.
    """
    if 2 ** len(tolerances) > _MOST_CORNERS:
        raise DesignError(f"{len(tolerances)} tolerances have too many corners; choose at most 12")
    figures = _remembered(figures)
    ends = [(tolerance.low, tolerance.high) for tolerance in tolerances]
    names = [tolerance.name for tolerance in tolerances]
    corners = [dict(zip(names, corner, strict=True)) for corner in itertools.product(*ends)]
    results = []
    for index, corner in enumerate(corners):
        results.append((corner, figures(corner)))
        if progress is not None:
            progress(index + 1, len(corners))
    found = {}
    for name in results[0][1]:
        extremes = []
        for sign in (-1.0, 1.0):
            start, values = max(results, key=lambda item: sign * item[1][name])
            best = Extreme(values[name], start)
            extremes.append(_refine(figures, tolerances, name, sign, best))
        found[name] = (extremes[0], extremes[1])
    return found


def _remembered(figures: Figures) -> Figures:
    """The same figures, each point computed once."""
    known: dict[tuple[float, ...], Mapping[str, float]] = {}

    def look_up(point: Mapping[str, float]) -> Mapping[str, float]:
        place = tuple(point.values())
        if place not in known:
            known[place] = figures(point)
        return known[place]

    return look_up


def _refine(
    figures: Figures, tolerances: Sequence[Tolerance], name: str, sign: float, best: Extreme
) -> Extreme:
    share = 1.0
    for _ in range(_REFINEMENTS):
        for tolerance in tolerances:
            reach = share * (tolerance.high - tolerance.low)
            centre = best.parameters[tolerance.name]
            for value in np.linspace(centre - reach, centre + reach, 7):
                inside = float(min(max(value, tolerance.low), tolerance.high))
                point = {**best.parameters, tolerance.name: inside}
                result = figures(point)[name]
                if sign * result > sign * best.value:
                    best = Extreme(result, point)
        share /= 4
    return best
