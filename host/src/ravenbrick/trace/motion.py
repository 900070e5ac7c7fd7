# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step response and path, as the compiled module measures them.

The speed is the slope of a straight line fitted to the encoder's edges over a window around each
instant, never a difference of raw counts: one count of 1 degree in 4 ms is 250 degrees/s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ravenbrick.installation import brick_module

__all__ = ["PathMeasures", "StepMeasures", "fitted_speed", "speed_filter"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class StepMeasures:
    """Step response; times in s after the step, speeds in rad/s, overshoot as a fraction.

    `settling_time` is the last instant outside 2 % of the final value; None when the speed does
    not stay inside for the last 0.1 s of the window.
    """

    setpoint: float
    final_value: float
    settling_time: float | None
    overshoot: float
    rise_time: float | None
    steady_state_error: float


@dataclass(frozen=True)
class PathMeasures:
    """Largest distance from the initial straight line, and length of the path, in m.

    `lateral_deviation` is None when the vehicle did not drive the distance asked for.
    """

    lateral_deviation: float | None
    distance: float


def speed_filter() -> str:
    """How speeds are measured."""
    return (
        "slope of a least-squares line through the encoder's edges, window "
        f"{1000 * brick_module().SPEED_WINDOW:.0f} ms, centred (no delay)"
    )


def fitted_speed(
    times: Floats, counts: Floats, radians_per_count: float, window: float | None = None
) -> Floats:
    """Angular velocity (rad/s) at `times` (s, evenly spaced), shape (n,), from encoder counts.

    `window` is the length of the fitted line (s), that of the measures unless given.
    """
    brick = brick_module()
    length = brick.SPEED_WINDOW if window is None else window
    return np.frombuffer(brick.fitted_speed(times, counts, radians_per_count, length), "<f8")
