# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step response and path, measured.

The speed is the slope of a straight line fitted to the encoder's edges over a window around each
instant, never a difference of raw counts: one count of 1 degree in 4 ms is 250 degrees/s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ravenbrick.trace.interpolation import monotone_cubic, moving_slope

__all__ = [
    "SPEED_FILTER",
    "PathMeasures",
    "StepMeasures",
    "count_difference_speed",
    "fitted_speed",
    "path_measures",
    "step_measures",
]

Floats = NDArray[np.float64]
WINDOW = 0.080
SPEED_FILTER = (
    f"slope of a least-squares line through the encoder's edges, window {WINDOW * 1000:.0f} ms, "
    "centred (no delay)"
)
SETTLING_BAND = 0.02
FINAL_SHARE = 0.25
HOLD = 0.1


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


def _edges(times: Floats, counts: Floats) -> tuple[Floats, Floats]:
    """Instants of the encoder's edges and the angle (counts) at each: half-way between counts."""
    at = np.flatnonzero(np.diff(counts)) + 1
    instants = (times[at] + times[at - 1]) / 2
    return instants, (counts[at] + counts[at - 1]) / 2


def _position(times: Floats, counts: Floats) -> Floats:
    """Angle (counts) at `times`, smooth through the edges, on with the last slope after the last.

    Before the first edge the shaft is taken to be at rest in the middle of its count.
    """
    instants, angles = _edges(times, counts)
    if instants.size < 2:
        return counts.astype(np.float64)
    slope = (angles[-1] - angles[-2]) / (instants[-1] - instants[-2])
    end = angles[-1] + slope * (times[-1] - instants[-1])
    end = float(np.clip(end, counts[-1] - 0.5, counts[-1] + 0.5))
    knots = np.concatenate(([times[0]], instants, [times[-1]]))
    values = np.concatenate(([counts[0]], angles, [end]))
    return monotone_cubic(knots, values, times)


def fitted_speed(
    times: Floats, counts: Floats, radians_per_count: float, window: float = WINDOW
) -> Floats:
    """Angular velocity (rad/s) at `times` (s, evenly spaced), shape (n,), from encoder counts."""
    interval = float(times[1] - times[0])
    half = max(round(window / interval / 2), 1)
    return moving_slope(_position(times, counts), interval, half) * radians_per_count


def count_difference_speed(
    times: Floats, counts: Floats, radians_per_count: float, sample_time: float
) -> tuple[Floats, Floats]:
    """The plain difference of counts every `sample_time`, for comparison: instants and rad/s."""
    step = max(round(sample_time / float(times[1] - times[0])), 1)
    sampled = counts[::step]
    return times[::step][1:], np.diff(sampled) * radians_per_count / sample_time


def step_measures(times: Floats, speed: Floats, setpoint: float) -> StepMeasures:
    """Measures of a response to a step from rest at `times[0]` to `setpoint` (rad/s).

    The final value is the mean over the last quarter of the window.
    """
    final = float(np.mean(speed[int(len(speed) * (1 - FINAL_SHARE)) :]))
    scale = abs(final) if final else 1.0
    outside = np.flatnonzero(np.abs(speed - final) > SETTLING_BAND * scale)
    settled: float | None = 0.0
    if outside.size:
        last = float(times[outside[-1]])
        settled = last - float(times[0]) if times[-1] - last >= HOLD else None
    peak = float(np.max(speed * np.sign(final)))
    return StepMeasures(
        setpoint=setpoint,
        final_value=final,
        settling_time=settled,
        overshoot=max(peak / scale - 1.0, 0.0),
        rise_time=_rise_time(times, speed, final),
        steady_state_error=(setpoint - final) / setpoint if setpoint else 0.0,
    )


def _rise_time(times: Floats, speed: Floats, final: float) -> float | None:
    progress = speed / final if final else np.zeros_like(speed)
    reached = [np.flatnonzero(progress >= level) for level in (0.1, 0.9)]
    if not all(found.size for found in reached):
        return None
    return float(times[reached[1][0]] - times[reached[0][0]])


def path_measures(x: Floats, y: Floats, heading: float, distance: float) -> PathMeasures:
    """Deviation over `distance` (m) from the line through the first point along `heading` (rad)."""
    steps = np.hypot(np.diff(x), np.diff(y))
    length = np.concatenate(([0.0], np.cumsum(steps)))
    across = -(x - x[0]) * np.sin(heading) + (y - y[0]) * np.cos(heading)
    if length[-1] < distance:
        return PathMeasures(None, float(length[-1]))
    within = length <= distance
    return PathMeasures(float(np.max(np.abs(across[within]))), float(length[-1]))
