# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Interpolation and moving slope beside SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.signal import savgol_coeffs

from ravenbrick.trace.interpolation import monotone_cubic, moving_slope


@pytest.mark.parametrize("seed", range(40))
def test_the_monotone_cubic_is_that_of_scipy(seed: int) -> None:
    """Through steps as an encoder gives them, with rests, turns and points on the knots."""
    random = np.random.default_rng(seed)
    knots = np.cumsum(random.uniform(1e-4, 1e-1, random.integers(3, 60)))
    values = np.cumsum(random.choice([-1.0, 0.0, 0.5, 1.0], knots.size))
    at = np.concatenate((knots, random.uniform(knots[0], knots[-1], 300)))
    expected = PchipInterpolator(knots, values)(at)
    assert np.allclose(monotone_cubic(knots, values, at), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("half", "interval"), [(1, 0.001), (4, 0.01), (40, 0.001)])
def test_the_moving_slope_is_that_of_savitzky_and_golay(half: int, interval: float) -> None:
    values = np.random.default_rng(half).normal(size=300).cumsum()
    kernel = savgol_coeffs(2 * half + 1, 1, deriv=1, delta=interval)
    padded = np.pad(values, half, mode="reflect", reflect_type="odd")
    expected = np.convolve(padded, kernel, mode="valid")
    assert np.allclose(moving_slope(values, interval, half), expected, rtol=1e-10, atol=1e-9)
