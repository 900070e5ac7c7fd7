# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One measured figure, and what several parts of the benchmarks need."""

from __future__ import annotations

from dataclasses import dataclass, field

from verification.support.paths import ROOT

__all__ = ["REPEATS", "VEHICLE", "Figure"]

VEHICLE = ROOT / "examples" / "vehicle"
REPEATS = 5


@dataclass(frozen=True)
class Figure:
    """A value beside that of a peer; the ratio is ours divided by the peer's."""

    figure: str
    value: float
    unit: str
    peer: str | None = None
    peer_value: float | None = None
    ratio: float | None = field(init=False)

    def __post_init__(self) -> None:
        ratio = None if self.peer_value is None else self.value / self.peer_value
        object.__setattr__(self, "ratio", ratio)
