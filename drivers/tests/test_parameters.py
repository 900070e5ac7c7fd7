# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Parameters: values survive the end of the program and the end of the supply."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import pytest

from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.observe import Brick
from verification.support.bricks.power_cut import (
    ERASED,
    PAGE_BYTES,
    PAGE_COUNT,
    Found,
    check,
    contents,
    cuts,
    found,
    memory_of,
    start,
)

EMPTY = ERASED * PAGE_COUNT


@pytest.fixture(scope="module")
def elf() -> bytes:
    """The program as an image in flash."""
    return image_of("parameters", "flash")


def test_nothing_is_found_in_erased_flash(elf: bytes) -> None:
    """A program must begin with defaults of its own."""
    assert found(start(elf, EMPTY)) == Found(None, None)


def test_foreign_contents_are_not_taken_for_values(elf: bytes) -> None:
    """What another firmware left there is not found, and is not an obstacle."""
    memory = bytes((7 * place + place // 256) % 256 for place in range(PAGE_BYTES * PAGE_COUNT))
    brick = start(elf, memory)
    assert found(brick) == Found(None, None)
    brick.run(200)
    assert brick.integer("failures") == 0


def test_values_are_found_by_the_next_program(elf: bytes) -> None:
    """Both of them, each as saved last."""
    brick = start(elf, EMPTY)
    brick.run(250)
    saved = brick.integer("saved_number")
    assert saved > 15
    again = found(start(elf, memory_of(brick)))
    assert again.often in (saved, saved + 1)
    assert again.seldom == (again.often - 1) // 10 * 10 + 1


def test_pages_age_evenly(elf: bytes) -> None:
    """100 savings use each page three times; that of the value saved seldom is left alone."""
    seen = contents(elf, EMPTY, 100)
    uses = [0] * PAGE_COUNT
    for before, after in itertools.pairwise(seen):
        for page in range(PAGE_COUNT):
            place = slice(PAGE_BYTES * page, PAGE_BYTES * (page + 1))
            uses[page] += before[place] != after[place]
    assert sum(uses) == 100
    assert (min(uses), max(uses)) in ((2, 4), (3, 4))


def test_a_program_in_ram_saves_without_holding_tasks(brick: Callable[..., Brick]) -> None:
    """The same program in RAM saves too; a saving takes the caller 7 ms."""
    device = brick("parameters")
    device.run(200)
    assert device.integer("failures") == 0
    assert 20 <= device.integer("saved_number") <= 29
    assert memory_of(device) != EMPTY


def test_power_cut_leaves_the_old_or_the_new_value(elf: bytes) -> None:
    """In every step of a saving into a fresh page, and of one that overwrites an old page."""
    used = contents(elf, EMPTY, 40)[-1]
    outcomes = set()
    for memory, seed in ((EMPTY, 1), (used, 2)):
        for cut in cuts(elf, memory, 1, seed):
            outcomes.add(check(elf, cut) == cut.after)
    assert outcomes == {False, True}
