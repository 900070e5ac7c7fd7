# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.AVR's inputs, touch sensors, buttons and battery on the virtual brick."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.observe import Brick, battery

BUTTONS = {"orange": 1, "left": 2, "grey": 3, "right": 4}
MILLIVOLTS_PER_COUNT = 13.848
STARTED_MS = 400.0


def test_inputs_become_available_without_an_error(brick: Callable[..., Brick]) -> None:
    """The co-processor answers, and no transfer fails in a second."""
    device = brick("inputs")
    device.run(20)
    assert device.integer("ready") == 0
    device.run(1_000)
    assert device.integer("ready") == 1
    assert device.integer("errors") == 0


def test_nothing_is_pressed_before_the_co_processor_samples(brick: Callable[..., Brick]) -> None:
    """Frames of zeros, which it sends at power-on, are neither a touch nor a battery."""
    device = brick("inputs", kind="flash")
    ready_ms = None
    for ms in range(20, 400, 2):
        device.run(ms)
        assert device.integer("touched") == 0
        if ready_ms is None and device.integer("ready"):
            ready_ms = ms
        assert (device.integer("battery") > 7_900) == (ready_ms is not None)
    assert ready_ms is not None
    assert ready_ms > 100
    assert device.integer("errors") == 0


def test_a_touch_is_seen_and_its_end_too(brick: Callable[..., Brick]) -> None:
    """Within 10 ms, two exchanges and a sample of the co-processor."""
    device = brick("inputs")
    device.set(STARTED_MS, "touch.1", 1)
    device.set(STARTED_MS + 100, "touch.1", 0)
    device.run(STARTED_MS)
    assert device.integer("touched") == 0
    device.run(STARTED_MS + 10)
    assert device.integer("touched") == 1
    device.run(STARTED_MS + 110)
    assert device.integer("touched") == 0


@pytest.mark.parametrize("name", BUTTONS)
def test_each_button_is_told_from_the_others(brick: Callable[..., Brick], name: str) -> None:
    """A held button is the current one, and none is when it is let go."""
    device = brick("inputs")
    device.set(STARTED_MS, f"button.{name}", 1)
    device.set(STARTED_MS + 100, f"button.{name}", 0)
    device.run(STARTED_MS + 50)
    assert device.integer("button") == BUTTONS[name]
    device.run(STARTED_MS + 150)
    assert device.integer("button") == 0


@pytest.mark.parametrize("volts", [6.6, 7.2, 8.0, 9.0])
def test_the_battery_is_measured(brick: Callable[..., Brick], volts: float) -> None:
    """The voltage is right to two counts of the converter."""
    device = brick("inputs", battery=battery(volts))
    device.run(STARTED_MS)
    tolerance = 2 * MILLIVOLTS_PER_COUNT
    assert device.integer("battery") == pytest.approx(volts * 1000, abs=tolerance)
    assert device.integer("pack") == 1


def test_an_empty_port_reads_the_top_of_the_scale(brick: Callable[..., Brick]) -> None:
    """The analogue line of a port without a sensor is pulled up."""
    device = brick("inputs")
    device.run(STARTED_MS)
    assert device.integer("raw_2") >= 1_000
