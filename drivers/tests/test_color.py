# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Color_Sensors on the virtual brick."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.observe import SURFACES, Brick

SENSOR = {"2": {"kind": "color"}}
MEASURED, NO_SENSOR, WRONG_CHECKSUM = range(3)
STARTED_MS = 200.0
COLORS = ["none", "black", "blue", "green", "yellow", "red", "white"]


def show(device: Brick, at_ms: float, surface: tuple[float, float, float]) -> None:
    """A surface in front of the sensor."""
    for name, share in zip(("red", "green", "blue"), surface, strict=True):
        device.set(at_ms, f"color.2.{name}", share)


@pytest.mark.parametrize("name", SURFACES)
def test_a_color_is_named(brick: Callable[..., Brick], name: str) -> None:
    """The parts are shares of white, corrected by the sensor's own factors."""
    device = brick("color", sensors=SENSOR)
    show(device, 10, SURFACES[name])
    device.run(STARTED_MS + 50)
    assert device.integer("status") == MEASURED
    parts = device.integers("parts")
    assert parts[:3] == pytest.approx([255 * share for share in SURFACES[name]], abs=2)
    assert parts[3] == 0
    assert COLORS[device.integer("named")] == name


@pytest.mark.parametrize("ambient", [0.2, 0.45, 0.8])
def test_light_of_the_room_is_taken_off(brick: Callable[..., Brick], ambient: float) -> None:
    """In each range of it the sensor's factors make the same of a surface."""
    device = brick("color", sensors=SENSOR)
    show(device, 10, (0.6, 0.3, 0.2))
    device.set(10, "color.2", ambient)
    device.run(STARTED_MS + 50)
    red, green, blue, background = device.integers("parts")
    assert (red, green, blue) == pytest.approx((153, 76.5, 51), abs=2)
    assert background == pytest.approx(255 * ambient * 750 / 952, abs=2)


def test_one_lamp_makes_a_light_sensor_of_it(brick: Callable[..., Brick]) -> None:
    """In the red light a red surface is bright and a blue one dark, and colours come back."""
    device = brick("color", sensors=SENSOR)
    show(device, 10, SURFACES["red"])
    device.set(300, "button.left", 1)
    device.set(350, "button.left", 0)
    show(device, 600, SURFACES["blue"])
    device.set(800, "button.right", 1)
    device.set(850, "button.right", 0)
    device.run(590)
    assert device.integer("level") == 100 * 248 // 952
    device.run(690)
    assert device.integer("level") == 100 * 40 // 952
    device.run(1100)
    assert COLORS[device.integer("named")] == "blue"


def test_measuring_leaves_the_processor_idle(brick: Callable[..., Brick]) -> None:
    """A measurement each 21 ms, which lasts 0.7 ms, comes at least 40 times in a second."""
    device = brick("color", sensors=SENSOR)
    device.run(STARTED_MS)
    before = device.integer("rounds")
    device.run(STARTED_MS + 1000)
    assert 40 <= device.integer("rounds") - before <= 50


def test_an_empty_port_is_told(brick: Callable[..., Brick]) -> None:
    """Nothing answers, and nothing waits for it."""
    device = brick("color", sensors={})
    device.run(STARTED_MS + 300)
    assert device.integer("status") == NO_SENSOR
    assert device.integer("rounds") > 15


def test_a_wrong_check_sum_is_told_and_tried_again(brick: Callable[..., Brick]) -> None:
    """Colours come when the calibration comes whole."""
    device = brick("color", sensors=SENSOR)
    device.set(5, "fault.2.checksum", 1)
    show(device, 10, SURFACES["green"])
    device.set(400, "fault.2.checksum", 0)
    device.run(390)
    assert device.integer("status") == WRONG_CHECKSUM
    device.run(800)
    assert device.integer("status") == MEASURED
    assert COLORS[device.integer("named")] == "green"


@pytest.mark.parametrize("line", [0, 1])
def test_a_shorted_line_is_survived(brick: Callable[..., Brick], line: int) -> None:
    """With the data line low it is dark; in the end the colour is there again."""
    device = brick("color", sensors=SENSOR)
    show(device, 10, SURFACES["red"])
    device.set(300, f"fault.2.digital_{line}_low", 1)
    device.set(500, f"fault.2.digital_{line}_low", 0)
    device.run(490)
    assert device.integers("parts")[:3] == [0, 0, 0]
    device.run(1000)
    assert COLORS[device.integer("named")] == "red"


@pytest.mark.parametrize("at_ms", [20.0, 60.0, 106.1, 112.3, 130.9, 300.2, 300.5, 310.0])
def test_unplugging_at_any_moment_is_survived(brick: Callable[..., Brick], at_ms: float) -> None:
    """In the reset, in the exchange, in a measurement: no colour, and the sensor comes back."""
    device = brick("color", sensors=SENSOR)
    show(device, 10, SURFACES["yellow"])
    device.set(at_ms, "sensor.2.plugged", 0)
    device.set(500, "sensor.2.plugged", 1)
    device.run(490)
    assert device.integer("status") == NO_SENSOR
    device.run(900)
    assert device.integer("status") == MEASURED
    assert COLORS[device.integer("named")] == "yellow"
