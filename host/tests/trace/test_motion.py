# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The speed from encoder counts beside SciPy's; the crate `measures` tests what is made of it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.signal import savgol_coeffs

from ravenbrick.trace.motion import fitted_speed


@pytest.mark.parametrize("seed", range(40))
def test_the_fitted_speed_is_that_of_scipy(seed: int) -> None:
    """A monotone cubic through edges with rests and turns, then Savitzky's and Golay's slope."""
    random = np.random.default_rng(seed)
    interval, window = 0.001, float(random.choice([0.002, 0.02, 0.08]))
    times = np.arange(int(random.integers(200, 1500)), dtype=np.float64) * np.float64(interval)
    moves = random.choice([-1.0, 0.0, 0.0, 0.0, 1.0], times.size)
    counts = np.cumsum(moves * (np.sin(times * random.uniform(2, 9)) > -0.5))
    at = np.flatnonzero(np.diff(counts)) + 1
    edges, angles = (times[at] + times[at - 1]) / 2, (counts[at] + counts[at - 1]) / 2
    slope = (angles[-1] - angles[-2]) / (edges[-1] - edges[-2])
    end = angles[-1] + slope * (times[-1] - edges[-1])
    end = np.clip(end, counts[-1] - 0.5, counts[-1] + 0.5)
    smooth = PchipInterpolator(
        np.concatenate(([times[0]], edges, [times[-1]])),
        np.concatenate(([counts[0]], angles, [end])),
    )(times)
    half = max(round(window / interval / 2), 1)
    kernel = savgol_coeffs(2 * half + 1, 1, deriv=1, delta=times[1] - times[0])
    padded = np.pad(smooth, half, mode="reflect", reflect_type="odd")
    expected = 0.01 * np.convolve(padded, kernel, mode="valid")
    assert fitted_speed(times, counts, 0.01, window) == pytest.approx(expected, rel=1e-9, abs=1e-9)
