# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step responses cut out of live signals, to be laid over the design."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ravenbrick.trace.recording import Recording

__all__ = ["LiveStep", "live_steps"]

Floats = NDArray[np.float64]

_LONGEST_S = 2.0
_FEWEST_SAMPLES = 8


@dataclass(frozen=True)
class LiveStep:
    """One step: its instant (s), its height, and the output from 0 before to 1 at the set-point."""

    at_s: float
    height: float
    times: Floats
    values: Floats


def live_steps(recording: Recording, setpoint: str, output: str, mean: int = 1) -> list[LiveStep]:
    """All steps of a set-point and how the output followed, until the next step or for 2 s.

    A step is a change that is at least a tenth of the largest one. Each value of the output is the
    mean of `mean` consecutive samples, at the middle of their instants: speeds from counts, as
    differences of consecutive readings, become differences over so many periods. Raises
    `UsageError` when a signal was not recorded.
    """
    times, wanted = recording.signal(setpoint)
    output_times, followed = recording.signal(output)
    weights = np.full(mean, 1 / mean)
    output_times, followed = (
        np.convolve(column, weights, "valid") for column in (output_times, followed)
    )
    changes = np.diff(wanted)
    if not changes.size or not np.any(changes):
        return []
    places = np.flatnonzero(np.abs(changes) >= 0.1 * np.max(np.abs(changes))) + 1
    ends = [*times[places[1:]], np.inf]
    steps = []
    for place, end in zip(places, ends, strict=True):
        begin, height = float(times[place]), float(wanted[place] - wanted[place - 1])
        window = (output_times >= begin) & (output_times < min(end, begin + _LONGEST_S))
        if np.count_nonzero(window) < _FEWEST_SAMPLES:
            continue
        start = float(wanted[place - 1])
        values = (followed[window] - start) / height
        steps.append(LiveStep(begin, height, output_times[window] - begin, values))
    return steps
