# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The power button, held for 3 s, switches the brick off whatever the program does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from verification.support.bricks.observe import Brick

BUTTON = "button.orange"
PRESSED_MS = 500.0
HOLD_MS = 3_000.0
# Two frames of the link and a sample of the co-processor; then 10 ms until it cuts the supply.
LATENCY_MS = 4 + 4 + 3
CUT_MS = 10
STOPPED = {"A": (0, True), "B": (0, True), "C": (0, True)}


def hold(device: Brick, from_ms: float, for_ms: float) -> None:
    """Press the power button at an instant for a while."""
    device.set(from_ms, BUTTON, 1)
    device.set(from_ms + for_ms, BUTTON, 0)


def switched_off_ms(device: Brick, stop: Any) -> float:
    """When the co-processor cut the supply, which is the last event of the run."""
    assert "switched the brick off" in stop.message
    return float(stop.at_cycles) * 1000 / device.cycles(1_000)


def test_a_button_held_for_3_s_switches_off(brick: Callable[..., Brick]) -> None:
    """Though the main procedure loops and a task commands a motor; this motor brakes first."""
    device = brick("power_button")
    hold(device, PRESSED_MS, for_ms=10_000)
    device.run(PRESSED_MS + HOLD_MS)
    assert device.motors(at_ms=PRESSED_MS + HOLD_MS)["B"] == (60, True)
    stop = device.run_to_end(10_000)
    assert stop.reason == "power_off"
    held_ms = switched_off_ms(device, stop) - PRESSED_MS
    assert HOLD_MS <= held_ms <= HOLD_MS + LATENCY_MS + CUT_MS
    last = [command for command in device.motor_commands() if command.motor == "B"][-2:]
    assert [(command.duty, command.brake) for command in last] == [(0, True), (0, False)]


def test_a_shorter_press_is_the_programs(brick: Callable[..., Brick]) -> None:
    """Presses of 2.9 s are counted by the program, and do not add up."""
    device = brick("power_button")
    for press in range(3):
        hold(device, PRESSED_MS + press * 3_000, for_ms=2_900)
    device.run(10_000)
    assert device.integer("presses") == 3
    assert device.motors(at_ms=10_000)["B"] == (60, True)


@pytest.mark.parametrize("kind", ["ram", "flash"])
def test_a_button_held_since_the_start_must_be_released_first(
    brick: Callable[..., Brick], kind: str
) -> None:
    """It is the press that switched the brick on."""
    device = brick("power_button", kind)
    device.set(0, BUTTON, 1)
    device.set(8_000, BUTTON, 0)
    device.set(8_500, BUTTON, 1)
    device.run(8_500 + HOLD_MS)
    assert device.run_to_end(20_000).reason == "power_off"


def test_other_buttons_do_not_switch_off(brick: Callable[..., Brick]) -> None:
    """Nor do all three together; with the power button they do not disturb it."""
    device = brick("power_button")
    for name in ("left", "right", "grey"):
        device.set(PRESSED_MS, f"button.{name}", 1)
    device.set(8_000, BUTTON, 1)
    device.run(8_000 + HOLD_MS)
    for offset, name in enumerate(("left", "right", "grey")):
        device.set(9_000 + 100 * offset + 2_001, f"button.{name}", 0)
    assert device.run_to_end(20_000).reason == "power_off"


def test_a_bouncing_contact_does_not_restart_the_hold(brick: Callable[..., Brick]) -> None:
    """Releases of 10 ms are ignored, apart from their own time; one of 40 ms is a release."""
    bouncing = brick("power_button")
    for bounce in range(10):
        hold(bouncing, PRESSED_MS + 310 * bounce, for_ms=300)
    bouncing.set(PRESSED_MS + 3_100, BUTTON, 1)
    assert bouncing.run_to_end(PRESSED_MS + 3_200).reason == "power_off"
    released = brick("power_button")
    hold(released, PRESSED_MS, for_ms=2_000)
    hold(released, PRESSED_MS + 2_040, for_ms=2_000)
    released.run(PRESSED_MS + 5_000)


def test_the_hold_goes_on_after_a_loss_of_the_link(brick: Callable[..., Brick]) -> None:
    """What cannot be seen does not count, and the first frame after the loss may say so."""
    device = brick("power_button")
    device.set(PRESSED_MS, BUTTON, 1)
    device.set(PRESSED_MS + 1_000, "fault.twi_stuck", 1)
    device.set(PRESSED_MS + 2_000, "fault.twi_stuck", 0)
    device.run(PRESSED_MS + HOLD_MS + 900)
    stop = device.run_to_end(10_000)
    assert stop.reason == "power_off"
    assert stop.at_cycles < device.cycles(PRESSED_MS + HOLD_MS + 1_200)
    lost = brick("power_button")
    hold(lost, PRESSED_MS, for_ms=2_000)
    lost.set(PRESSED_MS + 1_900, "fault.twi_stuck", 1)
    lost.set(PRESSED_MS + 9_000, "fault.twi_stuck", 0)
    lost.run(10_500)


@pytest.mark.parametrize("name", ["last_chance", "stack_overflow", "ceiling_violation"])
def test_a_failed_program_is_switched_off(brick: Callable[..., Brick], name: str) -> None:
    """With its report on the display, motors braked and no click, until the supply is cut."""
    device = brick(name)
    hold(device, 6_000, for_ms=10_000)
    device.run(6_000 + HOLD_MS)
    assert device.text()[0] == "Program failed"
    assert device.motors(at_ms=6_000 + HOLD_MS) == STOPPED
    stop = device.run_to_end(20_000)
    assert stop.reason == "halted"
    assert HOLD_MS <= switched_off_ms(device, stop) - 6_000 <= HOLD_MS + 2 * LATENCY_MS + CUT_MS


def test_a_failed_program_ignores_short_presses(brick: Callable[..., Brick]) -> None:
    """The run ends when nobody will press the button any more."""
    device = brick("last_chance")
    hold(device, 1_000, for_ms=2_900)
    stop = device.run_to_end(20_000)
    assert stop.reason == "halted"
    assert "switched" not in stop.message
    assert device.cycles(3_900) <= stop.at_cycles <= device.cycles(3_910)


def test_a_failed_program_outlives_a_stuck_bus(brick: Callable[..., Brick]) -> None:
    """The co-processor hangs when the program fails: motors stop, and it goes off, later."""
    device = brick("last_chance")
    device.set(300, "fault.twi_stuck", 1)
    device.set(2_000, "fault.twi_stuck", 0)
    hold(device, 3_000, for_ms=10_000)
    device.run(1_990)
    assert device.motors(at_ms=1_990)["B"] == (60, True)
    device.run(2_100)
    assert device.motors(at_ms=2_100) == STOPPED
    assert "switched the brick off" in device.run_to_end(20_000).message
