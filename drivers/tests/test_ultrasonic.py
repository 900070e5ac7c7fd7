# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Ultrasonic_Sensors over the soft two-wire bus on the virtual brick."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.observe import Brick

SONAR = {"4": {"kind": "ultrasonic"}}
MEASURED, NO_ECHO, NO_ANSWER = range(3)
LAST = 254
MEASURING_MS = 800.0


def test_the_sensor_tells_what_it_is(brick: Callable[..., Brick]) -> None:
    """Version, maker, kind, units, modes and calibration come over the bus."""
    device = brick("ultrasonic", sensors=SONAR)
    device.run(MEASURING_MS)
    texts = [device.bytes(name).rstrip(b"\0 ") for name in ("version", "product", "kind", "units")]
    assert texts == [b"V1.0", b"LEGO", b"Sonar", b"10E-2m"]
    assert device.integers("modes") == [0, 1, 2, 3]
    assert device.integers("scale") == [0, 1, 14]


@pytest.mark.parametrize(
    ("metres", "reading", "status"),
    [(0.37, 37, MEASURED), (2.549, 254, MEASURED), (0.0, 0, MEASURED), (3.0, LAST, NO_ECHO)],
)
def test_distances_are_measured(
    brick: Callable[..., Brick], metres: float, reading: int, status: int
) -> None:
    """In whole centimetres; too far away is no echo."""
    device = brick("ultrasonic", sensors=SONAR)
    device.set(10, "distance.4", metres)
    device.run(MEASURING_MS + 100)
    assert (device.integer("reading"), device.integer("status")) == (reading, status)


def test_a_moving_wall_is_followed(brick: Callable[..., Brick]) -> None:
    """A new reading comes at least every 80 ms."""
    device = brick("ultrasonic", sensors=SONAR)
    for step in range(10):
        device.set(MEASURING_MS + 100 * step, "distance.4", 0.5 + 0.1 * step + 0.001)
        device.run(MEASURING_MS + 100 * step + 90)
        assert device.integer("reading") == 50 + 10 * step


def test_nothing_plugged_in_does_not_answer(brick: Callable[..., Brick]) -> None:
    """An empty port gives no answer, every time, and does not hang."""
    device = brick("ultrasonic", sensors={})
    device.run(MEASURING_MS)
    before = device.integer("rounds")
    device.run(MEASURING_MS + 500)
    assert device.integer("rounds") > before + 5
    assert (device.integer("status"), device.integer("reading")) == (NO_ANSWER, LAST)
    assert device.integer("silent") == 1


@pytest.mark.parametrize("line", [0, 1])
def test_a_shorted_line_is_no_answer_until_it_is_free(
    brick: Callable[..., Brick], line: int
) -> None:
    """Clock or data held low ends every transfer; the next one after it works."""
    device = brick("ultrasonic", sensors=SONAR)
    device.set(10, "distance.4", 0.8)
    device.set(MEASURING_MS + 3.3, f"fault.4.digital_{line}_low", 1)
    device.set(MEASURING_MS + 400, f"fault.4.digital_{line}_low", 0)
    device.run(MEASURING_MS + 390)
    assert device.integer("status") == NO_ANSWER
    device.run(MEASURING_MS + 600)
    assert (device.integer("status"), device.integer("reading")) == (MEASURED, 80)


@pytest.mark.parametrize("offset_ms", range(0, 48, 4))
def test_unplugging_at_any_moment_is_survived(brick: Callable[..., Brick], offset_ms: int) -> None:
    """Whatever part of a transfer is cut, readings stop at once and come back with the sensor."""
    device = brick("ultrasonic", sensors=SONAR)
    device.set(10, "distance.4", 0.8)
    device.set(MEASURING_MS + offset_ms, "sensor.4.plugged", 0)
    device.set(MEASURING_MS + 300, "sensor.4.plugged", 1)
    device.run(MEASURING_MS - 10)
    assert (device.integer("status"), device.integer("reading")) == (MEASURED, 80)
    device.run(MEASURING_MS + 290)
    assert (device.integer("status"), device.integer("reading")) == (NO_ANSWER, LAST)
    device.run(MEASURING_MS + 700)
    assert (device.integer("status"), device.integer("reading")) == (MEASURED, 80)
