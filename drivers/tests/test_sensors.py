# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Light_Sensors and NXT.Sound_Sensors on the virtual brick."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.observe import Brick

PORTS = {"1": {"kind": "light"}, "2": {"kind": "sound"}}
RED = 5
FULL_SCALE_DB = 90.0
SILENT, LOUD = 1019, 133


def test_more_light_reads_higher(brick: Callable[..., Brick]) -> None:
    """Darkness and brightness read as the sensor's published range, normalised the other way."""
    device = brick("analogue_sensors", sensors=PORTS)
    device.set(90, "light.1", 1.0)
    device.run(85)
    assert (device.integer("raw_light"), device.integer("normalized")) == (900, 123)
    assert device.integer("value") == 100 * (900 - 1023) // -1023
    device.run(160)
    assert (device.integer("raw_light"), device.integer("normalized")) == (164, 859)


def test_calibration_stretches_the_range(brick: Callable[..., Brick]) -> None:
    """What was seen at the two calibrations is 0 and 100 %, and half of it is half."""
    device = brick("analogue_sensors", sensors=PORTS)
    device.set(10, "light.1", 0.2)
    device.set(130, "light.1", 0.6)
    device.set(230, "light.1", 0.4)
    device.set(300, "light.1", 0.1)
    device.run(225)
    assert device.integer("value") == 100
    device.run(280)
    assert device.integer("value") in (49, 50)
    device.run(400)
    assert device.integer("value") == pytest.approx(-25, abs=1)
    assert device.integer("percent") == 0


def test_the_lamp_lights_the_surface(brick: Callable[..., Brick]) -> None:
    """With the lamp on a white surface reads brighter than a black one, off none is seen."""
    device = brick("analogue_sensors", sensors=PORTS)
    device.set(10, "light.1.reflectance", 0.8)
    device.set(600, "light.1.reflectance", 0.1)
    device.run(480)
    assert (device.integer("raw_light"), device.integer("lamp")) == (900, 0)
    device.run(590)
    white = device.integer("raw_light")
    assert device.integer("lamp") == RED
    device.run(680)
    black = device.integer("raw_light")
    assert white < black < 900
    device.run(1_150)
    assert (device.integer("raw_light"), device.integer("lamp")) == (900, 0)


@pytest.mark.parametrize(("db", "hertz"), [(70.0, 1000.0), (80.0, 100.0), (90.0, 1000.0)])
def test_sound_is_plain_weighted_and_plain_again(
    brick: Callable[..., Brick], db: float, hertz: float
) -> None:
    """The level is proportional to the pressure; dBA hears less of low tones."""
    device = brick("analogue_sensors", sensors=PORTS)
    device.set(10, "sound.2", db)
    device.set(10, "sound.2.frequency", hertz)
    device.run(300)
    plain = SILENT - (SILENT - LOUD) * 10 ** ((db - FULL_SCALE_DB) / 20)
    assert device.integer("raw_sound") == pytest.approx(plain, abs=1)
    assert device.integer("level") == (1023 - device.integer("raw_sound")) * 100 // 1023
    assert device.integer("weighted") == 0
    device.run(690)
    assert device.integer("weighted") == 1
    if hertz == 1000.0:
        assert device.integer("raw_sound") == pytest.approx(plain, abs=1)
    else:
        assert device.integer("raw_sound") > plain + 100
    device.run(1_190)
    assert device.integer("weighted") == 0
    assert device.integer("raw_sound") == pytest.approx(plain, abs=1)


def test_an_unplugged_light_sensor_reads_dark(brick: Callable[..., Brick]) -> None:
    """Without a sensor the line is pulled up to the top of the range."""
    device = brick("analogue_sensors", sensors=PORTS)
    device.set(10, "light.1", 1.0)
    device.set(300, "sensor.1.plugged", 0)
    device.set(350, "sensor.1.plugged", 1)
    device.run(340)
    assert device.integer("raw_light") == 1023
    device.run(390)
    assert device.integer("raw_light") == 164
