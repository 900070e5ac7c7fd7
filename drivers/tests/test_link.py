# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.AVR when the co-processor's answers are wrong or do not come."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest
import virtual_brick

from verification.support.bricks.observe import CLOCK_DENOMINATOR, CLOCK_NUMERATOR, Brick, bench
from verification.support.bricks.programs import gprbuild

TESTS = Path(__file__).resolve().parent

SENSORS = {"2": {"kind": "analogue"}}
DRIVEN = {"A": (0, True), "B": (60, True), "C": (40, True)}
AFTER_LOSS = {"A": (0, True), "B": (0, True), "C": (40, True)}
FAULT_MS = 400.0


@pytest.mark.parametrize("count", [1, 3])
def test_a_few_wrong_sums_are_tolerated(brick: Callable[..., Brick], count: int) -> None:
    """They are counted, their values not used, and the motors go on."""
    device = brick("link", sensors=SENSORS)
    device.set(FAULT_MS, "fault.coprocessor_checksum", count)
    device.run(FAULT_MS + 100)
    assert (device.integer("errors"), device.integer("losses")) == (count, 0)
    assert device.motors(at_ms=FAULT_MS + 100) == DRIVEN


def test_inputs_stay_while_sums_are_wrong(brick: Callable[..., Brick]) -> None:
    """A reading that changes in the meantime is seen when the first good frame comes."""
    device = brick("link", sensors=SENSORS)
    device.set(10, "sensor.2.raw", 300)
    device.set(FAULT_MS, "fault.coprocessor_checksum", 40)
    device.set(FAULT_MS + 10, "sensor.2.raw", 700)
    device.run(FAULT_MS + 200)
    assert device.integer("sensor") == 300
    device.run(FAULT_MS + 1_000)
    assert device.integer("sensor") == 700


def test_many_wrong_sums_are_a_loss_that_brakes(brick: Callable[..., Brick]) -> None:
    """A motor that is not commanded again stays braked, one that is goes on."""
    device = brick("link", sensors=SENSORS)
    device.set(FAULT_MS, "fault.coprocessor_checksum", 6)
    device.run(FAULT_MS + 300)
    assert (device.integer("errors"), device.integer("losses")) == (6, 1)
    assert device.motors(at_ms=FAULT_MS - 10) == DRIVEN
    assert device.motors(at_ms=FAULT_MS + 100) == AFTER_LOSS


@pytest.mark.parametrize("offset_ms", [0.0, 0.2, 0.4, 1.0, 2.2])
def test_a_hanging_bus_is_reset_until_it_is_free(
    brick: Callable[..., Brick], offset_ms: float
) -> None:
    """Whatever part of a transfer hangs, exchange goes on within 50 ms of the end of the fault."""
    device = brick("link", sensors=SENSORS)
    device.set(10, "sensor.2.raw", 300)
    device.set(FAULT_MS + offset_ms, "fault.twi_stuck", 1)
    device.set(FAULT_MS + 500, "fault.twi_stuck", 0)
    device.set(FAULT_MS + 500, "sensor.2.raw", 700)
    device.run(FAULT_MS + 490)
    losses = device.integer("losses")
    assert losses > 5
    assert device.integer("sensor") == 300
    assert device.motors(at_ms=FAULT_MS + 490) == DRIVEN
    device.run(FAULT_MS + 1_500)
    assert device.integer("losses") <= losses + 2
    assert device.integer("sensor") == 700
    assert device.motors(at_ms=FAULT_MS + 600) == AFTER_LOSS
    assert device.motors(at_ms=FAULT_MS + 1_500) == AFTER_LOSS


def test_period_and_priority_are_the_programs_choice(tmp_path: Path) -> None:
    """With 10 ms in place of 2 ms, at a low priority, inputs come within 40 ms."""
    gprbuild(
        TESTS / "test.gpr",
        TEST="link",
        RAVENBRICK_BUILD=tmp_path,
        DRIVERS_CONFIGURATION=TESTS / "slow_link",
    )
    elf = (tmp_path / "drivers" / "tests" / "link" / "ram" / "link.elf").read_bytes()
    device = Brick(virtual_brick.VirtualBrick(json.dumps(bench() | {"sensors": SENSORS}), elf))
    device.set(10, "sensor.2.raw", 300)
    device.set(FAULT_MS, "sensor.2.raw", 700)
    device.run(FAULT_MS)
    assert device.integer("sensor") == 300
    device.run(FAULT_MS + 40)
    assert device.integer("sensor") == 700
    threads = {thread.name: thread.base_priority for thread in device.device.threads()}
    assert threads["coprocessor_task"] == 1
    assert (device.integer("errors"), device.integer("losses")) == (0, 0)


@pytest.mark.parametrize("stretch_us", [9, 20, 45])
def test_a_coprocessor_that_holds_the_clock_for_long_is_greeted(
    brick: Callable[..., Brick], stretch_us: int
) -> None:
    """Its text then lasts longer than a period of the link; no transfer counts as failed."""
    stretch_cycles = round(stretch_us * 1e-6 * CLOCK_NUMERATOR / CLOCK_DENOMINATOR)
    device = brick("link", timing={"coprocessor_stretch_cycles": stretch_cycles})
    device.run(FAULT_MS)
    assert (device.integer("errors"), device.integer("losses")) == (0, 0)
    assert device.motors(at_ms=FAULT_MS) == DRIVEN


def test_a_co_processor_that_takes_no_frame_goes_on_with_its_last_command(
    brick: Callable[..., Brick],
) -> None:
    """The clicking brick: every byte is acknowledged and every answer good, so nobody notices."""
    device = brick("link", sensors=SENSORS)
    device.set(10, "fault.coprocessor_refuses", 1)
    device.run(3_000)
    assert device.motors(at_ms=3_000) == {letter: (0, True) for letter in "ABC"}
    assert (device.integer("errors"), device.integer("losses")) == (0, 0)
    assert device.integer("sensor") > 0
    device.set(3_000.1, "fault.coprocessor_refuses", 0)
    device.run(3_100)
    assert device.motors(at_ms=3_100) == DRIVEN


def test_a_torn_word_is_read_as_it_comes_and_right_again_after_it(
    brick: Callable[..., Brick],
) -> None:
    """Its checksum is right: only the next reading shows that it was none. Whether a torn word is
    read or followed by its successor before, is a matter of timing; of 20 most are read."""
    device = brick("link", sensors=SENSORS)
    device.device.record_buses()
    device.set(10, "sensor.2.raw", 300)
    device.set(FAULT_MS, "fault.coprocessor_torn_words", 20)
    for change in range(20):
        device.set(FAULT_MS + 10 + 13 * change, "sensor.2.raw", (513, 300)[change % 2])
    device.set(FAULT_MS + 300, "sensor.2.raw", 513)
    device.run(FAULT_MS + 400)
    bus = "".join(event[4:] for _, event in device.device.bus_log() if event.startswith("twi"))
    answers = [bytes.fromhex(part.split("P")[0])[:13] for part in bus.split("S 03a")[1:]]
    words = [int.from_bytes(answer[2:4], "little") for answer in answers]
    torn = [word in (513 & 0xFF00 | 300 & 0xFF, 300 & 0xFF00 | 513 & 0xFF) for word in words]
    assert 10 < sum(torn) <= 20
    assert not any(one and after for one, after in pairwise(torn))
    assert device.integer("errors") == 0
    assert device.integer("sensor") == 513
