# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The record of a conversation, written while it happens, so that a crash loses nothing.

After a first line come entries: direction (one letter), the host's instant in microseconds since
the beginning (u64), the number of bytes (u16), and the bytes as they were on the line. A
connection's begin is an entry of its own.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from types import TracebackType

from ravenbrick.errors import UsageError

__all__ = ["Direction", "Entry", "Spool", "read_spool"]

_FIRST_LINE = b"ravenbrick telemetry record 1\n"
_HEAD = struct.Struct("<cQH")


class Direction(Enum):
    """Which way bytes went, or that a connection began."""

    RECEIVED = b"r"
    SENT = b"s"
    CONNECTED = b"c"


@dataclass(frozen=True)
class Entry:
    """Bytes of the line at an instant (us since the beginning of the record)."""

    direction: Direction
    at_us: int
    data: bytes


class Spool:
    """A record being written; refuses to write over a file that exists."""

    def __init__(self, path: Path) -> None:
        try:
            self._file = path.open("xb")
        except FileExistsError:
            raise UsageError(f"{path} exists already; name another file for the record") from None
        self._file.write(_FIRST_LINE)
        self._file.flush()

    def add(self, entry: Entry) -> None:
        """Write an entry and hand it to the operating system at once."""
        head = _HEAD.pack(entry.direction.value, entry.at_us, len(entry.data))
        self._file.write(head + entry.data)
        self._file.flush()

    def __enter__(self) -> Spool:
        """The record itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file."""
        self._file.close()


def read_spool(path: Path) -> Iterator[Entry]:
    """Entries of a record; one cut off at the end, as by a power failure, is left out.

    Raises `UsageError` when the file is not a record.
    """
    data = path.read_bytes()
    if not data.startswith(_FIRST_LINE):
        raise UsageError(f"{path}: not a telemetry record; 'ravenbrick monitor --record' makes one")
    place = len(_FIRST_LINE)
    while place + _HEAD.size <= len(data):
        letter, at_us, count = _HEAD.unpack_from(data, place)
        place += _HEAD.size
        if place + count > len(data):
            return
        try:
            direction = Direction(letter)
        except ValueError:
            raise UsageError(f"{path}: byte {place - _HEAD.size} does not start an entry") from None
        yield Entry(direction, at_us, data[place : place + count])
        place += count
