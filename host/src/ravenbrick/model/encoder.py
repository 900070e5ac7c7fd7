# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The rotary encoder and the ways to get a speed from its counts."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

__all__ = ["Encoder", "SpeedWindow"]


@dataclass(frozen=True)
class Encoder:
    """An incremental encoder: `counts_per_turn` counts, `phase` in counts (0 to 1).

    The NXT motor gives 360 counts per turn of the output shaft: one count is one degree.
    """

    counts_per_turn: int = 360
    phase: float = 0.0

    def count(self, angle: float) -> int:
        """The count at `angle` (rad): the edges passed since angle 0 at phase 0."""
        return math.floor(angle * self.counts_per_turn / math.tau + self.phase)

    def angle(self, count: int) -> float:
        """The angle (rad) that a count stands for."""
        return count * math.tau / self.counts_per_turn

    def speed_quantum(self, interval: float) -> float:
        """Smallest speed difference (rad/s) that a count difference over `interval` (s) shows."""
        return math.tau / (self.counts_per_turn * interval)


class SpeedWindow:
    """Speed from the count difference over the last `length` samples of `sample_time` (s).

    Before `length` samples have passed, the first count stands for the earlier ones. With length 1
    it is the plain one-sample difference. The delay is half the window.
    """

    def __init__(self, encoder: Encoder, length: int, sample_time: float) -> None:
        if length < 1:
            raise ValueError(f"the window must be at least 1 sample long, not {length}")
        self._encoder = encoder
        self._interval = length * sample_time
        self._counts: deque[int] = deque(maxlen=length + 1)

    def sample(self, count: int) -> float:
        """Take a count and return the speed (rad/s)."""
        if not self._counts:
            self._counts.extend([count] * (self._counts.maxlen or 1))
        else:
            self._counts.append(count)
        return self._encoder.angle(self._counts[-1] - self._counts[0]) / self._interval
