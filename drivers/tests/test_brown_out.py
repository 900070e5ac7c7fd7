# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The battery fails while NXT.Parameters saves: the old or the new value, never neither."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.observe import Brick
from verification.support.bricks.power_cut import ERASED, PAGE_COUNT, memory_of, start

POWER_ON, BROWN_OUT = 0, 4
SAVING_FROM_MS, START_MS = 400.0, 400.0
PERIOD_MS = 7.2
MOMENTS = 12


@pytest.fixture(scope="module")
def elf() -> bytes:
    """The program as an image in flash."""
    return image_of("brown_out", "flash")


@pytest.fixture(scope="module")
def saving(elf: bytes) -> Brick:
    """A brick with the program that has been saving for a while."""
    device = start(elf, ERASED * PAGE_COUNT)
    device.run(SAVING_FROM_MS)
    assert device.integer("cause") == POWER_ON
    assert device.integer("saved_number") > 5
    return device


@pytest.fixture(scope="module")
def falling(saving: Brick) -> Callable[[float, float], int]:
    """Goes back to the saving brick, lets its voltage fall at a moment; what was saved last."""
    snapshot = saving.device.snapshot()

    def fall(moment_ms: float, volts: float) -> int:
        saving.device.restore(snapshot)
        saving.run(SAVING_FROM_MS + moment_ms)
        saving.set(SAVING_FROM_MS + moment_ms + 0.001, "battery.voltage", volts)
        return saving.integer("saved_number")

    return fall


@pytest.mark.parametrize("moment", range(MOMENTS))
def test_a_brown_out_resets_the_program_and_leaves_a_whole_value(
    saving: Brick, falling: Callable[[float, float], int], moment: int
) -> None:
    """It is held in reset while the voltage is low, then starts, finds a value and saves on."""
    at_ms = moment * PERIOD_MS / MOMENTS
    saved = falling(at_ms, 3.0)
    low_ms = SAVING_FROM_MS + at_ms + 30
    saving.run(low_ms)
    assert saving.integer("saved_number") in (saved, saved + 1)
    saving.set(low_ms, "battery.voltage", 8.0)
    saving.run(low_ms + START_MS)
    assert saving.integer("cause") == BROWN_OUT
    assert saving.integer("mixed") == 0
    assert saving.integer("loaded") in (saved, saved + 1)
    assert saving.integer("saved_number") > saving.integer("loaded")
    assert saving.integer("failures") == 0


@pytest.mark.parametrize("moment", range(MOMENTS))
def test_a_dead_battery_leaves_a_whole_value(
    elf: bytes, saving: Brick, falling: Callable[[float, float], int], moment: int
) -> None:
    """The run ends; the flash memory, put into a brick with a new battery, has a value."""
    at_ms = moment * PERIOD_MS / MOMENTS
    saved = falling(at_ms, 0.0)
    stop = saving.run_to_end(SAVING_FROM_MS + at_ms + 30)
    assert (stop.reason, stop.message) == ("power_off", "the battery's voltage fell below 2 V")
    again = start(elf, memory_of(saving))
    again.run(START_MS)
    assert again.integer("mixed") == 0
    assert again.integer("loaded") in (saved, saved + 1)
    assert again.integer("failures") == 0


def test_the_cuts_leave_pages_half_done(
    saving: Brick, falling: Callable[[float, float], int]
) -> None:
    """Otherwise these tests would show nothing: most moments tear the page that is written."""
    torn = 0
    for moment in range(MOMENTS):
        at_ms = moment * PERIOD_MS / MOMENTS
        falling(at_ms, 0.0)
        before = memory_of(saving)
        saving.run_to_end(SAVING_FROM_MS + at_ms + 30)
        torn += memory_of(saving) != before
    assert torn >= MOMENTS // 2


def test_without_the_guard_the_program_goes_on(elf: bytes) -> None:
    """What cannot be programmed is told as failures, and the value before stays."""
    device = start(elf, ERASED * PAGE_COUNT)
    device.set(0, "touch.1", 1)
    device.set(400, "battery.voltage", 3.0)
    device.set(500, "battery.voltage", 8.0)
    device.run(399)
    saved = device.integer("saved_number")
    device.run(500)
    assert device.integer("saved_number") in (saved, saved + 1)
    assert device.integer("failures") > 2
    device.run(600)
    assert device.integer("saved_number") > saved + 5
    assert device.integer("cause") == POWER_ON
