# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A scenario's monitor: a computer in range that asks the program for its telemetry.

It speaks at the ends of slices of the run, so the run stays a function of image, inputs and seed.
"""

from __future__ import annotations

from typing import Any

from ravenbrick.brick.links.peers import BluetoothComputer
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import PeerError
from ravenbrick.project.scenario import MonitorWindow
from ravenbrick.telemetry.session import Session

__all__ = ["ScriptedMonitor"]


RETRY_MS = 1_000


class ScriptedMonitor:
    """Connects when its window begins, listens, and hangs up when the window ends.

    Until the program answers, it asks once a second for the connection.
    """

    def __init__(self, brick: Any, window: MonitorWindow) -> None:
        self.session = Session()
        self._window = window
        self._brick = brick
        self._computer = BluetoothComputer(brick, pin=window.pin)
        self._page_ms = window.from_ms
        self._asked = self._was_connected = False
        self._chatter = list(window.chatter)

    def poll(self, now_ms: int) -> None:
        """Do what is due."""
        ends = self._window.until_ms
        if ends is not None and now_ms >= ends:
            self._computer.hang_up()
        elif now_ms >= self._window.from_ms:
            self._listen(now_ms)

    def check(self) -> None:
        """Raise `PeerError` when there never was a connection."""
        if not self._was_connected:
            raise PeerError(
                f"the scenario's monitor got no connection from {self._window.from_ms} ms on; let "
                "the program have an NXT.Telemetry.Bluetooth_Server with the PIN of [monitor], and "
                "give it a second to start"
            )

    def _listen(self, now_ms: int) -> None:
        received = self._computer.take()
        if not self._computer.connected:
            self._asked = False
            if now_ms >= self._page_ms:
                self._computer.page()
                self._page_ms = now_ms + RETRY_MS
            return
        self._was_connected = True
        now_s = float(MASTER_CLOCK.seconds(self._brick.cycles))
        self.session.receive(received)
        words = self.session.pending(now_s) if self._asked else self.session.connected(now_s)
        self._asked = True
        while self._chatter and self._chatter[0][0] <= now_ms:
            words += self._chatter.pop(0)[1]
        if words:
            self._computer.write(words)
