# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Motor_Controls, NXT.Motor_Encoders and NXT.AVR's outputs on the virtual brick."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from verification.support.bricks.observe import Brick


def test_motors_obey_the_commands(brick: Callable[..., Brick]) -> None:
    """Duty cycles, decay, brake and coast arrive at the motors within one exchange."""
    device = brick("motors")
    device.run(600)
    assert device.motors(at_ms=290) == {"A": (50, True), "B": (-75, True), "C": (30, False)}
    assert device.motors(at_ms=390) == {"A": (0, True), "B": (0, False), "C": (-100, True)}
    assert device.motors(at_ms=600) == {"A": (0, True), "B": (0, True), "C": (0, True)}


def test_motor_objects_drive_their_motors(brick: Callable[..., Brick]) -> None:
    """Power and direction are kept apart, and a stopped motor does not reverse."""
    device = brick("motor_objects")
    device.run(690)
    instants = (290, 390, 490, 590, 690)
    assert [device.motors(at_ms=at)["B"] for at in instants] == [
        (25, True),
        (-25, True),
        (-60, True),
        (0, True),
        (0, False),
    ]
    assert device.integer("moving") == 0


@pytest.mark.parametrize("angle", [0.0, 1.0, -1.0, 12.0])
def test_an_encoder_counts_degrees(brick: Callable[..., Brick], angle: float) -> None:
    """A motor turned by hand reads as its angle in degrees, with its sign."""
    device = brick("encoders")
    device.set(10, "motor.A.hand_angle", angle)
    device.run(4_000)
    assert device.integer("count_a") == pytest.approx(math.degrees(angle), abs=1.0)
    assert device.integer("count_b") == 0
    assert device.integer("count_c") == 0


def test_an_encoder_loses_no_count_there_and_back(brick: Callable[..., Brick]) -> None:
    """After turns in both directions the count is back where it was."""
    device = brick("encoders")
    for at_ms, angle in [(10, 3.0), (1_000, -3.0), (3_000, 0.0)]:
        device.set(at_ms, "motor.A.hand_angle", angle)
    device.run(900)
    assert device.integer("count_a") == pytest.approx(math.degrees(3.0), abs=1.0)
    device.run(4_500)
    assert abs(device.integer("count_a")) <= 1


def test_readings_carry_later_and_later_instants(brick: Callable[..., Brick]) -> None:
    """Two consistent readings never have the same instant."""
    device = brick("encoders")
    device.run(500)
    assert device.integer("unequal") == 0
