# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames between a firmware and the co-processor, as they passed on the two-wire bus."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ravenbrick.brick.firmware import FirmwareBrick

__all__ = ["LinkCount", "commands", "count_frames"]

WRITE, READ = "02", "03"
COMMAND_BYTES, STRING_BYTES, STRING_MARK = 9, 46, 0xCC


@dataclass(frozen=True)
class LinkCount:
    """Complete write transfers: all, those that the co-processor takes, and greeting strings."""

    writes: int
    good: int
    greetings: int
    reads: int

    @property
    def bad(self) -> int:
        """Write transfers that are neither a good command nor a greeting."""
        return self.writes - self.good - self.greetings

    def __str__(self) -> str:
        return f"{self.good} of {self.good + self.bad} write frames good, {self.reads} reads"


def transfers(log: Iterable[tuple[int, str]]) -> Iterator[tuple[str, bytes]]:
    """Address byte and data of each transfer from START to STOP in a bus log."""
    address, data = "", bytearray()
    for _, entry in log:
        words = entry.split()
        if words[0] != "twi":
            continue
        if words[1] == "S":
            address, data = words[2][:2], bytearray()
        elif words[1] == "P":
            if address:
                yield address, bytes(data)
            address = ""
        else:
            data.append(int(words[1][:2], 16))


def is_command(data: bytes) -> bool:
    """Nine bytes whose sum is 0xFF, as the co-processor's published source asks for."""
    return len(data) == COMMAND_BYTES and sum(data) & 0xFF == 0xFF


def commands(log: Iterable[tuple[int, str]]) -> list[bytes]:
    """The good command frames in a bus log."""
    return [data for address, data in transfers(log) if address == WRITE and is_command(data)]


def count_frames(brick: FirmwareBrick, seconds: float) -> LinkCount:
    """Let time pass and count; the log begins now."""
    brick.device.record_buses()
    brick.device.bus_log()
    brick.run(seconds)
    done = list(transfers(brick.device.bus_log()))
    writes = [data for address, data in done if address == WRITE]
    greetings = sum(len(d) >= STRING_BYTES and d[0] == STRING_MARK for d in writes)
    reads = sum(address == READ for address, _ in done)
    return LinkCount(len(writes), sum(map(is_command, writes)), greetings, reads)
