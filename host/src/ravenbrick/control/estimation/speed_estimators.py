# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ways to a speed from an encoder: difference, window, filter, edge times, tracking, observer."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ravenbrick.control.synthesis.regulator import kalman
from ravenbrick.errors import DesignError
from ravenbrick.model import Encoder, SpeedLoop, SpeedWindow
from ravenbrick.model.lazy import control

__all__ = [
    "EdgeTimes",
    "FilteredDifference",
    "Measurement",
    "MotorObserver",
    "SpeedEstimator",
    "TrackingLoop",
    "WindowEstimator",
]


@dataclass(frozen=True)
class Measurement:
    """What a sample brings: `instant` (s), `count`, `last_edge` (s) of the newest count.

    `true_speed` (rad/s) is for comparison; an estimator does not look at it.
    """

    instant: float
    count: int
    last_edge: float
    true_speed: float


class SpeedEstimator(Protocol):
    """Takes a measurement and the voltage (V) commanded at the last one; gives rad/s."""

    def estimate(self, measurement: Measurement, voltage: float) -> float:
        """The speed (rad/s)."""


class WindowEstimator:
    """Difference over `length` samples; 1 is the plain difference."""

    def __init__(self, encoder: Encoder, length: int, sample_time: float) -> None:
        self._window = SpeedWindow(encoder, length, sample_time)

    def estimate(self, measurement: Measurement, voltage: float) -> float:
        """Counts over time."""
        return self._window.sample(measurement.count)


class FilteredDifference:
    """One-sample difference through a first-order low pass of `cutoff` Hz."""

    def __init__(self, encoder: Encoder, cutoff: float, sample_time: float) -> None:
        if not 0 < cutoff < 0.5 / sample_time:
            raise DesignError(
                f"the cutoff must lie between 0 and half the sample rate, not {cutoff} Hz"
            )
        self._difference = SpeedWindow(encoder, 1, sample_time)
        self._share = 1 - math.exp(-math.tau * cutoff * sample_time)
        self._speed = 0.0

    def estimate(self, measurement: Measurement, voltage: float) -> float:
        """The filter's state."""
        self._speed += self._share * (self._difference.sample(measurement.count) - self._speed)
        return self._speed


class EdgeTimes:
    """Counts between the newest edges of two samples over the time between those edges.

    `resolution` (s) is that of the time stamps. Without a new edge the speed is at most one count
    in the time since the last one.
    """

    def __init__(self, encoder: Encoder, resolution: float) -> None:
        if not resolution > 0:
            raise DesignError(f"the time stamps' resolution must be > 0 s, not {resolution}")
        self._encoder = encoder
        self._resolution = resolution
        self._count: int | None = None
        self._edge = 0
        self._speed = 0.0

    def estimate(self, measurement: Measurement, voltage: float) -> float:
        """From edge to edge."""
        edge = math.floor(measurement.last_edge / self._resolution)
        if self._count is None:
            self._count, self._edge = measurement.count, edge
        counts, ticks = measurement.count - self._count, edge - self._edge
        if counts and ticks > 0:
            self._speed = self._encoder.angle(counts) / (ticks * self._resolution)
            self._count, self._edge = measurement.count, edge
        elif not counts:
            waited = measurement.instant - self._edge * self._resolution
            limit = self._encoder.angle(1) / max(waited, self._resolution)
            self._speed = min(max(self._speed, -limit), limit)
        return self._speed


class TrackingLoop:
    """A second-order loop that follows the counted angle; natural frequency `bandwidth` Hz."""

    def __init__(self, encoder: Encoder, bandwidth: float, sample_time: float) -> None:
        frequency = math.tau * bandwidth
        if not 0 < frequency * sample_time < 1:
            raise DesignError(f"the bandwidth {bandwidth} Hz does not suit the sample time")
        self._encoder = encoder
        self._sample_time = sample_time
        self._gains = 2 * frequency, frequency**2
        self._angle = self._speed = 0.0

    def estimate(self, measurement: Measurement, voltage: float) -> float:
        """The loop's speed."""
        error = self._encoder.angle(measurement.count) - self._angle
        self._angle += self._sample_time * (self._speed + self._gains[0] * error)
        self._speed += self._sample_time * self._gains[1] * error
        return self._speed


class MotorObserver:
    """Steady Kalman filter on the motor's model with a constant disturbance voltage.

    The count's error is that of rounding (variance 1/12 count^2); `disturbance` (V per sample) is
    how fast the disturbance may drift, `speed_noise` (rad/s per sample) what else moves the speed.
    """

    def __init__(
        self,
        encoder: Encoder,
        loop: SpeedLoop,
        sample_time: float,
        disturbance: float = 0.002,
        speed_noise: float = 0.005,
    ) -> None:
        self._encoder = encoder
        rate, gain = 1 / loop.time_constant, loop.gain / loop.time_constant
        matrix = [[0.0, 1.0, 0.0], [0.0, -rate, gain], [0.0, 0.0, 0.0]]
        plant = control.ss(matrix, [[0.0], [gain], [0.0]], [[1.0, 0.0, 0.0]], [[0.0]])
        sampled = control.sample_system(plant, sample_time, "zoh")
        process = np.diag([0.0, speed_noise**2, disturbance**2])
        observer = kalman(sampled, process, [[encoder.angle(1) ** 2 / 12]])
        self._a, self._b = np.asarray(sampled.A), np.asarray(sampled.B)[:, 0]
        self._gain = np.linalg.solve(self._a, observer.gain)[:, 0]
        self._state = np.zeros(3)

    def estimate(self, measurement: Measurement, voltage: float) -> float:
        """Prediction with the last voltage, corrected by the count, read at mid-count."""
        self._state = self._a @ self._state + self._b * voltage
        middle = self._encoder.angle(1) / 2 if measurement.count else 0.0
        error = self._encoder.angle(measurement.count) + middle - self._state[0]
        self._state = self._state + self._gain * error
        return float(self._state[1])
