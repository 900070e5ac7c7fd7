# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""LEGO's own firmware with the virtual brick's colour sensor sees what NXT.Color_Sensors sees."""

from __future__ import annotations

from typing import Any

import nxt.brick
import nxt.sensor
import nxt.sensor.generic
import pytest
from ravenbrick.brick.links.peers import UsbComputer
from ravenbrick.brick.links.telegrams import UsbTelegrams

from verification.support.bricks.nxt_firmware import MENU_MS, firmware_brick, run_ms
from verification.support.bricks.observe import SURFACES

PORT = nxt.sensor.Port.S2
START_MS, MEASURE_MS = 700, 30


@pytest.fixture(scope="module")
def watching() -> tuple[Any, Any]:
    """A brick with LEGO's firmware, and nxt-python's view of its colour sensor."""
    brick = firmware_brick(sensors={"2": {"kind": "color"}})
    run_ms(brick, MENU_MS)
    remote = nxt.brick.Brick(UsbTelegrams(UsbComputer(brick)))
    sensor = remote.get_sensor(PORT, nxt.sensor.generic.Color)
    run_ms(brick, START_MS)
    return brick, sensor


def put(brick: Any, **values: float) -> None:
    """Let inputs of the sensor change now."""
    for name, value in values.items():
        brick.schedule_input(brick.cycles, f"color.2.{name}", value)
    run_ms(brick, MEASURE_MS)


@pytest.mark.parametrize("name", SURFACES)
def test_the_firmware_names_the_same_color(watching: tuple[Any, Any], name: str) -> None:
    """Reset, mode, calibration with its sum, lamps and voltages are what it expects."""
    brick, sensor = watching
    put(brick, **dict(zip(("red", "green", "blue"), SURFACES[name], strict=True)))
    assert sensor.get_color().name.lower() == name


def test_the_firmware_sees_the_light_of_each_lamp(watching: tuple[Any, Any]) -> None:
    """A surface is as bright in each light as it throws that light back."""
    brick, sensor = watching
    put(brick, red=0.9, green=0.5, blue=0.1)
    levels = []
    for lamp in ("RED", "GREEN", "BLUE", "NONE"):
        color = getattr(nxt.sensor.Type, f"COLOR_{lamp}")
        sensor.set_light_color(color)
        run_ms(brick, START_MS)
        levels.append(sensor.get_valid_input_values().raw_value)
    assert levels == [71 + 297, 71 + 128, 71 + 28, 71]
