# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Another Bluetooth device near the brick, as a test moves it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from drivers.tests.observe import Brick

HEARD_MS = 5.0


@dataclass
class Peer:
    """A device at `address` that runs a brick in small steps and keeps what it hears from it."""

    brick: Brick
    address: str = "00:11:22:33:44:55"
    name: str = "laptop"
    now_ms: float = 0.0
    stream: bytearray = field(default_factory=bytearray)
    heard: list[str] = field(default_factory=list)

    def run(self, ms: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Let time pass, or until a condition holds; whether it does."""
        end = self.now_ms + ms
        while self.now_ms < end and not until():
            self.now_ms += HEARD_MS
            self.brick.run(self.now_ms)
            for _, receiver, kind, data, _, _ in self.brick.device.bluetooth_sent():
                assert receiver == self.address
                self.heard.append(kind)
                self.stream += data
        return until()

    def signal(self, kind: str, data: bytes = b"", pin: str | None = None) -> None:
        """Something through the air, now."""
        at = max(self.brick.cycles(self.now_ms), self.brick.device.cycles)
        name = self.name if kind in ("page", "in_range") else ""
        self.brick.device.bluetooth_send(at, self.address, kind, data, name=name, pin=pin)

    def connect(self, pin: str = "1234") -> bool:
        """Page the brick; whether it accepts within a second."""
        self.heard.clear()
        self.signal("page", pin=pin)
        self.run(1000, lambda: bool({"accept", "refuse"} & set(self.heard)))
        return "accept" in self.heard

    def send(self, data: bytes) -> None:
        """Bytes of the stream, now."""
        self.signal("data", data)

    def take(self) -> bytes:
        """What came over the stream since the last call."""
        data = bytes(self.stream)
        self.stream.clear()
        return data
