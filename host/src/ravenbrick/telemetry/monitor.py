# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Connect, talk, record, and connect again: the loop behind `ravenbrick monitor`."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from ravenbrick.telemetry.links import Link, LinkLostError
from ravenbrick.telemetry.session import Session
from ravenbrick.telemetry.spool import Direction, Entry, Spool, read_spool

__all__ = ["Monitor", "replay"]

_POLL_S = 0.05
_RECONNECT_S = 0.5
_US = 1_000_000


@dataclass
class Monitor:
    """One conversation over as many connections as it takes.

    `connect` opens a link or raises `LinkLostError`; `tell` hears what happens to the link.
    """

    session: Session
    connect: Callable[[], Link]
    spool: Spool | None = None
    tell: Callable[[str], None] = lambda _text: None
    clock: Callable[[], float] = time.monotonic
    pause: Callable[[float], None] = time.sleep
    connections: int = 0
    losses: int = 0
    _link: Link | None = None
    _begin_s: float = field(init=False)
    _complained: bool = False

    def __post_init__(self) -> None:
        """The record's time begins now."""
        self._begin_s = self.clock()

    @property
    def now_s(self) -> float:
        """Seconds since the beginning."""
        return self.clock() - self._begin_s

    def poll(self) -> None:
        """Do what is due, waiting at most 0.05 s for bytes or 0.5 s for a connection."""
        if self._link is None:
            self._try_to_connect()
            return
        try:
            # What came before a link broke is there to be read; nothing can be written any more.
            if data := self._link.read(_POLL_S):
                self._record(Direction.RECEIVED, data)
                self.session.receive(data)
            self._write(self.session.pending(self.now_s))
        except LinkLostError as error:
            self._lose(error)

    def end(self) -> None:
        """Tell the brick and close the link."""
        if self._link is None:
            return
        try:
            self._write(self.session.close(self.now_s))
        except LinkLostError as error:
            self.tell(f"the brick could not be told of the end: {error}")
        self._link.close()
        self._link = None

    def _try_to_connect(self) -> None:
        try:
            self._link = self.connect()
            self.connections += 1
            self._complained = False
            self._record(Direction.CONNECTED, b"")
            self.tell("connected" if self.connections == 1 else "connected again")
            self._write(self.session.connected(self.now_s))
        except LinkLostError as error:
            if self._link is not None:
                self._lose(error)
            elif not self._complained:
                self._complained = True
                self.tell(f"{error}; trying again until it works")
            self.pause(_RECONNECT_S)

    def _lose(self, error: LinkLostError) -> None:
        self.losses += 1
        if self._link is not None:
            self._link.close()
        self._link = None
        self.tell(f"link lost: {error}")

    def _write(self, data: bytes) -> None:
        if data and self._link is not None:
            self._link.write(data)
            self._record(Direction.SENT, data)

    def _record(self, direction: Direction, data: bytes) -> None:
        if self.spool is not None:
            self.spool.add(Entry(direction, round(self.now_s * _US), data))


def replay(path: Path) -> Session:
    """The session of a record, as it was at its end."""
    session = Session()
    for entry in read_spool(path):
        if entry.direction is Direction.CONNECTED:
            session.connected(entry.at_us / _US)
        elif entry.direction is Direction.RECEIVED:
            session.receive(entry.data)
    return session
