# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames on a byte stream that may lose, repeat or invent bytes.

A frame is its content and a check value (CRC-16, polynomial 0x1021, start 0xFFFF, not reflected),
coded so that no byte is zero (consistent overhead byte stuffing, Cheshire and Baker, IEEE/ACM
Transactions on Networking 7(2), 1999), and a zero at its end. After damage the next zero is the
beginning of a frame again.
"""

from __future__ import annotations

from binascii import crc_hqx
from collections.abc import Iterator

__all__ = [
    "CHECK_BYTES",
    "FRAME_END",
    "LONGEST_CONTENT",
    "FrameReader",
    "frame",
    "stuff",
    "unstuff",
]

LONGEST_CONTENT = 120
"""Bytes of a content; a code block of the stuffing never needs to be split below 254."""

FRAME_END = b"\0"

CHECK_BYTES = 2
_CHECK_START = 0xFFFF
_LONGEST_CODED = LONGEST_CONTENT + CHECK_BYTES + 1
_LONGEST_BLOCK = 0xFF


def stuff(data: bytes) -> bytes:
    """The data without zeros: each block begins with the distance to the next zero."""
    coded = bytearray()
    for block in data.split(b"\0"):
        while len(block) >= _LONGEST_BLOCK - 1:
            coded += bytes([_LONGEST_BLOCK]) + block[: _LONGEST_BLOCK - 1]
            block = block[_LONGEST_BLOCK - 1 :]
        coded += bytes([len(block) + 1]) + block
    return bytes(coded)


def unstuff(coded: bytes) -> bytes | None:
    """The data that `stuff` coded, or None when the lengths do not fit."""
    data = bytearray()
    place = 0
    while place < len(coded):
        length = coded[place]
        block = coded[place + 1 : place + length]
        if length == 0 or len(block) != length - 1:
            return None
        data += block
        place += length
        if length < _LONGEST_BLOCK and place < len(coded):
            data.append(0)
    return bytes(data)


def frame(content: bytes) -> bytes:
    """The bytes that carry a content of 1 to `LONGEST_CONTENT` bytes."""
    if not 1 <= len(content) <= LONGEST_CONTENT:
        raise ValueError(f"a frame holds 1 to {LONGEST_CONTENT} bytes, not {len(content)}")
    check = crc_hqx(content, _CHECK_START).to_bytes(CHECK_BYTES, "little")
    return stuff(content + check) + FRAME_END


class FrameReader:
    """Finds frames in what arrives; `damaged` counts what was none. Memory is bounded."""

    def __init__(self) -> None:
        self.damaged = 0
        self._pending = bytearray()
        self._overrun = False

    def restart(self) -> None:
        """Forget the beginning of a frame, as after a new connection."""
        self._pending.clear()
        self._overrun = False

    def feed(self, data: bytes) -> Iterator[bytes]:
        """The contents of the frames that are complete now."""
        for byte in data:
            if byte != 0:
                self._keep(byte)
                continue
            content = self._content()
            if content is not None:
                yield content

    def _keep(self, byte: int) -> None:
        if len(self._pending) < _LONGEST_CODED:
            self._pending.append(byte)
        else:
            self._overrun = True

    def _content(self) -> bytes | None:
        """The bytes between two zeros; an empty frame is not damage."""
        coded, overrun = bytes(self._pending), self._overrun
        self.restart()
        if not coded:
            return None
        data = None if overrun else unstuff(coded)
        if data is None or len(data) <= CHECK_BYTES:
            self.damaged += 1
            return None
        content, check = data[:-CHECK_BYTES], data[-CHECK_BYTES:]
        if crc_hqx(content, _CHECK_START) != int.from_bytes(check, "little"):
            self.damaged += 1
            return None
        return content
