# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A virtual brick in real time whose Bluetooth or USB other programs reach; what they do is kept.

A live run depends on when bytes come. Its record holds them with their instants, and playing it
gives the same run, cycle by cycle.
"""

from __future__ import annotations

import base64
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.brick.links.byte_ports import BytePort
from ravenbrick.brick.links.peers import BluetoothComputer, StreamPeer, UsbStream
from ravenbrick.brick.links.usbip import UsbIpServer
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import PeerError, UsageError

__all__ = ["LiveRecord", "LiveRun", "replay_live"]

_FORMAT = "ravenbrick live run 1"
_SLICE_MS = 5
_WAITING_MOST = 4096
_ATTEMPT_PERIOD_S = 1.0
_LISTENING_MS = 500


@dataclass(frozen=True)
class AirSignal:
    """Something that reached the brick through the air at a cycle."""

    at_cycles: int
    peer: str
    kind: str
    data: bytes = b""
    name: str = ""
    pin: str | None = None

    def as_json(self) -> dict[str, Any]:
        """With plain types."""
        return {**vars(self), "data": base64.b64encode(self.data).decode("ascii")}


@dataclass(frozen=True)
class CableSignal:
    """A transfer of the USB host that began at a cycle, or, of kind `plugged`, the cable itself.

    `number` is that of the transfer, or 1 and 0 for in and out.
    """

    at_cycles: int
    kind: str
    number: int
    timeout_cycles: int = 0
    endpoint: int = 0
    data: bytes = b""
    length: int = 0

    def as_json(self) -> dict[str, Any]:
        """With plain types."""
        return {**vars(self), "data": base64.b64encode(self.data).decode("ascii")}


def _with_bytes(item: dict[str, Any]) -> dict[str, Any]:
    return {**item, "data": base64.b64decode(item["data"], validate=True)}


@dataclass
class LiveRecord:
    """All that a live run depended on, its end and its digest."""

    scenario: str
    signals: list[AirSignal] = field(default_factory=list)
    cable: list[CableSignal] = field(default_factory=list)
    end_cycles: int = 0
    digest: str = ""

    def save(self, path: Path) -> None:
        """Write the record as JSON."""
        content = {
            **vars(self),
            "signals": [signal.as_json() for signal in self.signals],
            "cable": [signal.as_json() for signal in self.cable],
        }
        atomic_write(path, json.dumps({"format": _FORMAT, **content}, indent=1) + "\n")

    @classmethod
    def load(cls, path: Path) -> LiveRecord:
        """Read what `save` wrote; raises `UsageError`."""
        if not path.is_file():
            raise UsageError(
                f"{path}: there is no such record; 'ravenbrick live --record' writes one"
            )
        try:
            content = json.loads(path.read_text("utf-8"))
            if content.pop("format") != _FORMAT:
                raise ValueError("another format")
            signals = [AirSignal(**_with_bytes(item)) for item in content.pop("signals")]
            cable = [CableSignal(**_with_bytes(item)) for item in content.pop("cable", [])]
            return cls(signals=signals, cable=cable, **content)
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise UsageError(
                f"{path}: not the record of a live run, or damaged; "
                "'ravenbrick live --record' writes one"
            ) from None


class _RecordedBrick:
    """The brick as a peer sees it, with a note of all that the peer sends."""

    def __init__(self, brick: Any, record: LiveRecord) -> None:
        self._brick, self._record = brick, record

    def __getattr__(self, name: str) -> Any:
        return getattr(self._brick, name)

    def bluetooth_send(
        self,
        at_cycles: int,
        peer: str,
        kind: str,
        data: bytes = b"",
        name: str = "",
        pin: str | None = None,
    ) -> None:
        """Pass the signal on and keep it."""
        self._brick.bluetooth_send(at_cycles, peer, kind, data, name=name, pin=pin)
        self._record.signals.append(AirSignal(at_cycles, peer, kind, bytes(data), name, pin))

    def schedule_input(self, at_cycles: int, name: str, value: float) -> None:
        """Pass on that the cable is put in or pulled out, and keep it."""
        self._brick.schedule_input(at_cycles, name, value)
        self._record.cable.append(CableSignal(at_cycles, "plugged", int(value)))

    def usb_transfer(
        self,
        at_cycles: int,
        number: int,
        timeout_cycles: int,
        kind: str,
        endpoint: int = 0,
        data: bytes = b"",
        length: int = 0,
    ) -> None:
        """Pass the transfer on and keep it."""
        self._brick.usb_transfer(at_cycles, number, timeout_cycles, kind, endpoint, data, length)
        kept = CableSignal(at_cycles, kind, number, timeout_cycles, endpoint, bytes(data), length)
        self._record.cable.append(kept)


@dataclass
class LiveRun:
    """One brick, one port; `speed` is virtual seconds per second, 0 for as fast as possible.

    `pin` is that of the program's Bluetooth; without one the port is the brick's USB. `usb_ip`
    offers the USB device to tools that drive it themselves.
    """

    brick: Any
    port: BytePort
    record: LiveRecord
    pin: str | None
    speed: float = 1.0
    usb_ip: UsbIpServer | None = None
    tell: Callable[[str], None] = lambda _text: None
    clock: Callable[[], float] = time.monotonic
    pause: Callable[[float], None] = time.sleep
    _recorded: _RecordedBrick = field(init=False)
    _computer: StreamPeer = field(init=False)
    _next_attempt_s: float = 1.0

    def __post_init__(self) -> None:
        """The computer comes into range, or sits at the other end of the cable."""
        self._recorded = brick = _RecordedBrick(self.brick, self.record)
        in_air = self.pin is not None
        self._computer = BluetoothComputer(brick, pin=self.pin) if in_air else UsbStream(brick)

    @property
    def _now_s(self) -> float:
        return MASTER_CLOCK.seconds(self.brick.cycles)

    def run(self, seconds: float | None, stop: Callable[[], bool] = lambda: False) -> Any:
        """For so many virtual seconds, or until stopped; why the brick stopped."""
        begin = self.clock()
        slice_cycles = MASTER_CLOCK.cycles_of_ms(_SLICE_MS)
        while True:
            stopped = self.brick.run_until(self.brick.cycles + slice_cycles)
            if stopped.reason != "reached" or stop():
                break
            if seconds is not None and self._now_s >= seconds:
                break
            self._exchange()
            ahead = self._now_s / self.speed - (self.clock() - begin) if self.speed else 0.0
            if ahead > 0:
                self.pause(ahead)
        self.record.end_cycles = self.brick.cycles
        self.record.digest = self.brick.trace_digest()
        return stopped

    def _exchange(self) -> None:
        if self.usb_ip is not None:
            self.usb_ip.exchange(self._recorded)
        # A client that sends faster than the air carries waits at its own end.
        full = self.brick.bluetooth_waiting > _WAITING_MOST
        from_client = b"" if full else self.port.read()
        if self._computer.connected and not self.port.in_use:
            self._computer.close()
            self.tell("the client has gone")
        elif self.port.in_use and not self._computer.connected:
            self._connect()
        if self._computer.connected:
            if from_client:
                self._computer.write(from_client)
            self.port.write(self._computer.take())

    def _connect(self) -> None:
        """Connect; a program that does not listen yet is asked again after a second."""
        if self._now_s < self._next_attempt_s:
            return
        self._next_attempt_s = self._now_s + _ATTEMPT_PERIOD_S
        try:
            self._computer.connect(timeout_ms=_LISTENING_MS)
            self.tell(f"connected at {self._now_s:.2f} s")
        except PeerError as error:
            self.tell(f"{error}; trying again")


def replay_live(brick: Any, record: LiveRecord) -> bool:
    """Play a record on a fresh brick with the same image; whether the run was the same."""
    happened: list[AirSignal | CableSignal] = [*record.signals, *record.cable]
    for one in sorted(happened, key=lambda one: one.at_cycles):
        brick.run_until(one.at_cycles)
        _play(brick, one)
    brick.run_until(record.end_cycles)
    return bool(brick.trace_digest() == record.digest)


def _play(brick: Any, one: AirSignal | CableSignal) -> None:
    at_cycles = one.at_cycles
    if isinstance(one, AirSignal):
        brick.bluetooth_send(at_cycles, one.peer, one.kind, one.data, name=one.name, pin=one.pin)
    elif one.kind == "plugged":
        brick.schedule_input(at_cycles, "usb.plugged", one.number)
    else:
        timing = (at_cycles, one.number, one.timeout_cycles)
        brick.usb_transfer(*timing, one.kind, one.endpoint, one.data, one.length)
