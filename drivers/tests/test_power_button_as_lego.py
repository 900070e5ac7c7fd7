# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""LEGO's own firmware, switched off in its menu, gives the co-processor the same command."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ravenbrick.clock import MASTER_CLOCK

from verification.support.bricks.nxt_firmware import MENU_MS, firmware_brick, run_ms
from verification.support.bricks.observe import Brick

LENGTH, POWER, BRAKES, SUM = 9, 0, 6, 8
SWITCH_OFF = 0x5A


def sent_frames(log: Sequence[tuple[int, str]]) -> list[bytes]:
    """Whole frames to the co-processor, in order."""
    frames: list[bytearray] = []
    receiving = False
    for _, text in log:
        if text.startswith("twi S"):
            receiving = text == "twi S 02a"
            frames += [bytearray()] if receiving else []
        elif receiving and text.startswith("twi ") and text != "twi P":
            frames[-1].append(int(text[4:6], 16))
    return [bytes(frame) for frame in frames if len(frame) == LENGTH]


def last_commands(brick: Any, press_ms: int, within_ms: int) -> list[bytes]:
    """The commands to switch off, which end the run, after the orange button was pressed."""
    pressed = brick.cycles
    brick.record_buses()
    brick.schedule_input(pressed, "button.orange", 1)
    released = pressed + MASTER_CLOCK.cycles_of_ms(press_ms)
    brick.schedule_input(released, "button.orange", 0)
    stop = brick.run_until(pressed + MASTER_CLOCK.cycles_of_ms(within_ms))
    assert stop.reason == "power_off"
    return [frame for frame in sent_frames(brick.bus_log()) if frame[POWER] == SWITCH_OFF]


def test_the_command_is_that_of_the_firmware(brick: Callable[..., Brick]) -> None:
    """Frequency, no duty cycle, no sensor supply; only that NXT.AVR brakes; more than once."""
    lego = firmware_brick(sensors={})
    run_ms(lego, MENU_MS)
    lego.schedule_input(lego.cycles, "button.grey", 1)
    run_ms(lego, 150)
    lego.schedule_input(lego.cycles, "button.grey", 0)
    run_ms(lego, 600)
    firmware = last_commands(lego, press_ms=150, within_ms=1_000)
    ours = brick("power_button")
    ours.run(500)
    driver = last_commands(ours.device, press_ms=10_000, within_ms=4_000)
    assert len(set(firmware)) == len(set(driver)) == 1
    assert min(len(firmware), len(driver)) > 1
    differing = [at for at in range(LENGTH) if firmware[0][at] != driver[0][at]]
    assert differing == [BRAKES, SUM]
    assert (firmware[0][BRAKES], driver[0][BRAKES]) == (0, 0b111)
