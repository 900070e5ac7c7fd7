# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Watchdog, NXT.Power and NXT.Brick_Name on the virtual brick."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.observe import Brick
from verification.support.bricks.power_cut import memory_of, start

POWER_ON, WATCHDOG = 0, 1
ONE_SECOND = "0x1FFF20FF"
ERASED = b"\xff" * 8192


def test_a_hanging_program_is_started_anew(
    brick: Callable[..., Brick], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It runs while it restarts the watchdog; 1 s after it hangs the watchdog resets it."""
    monkeypatch.setenv("WATCHDOG_MODE", ONE_SECOND)
    device = brick("watchdog", kind="flash")
    device.run(2_900)
    assert (device.integer("cause"), device.integer("enabled")) == (POWER_ON, 1)
    assert device.integer("rounds") == 20
    device.run(3_600)
    assert device.integer("cause") == WATCHDOG
    assert device.integer("rounds") < 20


def test_a_program_in_ram_has_no_watchdog(
    brick: Callable[..., Brick], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The boot monitor has switched it off."""
    monkeypatch.setenv("WATCHDOG_MODE", ONE_SECOND)
    device = brick("watchdog", kind="ram")
    device.run(4_000)
    assert (device.integer("enabled"), device.integer("rounds")) == (0, 20)


def test_the_brick_keeps_its_name() -> None:
    """It is called NXT at first, and what it was called last after the next start."""
    elf = image_of("brick_name", "flash")
    first = start(elf, ERASED)
    first.run(250)
    assert first.text()[:2] == ["NXT", "brick number 7!"]
    second = start(elf, memory_of(first))
    second.run(250)
    assert second.text()[:2] == ["brick number 7!", "brick number 7!"]


def test_the_boot_monitor_is_entered(brick: Callable[..., Brick]) -> None:
    """The co-processor is told so, which is where the virtual brick ends."""
    device = brick("brick_name")
    stop = device.run_to_end(2_000)
    assert stop.reason != "reached"
    assert "boot monitor" in stop.message
