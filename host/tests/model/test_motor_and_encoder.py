# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Motor constants and encoder counts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ravenbrick.errors import DesignError
from ravenbrick.model import NXT_MOTOR, Encoder, MotorParameters, SpeedLoop, SpeedWindow


def test_table_1_gives_the_transfer_function_of_the_paper() -> None:
    """K = 2.029 rad/s per V and tau = 0.037 s come out of the motor constants."""
    assert round(NXT_MOTOR.gain, 3) == 2.029
    assert round(NXT_MOTOR.time_constant, 3) == 0.037
    assert NXT_MOTOR.transfer_function().dcgain() == pytest.approx(NXT_MOTOR.gain)


def test_a_constant_that_cannot_be_is_named() -> None:
    """A resistance of 0 is refused by name."""
    with pytest.raises(DesignError, match="resistance must be > 0"):
        MotorParameters(0.3, 0.4, 0.0, 1e-3, 1e-3, "none")


def test_the_loop_gain_is_that_of_figure_4() -> None:
    """a = 2.029 * 57.2958 / 116 V/V."""
    loop = SpeedLoop(2.029, 0.037, 116.0)
    assert loop.loop_gain == pytest.approx(1.002183, abs=1e-6)


def test_a_count_is_a_degree_and_the_phase_shifts_the_edges() -> None:
    """Counts are rounded down, also for negative angles."""
    degrees = [0.0, 0.999, 1.001, -0.001, -1.001, 359.5]
    assert [Encoder().count(math.radians(a)) for a in degrees] == [0, 0, 1, -1, -2, 359]
    assert Encoder(phase=0.5).count(math.radians(0.6)) == 1


def test_the_quantum_over_4_ms_is_250_degrees_per_second() -> None:
    """In the loop that is 2.155 V."""
    quantum = Encoder().speed_quantum(0.004)
    assert math.degrees(quantum) == pytest.approx(250.0)
    assert quantum * SpeedLoop(2.029, 0.037, 116.0).feedback_gain == pytest.approx(2.155, abs=5e-4)


@pytest.mark.parametrize("length", [1, 4, 8])
def test_a_window_reports_the_mean_speed_over_its_samples(length: int) -> None:
    """At constant speed the mean of the estimates is the speed, in steps of the quantum."""
    encoder, speed = Encoder(), 5.0
    window = SpeedWindow(encoder, length, 0.004)
    estimates = [window.sample(encoder.count(speed * 0.004 * k)) for k in range(2000)]
    steady = np.array(estimates[length:])
    assert steady.mean() == pytest.approx(speed, rel=2e-3)
    quantum = encoder.speed_quantum(length * 0.004)
    assert np.ptp(steady) == pytest.approx(quantum)


def test_before_the_window_is_full_the_first_count_stands_for_the_past() -> None:
    """Starting at any count there is no speed."""
    window = SpeedWindow(Encoder(), 4, 0.004)
    assert [window.sample(100) for _ in range(3)] == [0.0, 0.0, 0.0]
    assert window.sample(101) == pytest.approx(math.radians(1) / 0.016)
