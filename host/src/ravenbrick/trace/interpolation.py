# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Monotone cubic interpolation and the slope of a moving line fit, as SciPy computes them.

SciPy's interpolation and signal processing take longer to load than a run takes to be measured.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["monotone_cubic", "moving_slope"]

Floats = NDArray[np.float64]


def monotone_cubic(knots: Floats, values: Floats, at: Floats) -> Floats:
    """The cubic through all points that rises and falls only where they do, at `at`.

    `knots` (ascending) and `values` have the shape (n,) with n >= 3; `at` lies within the knots.
    Slopes are those of F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984).
    """
    widths = np.diff(knots)
    rises = np.diff(values) / widths
    slopes = _slopes(widths, rises)
    cell = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, widths.size - 1)
    width, along = widths[cell], at - knots[cell]
    first, last, rise = slopes[cell], slopes[cell + 1], rises[cell]
    bend = (3 * rise - 2 * first - last) / width
    twist = (first + last - 2 * rise) / width**2
    return np.asarray(values[cell] + along * (first + along * (bend + along * twist)))


def _slopes(widths: Floats, rises: Floats) -> Floats:
    """At each knot: a weighted harmonic mean of the rises beside it, 0 at an extremum."""
    before, after = rises[:-1], rises[1:]
    steady = before * after > 0
    early, late = 2 * widths[1:] + widths[:-1], widths[1:] + 2 * widths[:-1]
    slopes = np.zeros(widths.size + 1)
    inner = slopes[1:-1]
    inner[steady] = ((early + late)[steady]) / (
        early[steady] / before[steady] + late[steady] / after[steady]
    )
    slopes[0] = _end_slope(widths[0], widths[1], rises[0], rises[1])
    slopes[-1] = _end_slope(widths[-1], widths[-2], rises[-1], rises[-2])
    return slopes


def _end_slope(width: float, next_width: float, rise: float, next_rise: float) -> float:
    """That of the parabola through the three outermost points, limited to keep the shape."""
    slope = ((2 * width + next_width) * rise - width * next_rise) / (width + next_width)
    if slope * rise <= 0:
        return 0.0
    if rise * next_rise <= 0 and abs(slope) > 3 * abs(rise):
        return 3 * rise
    return slope


def moving_slope(values: Floats, interval: float, half: int) -> Floats:
    """Slope per unit of `interval` of the least-squares line through each value and its `half`
    neighbours on either side; mirrored through the end points beyond the ends. Shape (n,)."""
    offsets = np.arange(half, -half - 1, -1)
    padded = np.pad(values, half, mode="reflect", reflect_type="odd")
    return np.convolve(padded, offsets / (offsets @ offsets * interval), mode="valid")
