# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs of a brick from instant to instant, for bricks that are not the module's own.

The module `virtual_brick` does the same without a way through Python at each instant.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

__all__ = ["run_until_picture"]


def run_until_picture(brick: Any, instants: Sequence[int], first: int, end: int) -> tuple[Any, int]:
    """Run to each of the instants `first` to `end` - 1 (cycles), until the display changes or the
    brick stops; returns the stop and the index of the instant that was run to last."""
    version, index = brick.lcd_version, first
    while True:
        stop = brick.run_until(instants[index])
        if stop.reason != "reached" or brick.lcd_version != version or index + 1 >= end:
            return stop, index
        index += 1
