# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a run counted at the places of flow facts."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ARRIVAL", "NO_THREAD", "FlowCount", "arrivals_of", "flow_counts"]

ARRIVAL = np.dtype([("at_cycles", "<u8"), ("count", "<u8"), ("thread", "<u4"), ("target", "<u4")])
NO_THREAD = 0xFFFF_FFFF


@dataclass(frozen=True, eq=False)
class FlowCount:
    """Most executions, activations or arrivals of a point, and what a fact excludes: arrivals, each
    with its cycle, number, position of the thread and next instruction; `dropped` are those after
    them, which are not kept."""

    most: int
    dropped: int
    arrivals: NDArray[np.void]

    @property
    def in_threads(self) -> NDArray[np.void]:
        """Arrivals while a thread runs."""
        return np.asarray(self.arrivals[self.arrivals["thread"] != NO_THREAD])


def arrivals_of(packed: bytes) -> NDArray[np.void]:
    """Records of 24 bytes, shape (n,)."""
    return np.frombuffer(packed, ARRIVAL)


def flow_counts(brick: Any) -> tuple[FlowCount, ...]:
    """The counts of a brick so far, in the order of its points."""
    counts = zip(json.loads(brick.flow_counts()), brick.flow_arrivals(), strict=True)
    return tuple(FlowCount(n["most"], n["dropped"], arrivals_of(packed)) for n, packed in counts)
