# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Regulated_Motors on the virtual brick: speeds and angles, held against loads."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from drivers.regulation.design import GENERATED, design, generate
from verification.support.bricks.observe import Brick, battery

RUN_MS, TURN_BACK_MS, FLOAT_MS, AGAIN_MS = 405.0, 3_005.0, 4_505.0, 5_005.0
SPEED_STEP = 32
LOAD_TORQUE = 0.1
NONE, OF_SPEED = 0, 1


def test_the_generated_controllers_are_those_of_the_design(tmp_path: Path) -> None:
    """Designing again gives the committed files."""
    generate(design(), tmp_path)
    committed = {path.name: path.read_bytes() for path in GENERATED.iterdir()}
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == committed


@pytest.mark.parametrize("volts", [6.5, 9.0])
def test_a_speed_is_reached_and_kept(brick: Callable[..., Brick], volts: float) -> None:
    """After 0.3 s the motor turns by the set speed, whatever the battery gives."""
    device = brick("regulated_motors", battery=battery(volts))
    device.run(RUN_MS + 300)
    first = device.integer("angle_b")
    device.run(RUN_MS + 1_300)
    assert device.integer("angle_b") - first == pytest.approx(300, abs=3)
    assert device.integer("speed_b") == pytest.approx(300, abs=SPEED_STEP)


def test_a_load_slows_it_for_a_moment_only(brick: Callable[..., Brick]) -> None:
    """A torque of 0.1 N m comes while it turns; 0.4 s later the speed is back."""
    device = brick("regulated_motors")
    device.set(RUN_MS + 500, "motor.B.load_torque", -LOAD_TORQUE)
    device.run(RUN_MS + 900)
    first = device.integer("angle_b")
    device.run(RUN_MS + 1_900)
    assert device.integer("angle_b") - first == pytest.approx(300, abs=3)


@pytest.mark.parametrize("torque", [0.0, -0.05])
def test_an_angle_is_reached_and_held(brick: Callable[..., Brick], torque: float) -> None:
    """Two turns at 400 deg/s take less than 2.6 s, and 90 degrees back from there 1 s."""
    device = brick("regulated_motors")
    device.set(10, "motor.C.load_torque", torque)
    device.run(TURN_BACK_MS - 10)
    assert device.integer("angle_c") == pytest.approx(720, abs=2)
    device.run(FLOAT_MS + 10)
    assert device.integer("angle_c") == pytest.approx(630, abs=2)
    if torque == 0.0:
        assert device.integer("arrivals") == 2


def test_a_motor_one_degree_off_has_arrived(brick: Callable[..., Brick]) -> None:
    """The tolerance is part of it: before the motor has moved at all."""
    device = brick("regulated_motors")
    device.run(AGAIN_MS - 10)
    before = device.integer("angle_c")
    device.run(AGAIN_MS + 40)
    assert device.integer("arrivals") == 3
    assert device.integer("angle_c") == before


def test_an_angle_is_not_overshot(brick: Callable[..., Brick]) -> None:
    """On the way to two turns no angle beyond them is seen."""
    device = brick("regulated_motors")
    highest = 0
    for at_ms in range(int(RUN_MS), int(TURN_BACK_MS) - 10, 10):
        device.run(at_ms)
        highest = max(highest, device.integer("angle_c"))
    assert 719 <= highest <= 721


def test_backward_and_float(brick: Callable[..., Brick]) -> None:
    """A negative speed turns it back; after the stop nothing drives it and it coasts."""
    device = brick("regulated_motors")
    device.run(TURN_BACK_MS + 400)
    first = device.integer("angle_b")
    device.run(TURN_BACK_MS + 1_400)
    assert device.integer("angle_b") - first == pytest.approx(-200, abs=3)
    device.run(AGAIN_MS - 20)
    assert device.motors(at_ms=AGAIN_MS - 20)["B"] == (0, False)
    assert device.integer("kind_b") == NONE


def test_a_lost_link_ends_the_regulation(brick: Callable[..., Brick]) -> None:
    """Motors stay braked when the link is back, until they are commanded anew."""
    device = brick("regulated_motors")
    device.set(TURN_BACK_MS + 500, "fault.twi_stuck", 1)
    device.set(TURN_BACK_MS + 600, "fault.twi_stuck", 0)
    device.run(TURN_BACK_MS + 499)
    assert device.integer("kind_b") == OF_SPEED
    device.run(FLOAT_MS - 100)
    assert device.integer("kind_b") == NONE
    assert device.motors(at_ms=FLOAT_MS - 100)["B"] == (0, True)
    device.run(AGAIN_MS + 1_000)
    assert device.integer("speed_b") == pytest.approx(100, abs=SPEED_STEP)
