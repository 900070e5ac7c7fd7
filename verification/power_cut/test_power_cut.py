# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Power cuts at every step of 36 savings in a row: old or new value, never neither."""

from __future__ import annotations

import pytest

from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.power_cut import ERASED, PAGE_COUNT, Cut, check, contents, cuts

SAVINGS = 36
STEPS = 11

pytestmark = pytest.mark.long("396 power cuts")


@pytest.fixture(scope="module")
def elf() -> bytes:
    """The program of the drivers' test as an image in flash."""
    return image_of("parameters", "flash")


@pytest.fixture(scope="module")
def campaign(elf: bytes) -> list[Cut]:
    """Cuts in savings that go once around the ring of pages."""
    used = contents(elf, ERASED * PAGE_COUNT, 20)[-1]
    return list(cuts(elf, used, SAVINGS, seed=3))


@pytest.mark.parametrize("number", range(SAVINGS * STEPS))
def test_power_cut_leaves_the_old_or_the_new_value(
    elf: bytes, campaign: list[Cut], number: int
) -> None:
    """The next start finds one of the two, whole, and saves on."""
    check(elf, campaign[number])
