# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A scenario's monitor: a computer in range that asks the program for its telemetry.

It speaks at the ends of slices of the run, so the run stays a function of image, inputs and seed.
"""

from __future__ import annotations

from typing import Any

from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.peers import BluetoothComputer
from ravenbrick.target.scenario import MonitorWindow
from ravenbrick.telemetry.session import Session

__all__ = ["Listener"]


class Listener:
    """Connects when its window begins, listens, and hangs up when the window ends."""

    def __init__(self, brick: Any, window: MonitorWindow) -> None:
        self.session = Session()
        self._window = window
        self._brick = brick
        self._computer = BluetoothComputer(brick, pin=window.pin)
        self._paged = self._asked = False

    def look(self, now_ms: int) -> None:
        """Do what is due."""
        begins, ends = self._window.from_ms, self._window.until_ms
        if ends is not None and now_ms >= ends:
            self._computer.hang_up()
        elif not self._paged and now_ms >= begins:
            self._paged = True
            self._computer.page()
        else:
            self._exchange()

    def _exchange(self) -> None:
        received = self._computer.take()
        if not self._computer.connected:
            return
        now_s = float(MASTER_CLOCK.seconds(self._brick.cycles))
        self.session.receive(received)
        words = self.session.pending(now_s) if self._asked else self.session.connected(now_s)
        self._asked = True
        if words:
            self._computer.write(words)
