# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""No encoder count is lost at 2,000 deg/s on three motors at once, whatever else goes on."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from verification.support.bricks.observe import NXT_MOTOR, Brick

RAD_PER_S = math.radians(2_000)
TURN_MS = 700.0
START_MS = 300.0


def hands() -> dict[str, Any]:
    """Three motors, each turned by a hand as fast as that."""
    motor = {"parameters": NXT_MOTOR, "held_by_hand": True, "hand_rate": RAD_PER_S}
    return {name: motor for name in "ABC"}


@pytest.mark.parametrize(
    "signs", [(1, 1, 1), (-1, -1, -1), (1, -1, 1)], ids=["forward", "backward", "mixed"]
)
def test_no_count_is_lost(brick: Callable[..., Brick], signs: tuple[int, int, int]) -> None:
    """Six turns of 1,300 degrees there and back, with display, sound, sensor and link busy."""
    device = brick("encoder_stress", motors=hands(), sensors={"4": {"kind": "ultrasonic"}})
    device.set(10, "distance.4", 0.5)
    goals = (1_300, 0, 1_300, -1_300, 0, 650)
    at_ms = START_MS
    for goal in goals:
        for motor, sign in zip("ABC", signs, strict=True):
            device.set(at_ms, f"motor.{motor}.hand_angle", math.radians(sign * goal))
        at_ms += TURN_MS * (2 if abs(goal) == 1_300 else 1)
        device.run(at_ms - 20)
        for motor, sign in zip("abc", signs, strict=True):
            assert device.integer(f"count_{motor}") == pytest.approx(sign * goal, abs=1)
    assert device.integer("rounds") > 20


def test_the_motors_were_that_fast(brick: Callable[..., Brick]) -> None:
    """The stimulus turns 200 degrees in 0.1 s, so that 6,000 edges come in a second."""
    device = brick("encoder_stress", motors=hands(), sensors={"4": {"kind": "ultrasonic"}})
    for motor in "ABC":
        device.set(START_MS, f"motor.{motor}.hand_angle", math.radians(2_000))
    device.run(START_MS + 400)
    first = device.device.read_int("nxt__motor_encoders__encoder_count", "i32")
    device.run(START_MS + 500)
    last = device.device.read_int("nxt__motor_encoders__encoder_count", "i32")
    assert last - first == pytest.approx(200, abs=2)
