# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Exact instants on linear flows: extrema and band crossings by root finding, not from a grid."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError
from ravenbrick.model.lazy import linalg, optimize

__all__ = ["FlowMatrix", "Segment", "largest_value", "settling_time"]

Array = npt.NDArray[np.float64]
_CELLS_PER_RADIAN = 4
_MOST_CELLS = 1_000_000


@dataclass(frozen=True, eq=False)
class FlowMatrix:
    """x' = A x over `duration` (s), cut into cells much shorter than its fastest mode."""

    matrix: Array
    duration: float

    @cached_property
    def cell_count(self) -> int:
        """Number of cells; in each the output's slope changes sign at most once."""
        fastest = float(np.abs(np.linalg.eigvals(self.matrix)).max(initial=0.0))
        count = math.ceil(self.duration * fastest * _CELLS_PER_RADIAN) or 1
        if count > _MOST_CELLS:
            raise DesignError(
                f"the modes are too far apart for exact step metrics: the fastest has "
                f"{fastest:.3g} rad/s over {self.duration:.3g} s; remove fast parasitic poles"
            )
        return count

    @cached_property
    def cell(self) -> float:
        """Length of a cell in s."""
        return self.duration / self.cell_count

    @cached_property
    def cell_transition(self) -> Array:
        """exp(A cell)."""
        return np.asarray(linalg.expm(self.matrix * self.cell))

    @cached_property
    def transition(self) -> Array:
        """exp(A duration)."""
        return np.asarray(linalg.expm(self.matrix * self.duration))


@dataclass(frozen=True, eq=False)
class Segment:
    """The output `row @ x` on a flow that begins at time `start` (s) in `state`."""

    flow: FlowMatrix
    start: float
    state: Array
    row: Array

    def value(self, elapsed: float) -> float:
        """Output `elapsed` seconds after the start."""
        return float(self.row @ linalg.expm(self.flow.matrix * elapsed) @ self.state)

    def turning_points(self) -> list[tuple[float, float]]:
        """(elapsed, value) at both ends and at every extremum, in order of time."""
        slope_row = self.row @ self.flow.matrix
        points = [(0.0, float(self.row @ self.state))]
        state, cell = self.state, self.flow.cell
        slope = float(slope_row @ state)
        for index in range(self.flow.cell_count):
            following = self.flow.cell_transition @ state
            next_slope = float(slope_row @ following)
            if slope * next_slope < 0.0:
                elapsed = index * cell + _slope_root(self.flow.matrix, state, slope_row, cell)
                points.append((elapsed, self.value(elapsed)))
            state, slope = following, next_slope
        points.append((self.flow.duration, float(self.row @ state)))
        return points


def _slope_root(matrix: Array, state: Array, row: Array, cell: float) -> float:
    def slope(elapsed: float) -> float:
        return float(row @ linalg.expm(matrix * elapsed) @ state)

    return float(optimize.brentq(slope, 0.0, cell, xtol=1e-15))


def largest_value(segments: Sequence[Segment]) -> float:
    """The largest output over all segments."""
    return max(value for segment in segments for _, value in segment.turning_points())


def settling_time(segments: Sequence[Segment], band: float) -> float:
    """The last instant (s) at which the output leaves [-band, band]; 0 if it never does.

    `segments` follow each other and reach far enough that nothing happens afterwards.
    """
    for segment in reversed(_leaving(segments, band)):
        points = segment.turning_points()
        for (left, first), (right, last) in zip(points[-2::-1], points[:0:-1], strict=True):
            if abs(last) > band:
                return segment.start + right
            if abs(first) > band:
                return segment.start + _crossing(segment, left, right, math.copysign(band, first))
    return 0.0


def _leaving(segments: Sequence[Segment], band: float) -> list[Segment]:
    """The segments without those that stay in [-band, band] and have no extremum, all at once."""
    stays = np.zeros(len(segments), dtype=bool)
    for flow in {id(s.flow): s.flow for s in segments}.values():
        places = [i for i, segment in enumerate(segments) if segment.flow is flow]
        states = np.array([segments[i].state for i in places])
        rows = np.array([segments[i].row for i in places])
        slope = np.einsum("ij,ij->i", rows @ flow.matrix, states)
        inside = np.abs(np.einsum("ij,ij->i", rows, states)) <= band
        for _ in range(flow.cell_count):
            states = states @ flow.cell_transition.T
            next_slope = np.einsum("ij,ij->i", rows @ flow.matrix, states)
            inside &= slope * next_slope >= 0
            slope = next_slope
        stays[places] = inside & (np.abs(np.einsum("ij,ij->i", rows, states)) <= band)
    return [segment for segment, inside in zip(segments, stays, strict=True) if not inside]


def _crossing(segment: Segment, left: float, right: float, level: float) -> float:
    """From beyond a level to this side of it; an end where rounding errors decide is the place."""

    def beyond(instant: float) -> float:
        return math.copysign(1.0, level) * (segment.value(instant) - level)

    if beyond(left) <= 0:
        return left
    return right if beyond(right) >= 0 else float(optimize.brentq(beyond, left, right, xtol=1e-14))
