# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames: what was put in comes out, and damage is seen, whatever arrives."""

from __future__ import annotations

import random

import pytest

from ravenbrick.telemetry.frames import LONGEST_CONTENT, FrameReader, frame, stuff, unstuff


def test_published_stuffing_examples() -> None:
    """Coded forms worked out by hand from the definition of the stuffing."""
    assert stuff(b"\x00") == b"\x01\x01"
    assert stuff(b"\x00\x00") == b"\x01\x01\x01"
    assert stuff(b"\x11\x22\x00\x33") == b"\x03\x11\x22\x02\x33"
    assert stuff(b"\x11\x22\x33\x44") == b"\x05\x11\x22\x33\x44"
    assert stuff(bytes(range(1, 255))) == b"\xff" + bytes(range(1, 255)) + b"\x01"


def test_check_value_of_the_catalogue() -> None:
    """CRC-16 with 0x1021 from 0xFFFF of the digits 1 to 9 is 0x29B1, as catalogues list it."""
    assert unstuff(frame(b"123456789")[:-1]) == b"123456789" + (0x29B1).to_bytes(2, "little")


@pytest.mark.parametrize("seed", range(20))
def test_contents_survive_any_chunks(seed: int) -> None:
    """Random contents, cut into random chunks, come out whole, in order, and nothing else."""
    rng = random.Random(seed)
    contents = [rng.randbytes(rng.randint(1, LONGEST_CONTENT)) for _ in range(50)]
    line = b"".join(map(frame, contents))
    reader = FrameReader()
    found: list[bytes] = []
    while line:
        size = rng.randint(1, 40)
        found += reader.feed(line[:size])
        line = line[size:]
    assert found == contents
    assert reader.damaged == 0


@pytest.mark.parametrize("seed", range(20))
def test_damage_is_noticed_and_passes(seed: int) -> None:
    """A changed byte costs that frame and at most its neighbour, and never yields a false one."""
    rng = random.Random(seed)
    contents = [rng.randbytes(rng.randint(4, 60)) for _ in range(30)]
    line = bytearray(b"".join(map(frame, contents)))
    place = rng.randrange(len(line))
    line[place] ^= rng.randint(1, 255)
    reader = FrameReader()
    found = list(reader.feed(bytes(line)))
    assert set(found) <= set(contents)
    assert len(found) >= len(contents) - 2
    assert reader.damaged >= 1


def test_garbage_needs_no_memory() -> None:
    """A megabyte without an end is one damaged frame, and the next frame is found."""
    reader = FrameReader()
    assert list(reader.feed(b"\x55" * 1_000_000)) == []
    assert len(reader._pending) < 2 * LONGEST_CONTENT
    assert list(reader.feed(b"\x00" + frame(b"well"))) == [b"well"]
    assert reader.damaged == 1


def test_wrong_sizes_are_refused() -> None:
    """Nothing and too much cannot be framed."""
    for content in (b"", bytes(LONGEST_CONTENT + 1)):
        with pytest.raises(ValueError, match="1 to 120"):
            frame(content)
