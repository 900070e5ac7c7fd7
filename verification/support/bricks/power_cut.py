# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Power cuts while NXT.Parameters saves: what flash may hold then, and what the next start finds.

A brick is watched while it saves. Between two contents of the flash memory that follow each other
lies the programming of one page, which begins with its erasure: a cut leaves any mixture of the old
content and erased cells, or of erased cells and the new content. Each such memory becomes part of
an image in flash, with which the brick starts again.
"""

from __future__ import annotations

import json
import random
import struct
from collections.abc import Iterator
from dataclasses import dataclass

import virtual_brick

from verification.support.bricks.observe import Brick, bench

FLASH_START, PAGE_BYTES = 0x0010_0000, 256
FIRST_PAGE, PAGE_COUNT = 992, 32
REGION = FLASH_START + PAGE_BYTES * FIRST_PAGE
REGION_BYTES = PAGE_BYTES * PAGE_COUNT
ERASED = b"\xff" * PAGE_BYTES
LOADED_MS, SAVING_MS = 60.0, 25.0
LOOK_MS = 0.5
PT_LOAD, PF_R = 1, 4


@dataclass(frozen=True)
class Found:
    """What a program finds when it starts."""

    often: int | None
    seldom: int | None


@dataclass(frozen=True)
class Cut:
    """The flash memory after a cut, and what the program before and after the saving finds."""

    step: str
    memory: bytes
    before: Found
    after: Found


def with_memory(elf: bytes, memory: bytes) -> bytes:
    """A flash image with the stored values as one more segment."""
    header = bytearray(elf[:52])
    (place,) = struct.unpack_from("<I", header, 28)
    size, count = struct.unpack_from("<HH", header, 42)
    table = elf[place : place + size * count]
    padding = b"\0" * (-len(elf) % 4)
    data_at = len(elf) + len(padding)
    table_at = data_at + len(memory)
    lengths = (len(memory), len(memory))
    segment = struct.pack("<8I", PT_LOAD, data_at, REGION, REGION, *lengths, PF_R, 4)
    struct.pack_into("<I", header, 28, table_at)
    struct.pack_into("<H", header, 44, count + 1)
    return bytes(header) + elf[52:] + padding + memory + table + segment


def start(elf: bytes, memory: bytes) -> Brick:
    """A brick at power-on with a program and stored values."""
    return Brick(virtual_brick.VirtualBrick(json.dumps(bench()), with_memory(elf, memory)))


def memory_of(brick: Brick) -> bytes:
    """The pages of stored values."""
    return bytes(brick.device.read_memory(REGION, REGION_BYTES))


def found(brick: Brick) -> Found:
    """What the program has loaded; it must be whole."""
    brick.run(LOADED_MS)
    assert brick.integer("loaded") == 1
    assert brick.integer("mixed") == 0, "parts of a value do not belong together"
    often = brick.integer("often_number") if brick.integer("often_found") else None
    seldom = brick.integer("seldom_number") if brick.integer("seldom_found") else None
    return Found(often, seldom)


def contents(elf: bytes, memory: bytes, number: int) -> list[bytes]:
    """The contents that flash has one after the other, the first as it is at the start."""
    brick = start(elf, memory)
    seen = [memory]
    at_ms = 0.0
    while len(seen) <= number:
        at_ms += LOOK_MS
        brick.run(at_ms)
        now = memory_of(brick)
        if now != seen[-1]:
            seen.append(now)
        assert at_ms < LOADED_MS + SAVING_MS * (number + 2), "the program saves no more"
    return seen


def changed_page(before: bytes, after: bytes) -> int:
    """The one page in which two contents differ."""
    pages = [
        page
        for page in range(0, REGION_BYTES, PAGE_BYTES)
        if before[page : page + PAGE_BYTES] != after[page : page + PAGE_BYTES]
    ]
    assert len(pages) == 1, "one saving changes one page"
    return pages[0]


def _mixture(one: bytes, other: bytes, share: float, chance: random.Random) -> bytes:
    """Bits of `one`, about `share` of them replaced by those of `other`."""
    mask = bytes(sum((chance.random() < share) << bit for bit in range(8)) for _ in range(len(one)))
    return bytes((a & ~m) | (b & m) for a, b, m in zip(one, other, mask, strict=True))


def torn_pages(old: bytes, new: bytes, chance: random.Random) -> Iterator[tuple[str, bytes]]:
    """What a page may hold when the supply fails while it is programmed."""
    yield "nothing done", old
    for share in (0.02, 0.5, 0.98):
        yield f"{share:.0%} erased", _mixture(old, ERASED, share, chance)
    yield "erased", ERASED
    for share in (0.02, 0.5, 0.98):
        yield f"{share:.0%} programmed", _mixture(ERASED, new, share, chance)
    yield "header programmed", new[:16] + ERASED[16:]
    yield "all but one bit programmed", _all_but_one_bit(new)
    yield "programmed", new


def _all_but_one_bit(new: bytes) -> bytes:
    place = next(place for place in range(len(new) - 1, -1, -1) if new[place] != 0xFF)
    bit = ~new[place] & (new[place] + 1)
    return new[:place] + bytes([new[place] | bit]) + new[place + 1 :]


def cuts(elf: bytes, memory: bytes, number: int, seed: int) -> Iterator[Cut]:
    """The memories that a cut in one of the next savings may leave."""
    chance = random.Random(seed)
    seen = contents(elf, memory, number)
    states = [found(start(elf, content)) for content in seen]
    for saving in range(number):
        before, after = seen[saving], seen[saving + 1]
        page = changed_page(before, after)
        old, new = (content[page : page + PAGE_BYTES] for content in (before, after))
        for step, torn in torn_pages(old, new, chance):
            content = before[:page] + torn + before[page + PAGE_BYTES :]
            name = f"saving {saving}, page {FIRST_PAGE + page // PAGE_BYTES}: {step}"
            yield Cut(name, content, states[saving], states[saving + 1])


def check(elf: bytes, cut: Cut) -> Found:
    """Start after a cut: each value is the old or the new one, and the next saving succeeds."""
    brick = start(elf, cut.memory)
    now = found(brick)
    assert now in (cut.before, cut.after), f"{cut.step}: {now}, not {cut.before} or {cut.after}"
    if cut.step.endswith("nothing done") or cut.step.endswith(" erased"):
        assert now == cut.before, cut.step
    if cut.step.endswith(": programmed"):
        assert now == cut.after, cut.step
    brick.run(LOADED_MS + 2 * SAVING_MS)
    assert brick.integer("failures") == 0, cut.step
    assert brick.integer("saved_number") > (now.often or 0), cut.step
    return now
