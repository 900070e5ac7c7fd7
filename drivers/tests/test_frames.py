# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Frames: the host's own reader understands the brick's frames."""

from __future__ import annotations

from collections.abc import Callable

from ravenbrick.telemetry.frames import FrameReader

from verification.support.bricks.observe import Brick

LENGTHS = [1, 5, 30, 90, 120]


def expected() -> list[bytes]:
    """The contents, from the generator as the test program describes it."""
    state, contents = 1, []
    for length in LENGTHS:
        content = bytearray()
        for _ in range(length):
            state = (state * 1_664_525 + 1_013_904_223) % 2**32
            content.append(0 if state >> 24 < 64 else state >> 24)
        contents.append(bytes(content))
    return contents


def test_frames_of_the_brick_are_understood(brick: Callable[..., Brick]) -> None:
    """Encoded on the brick, decoded on the host, and again on the brick; damage is counted."""
    device = brick("frames")
    device.run(100)
    line = device.bytes("line")[: device.integers("line_length")[0]]
    reader = FrameReader()
    assert list(reader.feed(line)) == expected()
    assert reader.damaged == 0
    assert device.integers("damaged_frames") == [len(LENGTHS)]
    # Five right ones and, after noise without an end swallowed one, none more.
    assert device.integers("whole_frames") == device.integers("equal_frames") == [5]
