# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Stimuli from a run that the page saved: its inputs at their cycles."""

from __future__ import annotations

from fractions import Fraction

from ravenbrick.target.run_file import read_run_file
from ravenbrick.target.stimulus import Channels, Sequence

__all__ = ["read"]


def read(sequence: Sequence, channels: Channels) -> None:
    """Fill `sequence`; raises as `read_run_file`."""
    path = sequence.path
    inputs = read_run_file(path).inputs
    channels.require(path, 1, {timed.name for timed in inputs})
    for timed in inputs:
        name = channels.input_of(path, 1, timed.name)
        sequence.at(1, Fraction(timed.at_cycles) / sequence.clock.hertz)
        if name is not None:
            sequence.set(1, name, timed.value)
