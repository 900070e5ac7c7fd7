# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Audio: what the loudspeaker of the virtual brick would play."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
import virtual_brick

from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.observe import CLOCK_DENOMINATOR, CLOCK_NUMERATOR, Brick, bench

SAMPLE_CYCLES = 1_000
RATE = CLOCK_NUMERATOR / CLOCK_DENOMINATOR / SAMPLE_CYCLES
FULL = 32_767
START_MS = 1.0

Samples = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def played() -> Callable[[float, float], Samples]:
    """From two instants in ms to what was played between them, full scale 1."""
    device = Brick(virtual_brick.VirtualBrick(json.dumps(bench()), image_of("audio", "ram")))
    device.run(1_600)
    samples = np.frombuffer(device.device.sound(), "<i2") / FULL
    return lambda start, end: samples[round(start * RATE / 1000) : round(end * RATE / 1000)]


def strongest(samples: Samples) -> tuple[float, float]:
    """Frequency and amplitude of the strongest tone."""
    window = np.hanning(len(samples))
    spectrum = np.abs(np.fft.rfft(samples * window)) * 2 / window.sum()
    peak = int(np.argmax(spectrum[1:])) + 1
    return float(np.fft.rfftfreq(len(samples), 1 / RATE)[peak]), float(spectrum[peak])


@pytest.mark.parametrize(
    ("start", "end", "hertz", "amplitude"),
    [
        (110, 290, 440, 0.5),
        (405, 445, 5_000, 1.0),
        (710, 790, 500, 100 / 128 * 4 / np.pi),
        (1_010, 1_090, 1_000, 1.0),
        (1_110, 1_190, 2_000, 1.0),
    ],
)
def test_tones_and_samples_have_their_frequency_and_volume(
    played: Callable[[float, float], Samples],
    start: float,
    end: float,
    hertz: float,
    amplitude: float,
) -> None:
    """The strongest line of the spectrum is where it was asked for, to one line or 1.5 %."""
    frequency, strength = strongest(played(start, end))
    line = 1000 / (end - start)
    assert frequency == pytest.approx(hertz, abs=max(line, 0.015 * hertz))
    assert strength == pytest.approx(amplitude, rel=0.15)


@pytest.mark.parametrize(
    ("start", "end"), [(0, 99), (305, 398), (452, 499), (605, 698), (805, 998), (1_205, 1_400)]
)
def test_it_is_silent_otherwise(
    played: Callable[[float, float], Samples], start: float, end: float
) -> None:
    """Before, between and after sounds, and while muted."""
    assert not played(start, end).any()


def test_a_sound_lasts_as_long_as_asked_for(played: Callable[[float, float], Samples]) -> None:
    """200 ms of a tone are that, to two buffers."""
    sounding = np.flatnonzero(np.abs(played(90, 390)) > 0.02)
    assert (sounding[-1] - sounding[0]) * 1000 / RATE == pytest.approx(200, abs=3)


def test_a_recording_is_played_at_the_nearest_rate_that_the_clock_gives(
    played: Callable[[float, float], Samples],
) -> None:
    """12 kHz is the clock by 62.57 times 64 bits: 63 are nearer than 62."""
    rises = np.flatnonzero(np.diff((played(1_490, 1_590) > 0.1).astype(int)) > 0)
    period_s = (rises[-1] - rises[0]) / (len(rises) - 1) / RATE
    clock = CLOCK_NUMERATOR / CLOCK_DENOMINATOR
    assert len(rises) == 800 // 16
    assert period_s == pytest.approx(16 * 64 * round(clock / 64 / 12_000) / clock, rel=0.004)


def test_the_time_remaining_counts_down(brick: Callable[..., Brick]) -> None:
    """It tells the rest of the sound to the length of its buffers, and 0 without one."""
    device = brick("audio")
    for at_ms, expected in [(50, 0), (110, 190), (250, 50), (350, 0), (480, 120), (1_110, 90)]:
        device.run(at_ms + START_MS)
        assert device.integer("remaining") == pytest.approx(expected, abs=4)
