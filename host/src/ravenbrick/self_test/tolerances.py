# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How far a row of a real brick may be from the virtual brick's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase

__all__ = ["TOLERANCES", "Tolerance", "tolerance_of"]


@dataclass(frozen=True)
class Tolerance:
    """Half width in the row's unit or, with `relative`, as a share of the virtual value."""

    half_width: float
    reason: str
    relative: bool = False

    def allows(self, measured: float, virtual: float) -> bool:
        """The difference is small enough."""
        return abs(measured - virtual) <= self.of(virtual)

    def of(self, virtual: float) -> float:
        """The half width in the row's unit."""
        return self.half_width * abs(virtual) if self.relative else self.half_width


TOLERANCES: Mapping[str, Tolerance] = {
    "ram.*": Tolerance(0.5, "cycle counts are exact"),
    "peripheral.*": Tolerance(0.5, "cycle counts are exact"),
    "flash.page": Tolerance(0.2, "the datasheet gives 6 ms at most", relative=True),
    "flash.*": Tolerance(0.5, "cycle counts are exact"),
    "interrupt.*_request": Tolerance(0.0, "a number of instructions"),
    "interrupt.*": Tolerance(0.5, "cycle counts are exact"),
    "dma.*": Tolerance(6.0, "the stopwatch counts two cycles"),
    "display.100_bytes": Tolerance(40.0, "the length of the polling loop"),
    "converter.conversion": Tolerance(60.0, "the length of the polling loop, the sampling clock"),
    "link.pause_shortest": Tolerance(20.0, "the co-processor's main loop"),
    "link.receive": Tolerance(1.0, "the polling loop; the co-processor's clock"),
    "link.send": Tolerance(1.0, "the polling loop; the co-processor's clock"),
    "link.*": Tolerance(0.0, "no transfer may fail"),
    "port.*": Tolerance(15.0, "pull-up of 10 kilohms, converter of 10 bits"),
    "motor.*": Tolerance(0.2, "motors differ from each other", relative=True),
    "touch.pressed": Tolerance(40.0, "resistor in the sensor"),
    "sound.half_second": Tolerance(5_000.0, "whole buffers are played"),
    "clock.slow": Tolerance(10_000.0, "the datasheet gives 22 to 42 kHz"),
    "clock.usb_second": Tolerance(2_000.0, "two crystals, and USB's 500 parts per million"),
}
"""By pattern of the row's name, the first that fits; a row without one is shown only."""


def tolerance_of(row: str) -> Tolerance | None:
    """The tolerance of a row, if it is compared."""
    return next((t for pattern, t in TOLERANCES.items() if fnmatchcase(row, pattern)), None)
