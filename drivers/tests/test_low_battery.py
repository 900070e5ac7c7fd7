# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A low battery is heard, in programs that are supervised, and NXT.Battery says that it is low."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
import virtual_brick

from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.observe import CLOCK_DENOMINATOR, CLOCK_NUMERATOR, Brick, bench
from verification.support.failing_program import put_values
from verification.support.paths import BUILD

RATE_KHZ = CLOCK_NUMERATOR / CLOCK_DENOMINATOR / 1_000 / 1_000
LOW_MS = 500.0
SILENT_MS, HUM_MS = 800, 200
# A frame of inputs, and the co-processor's sample before.
LATE_MS = 10

Start = Callable[..., Brick]


@pytest.fixture
def start() -> Start:
    """A brick with this battery and program, supervised as if `ravenbrick build` had linked it."""

    def start(volts: float = 8.0, kind: str = "li_ion", name: str = "inputs",
              supervised: int = 1) -> Brick:  # fmt: skip
        content = bytearray(image_of(name))
        elf = BUILD / "drivers" / "tests" / name / "ram" / f"{name}.elf"
        put_values(content, elf, {"ravenbrick_supervision": supervised})
        battery = {"kind": kind, "voltage": volts, "internal_resistance": 0.0}
        configuration = json.dumps(bench() | {"battery": battery})
        return Brick(virtual_brick.VirtualBrick(configuration, bytes(content)))

    return start


def heard(brick: Brick) -> npt.NDArray[np.float64]:
    """What the loudspeaker played, full scale 1."""
    return np.frombuffer(brick.device.sound(), "<i2") / 32_767


def stretches_ms(samples: npt.NDArray[np.float64]) -> list[tuple[float, float]]:
    """Begin and end of what is heard without a pause of 20 ms."""
    places = np.flatnonzero(samples) / RATE_KHZ
    cuts = np.flatnonzero(np.diff(places) > 20)
    begins, ends = np.append(places[:1], places[cuts + 1]), np.append(places[cuts], places[-1:])
    return list(zip(begins.tolist(), ends.tolist(), strict=True))


def tone(samples: npt.NDArray[np.float64], begin_ms: float, end_ms: float) -> tuple[float, float]:
    """Frequency in hertz and amplitude of the strongest tone."""
    part = samples[round(begin_ms * RATE_KHZ) : round(end_ms * RATE_KHZ)]
    window = np.hanning(len(part))
    spectrum = np.abs(np.fft.rfft(part * window)) * 2 / window.sum()
    peak = int(np.argmax(spectrum[1:])) + 1
    return float(np.fft.rfftfreq(len(part), 1 / (1_000 * RATE_KHZ))[peak]), float(spectrum[peak])


def test_a_battery_that_stays_low_hums_each_second_until_it_is_good(start: Start) -> None:
    """For 0.2 s after 0.8 s, three times; the program goes on meanwhile."""
    brick = start()
    brick.set(LOW_MS, "battery.voltage", 6.9)
    brick.set(LOW_MS + 3_500, "battery.voltage", 8.0)
    brick.set(LOW_MS + 4_400, "touch.1", 1)
    brick.run(LOW_MS + 3_400)
    assert brick.integer("low") == 1
    brick.run(LOW_MS + 4_500)
    assert (brick.integer("low"), brick.integer("touched")) == (0, 1)
    found = stretches_ms(heard(brick))
    assert len(found) == 3
    for number, (begin, end) in enumerate(found):
        due = LOW_MS + SILENT_MS + 1_000 * number
        assert due < begin < due + LATE_MS
        assert end - begin == pytest.approx(HUM_MS, abs=5)
        assert tone(heard(brick), begin, end)[0] == pytest.approx(125, abs=5)


def test_a_motor_that_starts_does_not_make_it_hum(start: Start) -> None:
    """Nor does an empty battery for 0.7 s, again and again."""
    brick = start()
    for number in range(4):
        brick.set(LOW_MS + 1_000 * number, "battery.voltage", 6.0)
        brick.set(LOW_MS + 1_000 * number + 700, "battery.voltage", 8.0)
    brick.run(LOW_MS + 4_500)
    assert not heard(brick).any()


@pytest.mark.parametrize(
    ("kind", "volts", "low"),
    [("li_ion", 6.95, 1), ("li_ion", 7.05, 0), ("aa", 6.05, 1), ("aa", 6.15, 0)],
)
def test_cells_are_low_at_a_lower_voltage_than_the_pack(
    start: Start, kind: str, volts: float, low: int
) -> None:
    """7.0 V and 6.1 V."""
    brick = start(volts, kind)
    brick.run(20)
    assert brick.integer("low") == 0
    brick.run(1_200)
    assert brick.integer("low") == low
    assert heard(brick).any() == bool(low)


def test_a_tone_of_the_program_is_heard_without_the_hum(start: Start) -> None:
    """The hum, due from 1,100 to 1,300 ms, begins when the tone ends at 1,200 ms."""
    brick = start(name="audio")
    brick.set(300, "battery.voltage", 6.9)
    brick.run(1_400)
    frequency, strength = tone(heard(brick), 1_110, 1_190)
    assert frequency == pytest.approx(2_000, abs=20)
    assert strength == pytest.approx(1.0, rel=0.15)
    assert tone(heard(brick), 1_210, 1_290)[0] == pytest.approx(125, abs=13)


def test_a_program_without_supervision_does_not_hum(start: Start) -> None:
    """It can still ask."""
    brick = start(6.9, supervised=0)
    brick.run(1_500)
    assert brick.integer("low") == 1
    assert not heard(brick).any()
