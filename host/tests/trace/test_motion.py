# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import math

import numpy as np
import pytest

from ravenbrick.trace.motion import (
    count_difference_speed,
    fitted_speed,
    path_measures,
    step_measures,
)

COUNT = math.radians(1.0)
TIMES = np.arange(0.0, 2.0, 1e-4)


def _counts(speed: float, time_constant: float) -> np.ndarray:
    """Encoder counts of a first-order response from rest at time 0."""
    angle = speed * (TIMES - time_constant * (1 - np.exp(-TIMES / time_constant)))
    return np.floor(np.degrees(angle) + 0.37)


@pytest.mark.parametrize("time_constant", [0.08, 0.102249, 0.12])
@pytest.mark.parametrize("speed", [4.0, 8.1])
def test_settling_from_encoder_counts_is_that_of_the_true_speed(
    speed: float, time_constant: float
) -> None:
    """A first-order response settles to 2 % after tau ln 50; counts show it within 4 ms."""
    fitted = fitted_speed(TIMES, _counts(speed, time_constant), COUNT)
    measures = step_measures(TIMES, fitted, speed)
    assert measures.settling_time == pytest.approx(time_constant * math.log(50), abs=0.004)
    assert measures.overshoot < 0.004
    assert measures.final_value == pytest.approx(speed, rel=0.001)
    assert abs(measures.steady_state_error) < 0.001


def test_the_plain_difference_knows_only_multiples_of_the_count() -> None:
    """4 ms and 1 degree give steps of 250 degrees/s: no 2 % band can be read from it."""
    _, speed = count_difference_speed(TIMES, _counts(8.1, 0.1), COUNT, 0.004)
    steps = np.degrees(speed) / 250
    assert np.allclose(steps, np.round(steps))
    late = np.degrees(speed[len(speed) // 2 :])
    assert late.max() - late.min() == pytest.approx(250)


def test_the_difference_does_not_depend_on_when_the_recording_begins() -> None:
    """Ten counts in each of 4 ms: the same speed and instants, only later."""
    counts = np.repeat(np.arange(0.0, 100.0, 10.0), 4)
    for begin in (0.0, 2.5):
        times = begin + np.arange(40) * 0.001
        instants, speed = count_difference_speed(
            times.astype(np.float64), counts.astype(np.float64), 0.01, 0.004
        )
        assert instants == pytest.approx(begin + np.arange(1, 10) * 0.004)
        assert speed == pytest.approx(np.full(9, 10 * 0.01 / 0.004))


def test_overshoot_is_measured_against_the_final_value() -> None:
    """A second-order response with damping 0.5 overshoots by exp(-pi / sqrt 3) = 16.3 %."""
    omega, damping = 20.0, 0.5
    damped = omega * math.sqrt(1 - damping**2)
    decay = np.exp(-damping * omega * TIMES)
    speed = 1 - decay * (
        np.cos(damped * TIMES) + damping / math.sqrt(1 - damping**2) * np.sin(damped * TIMES)
    )
    assert step_measures(TIMES, speed, 1.0).overshoot == pytest.approx(0.1630, abs=2e-4)


def test_a_response_that_never_settles_has_no_settling_time() -> None:
    """An oscillation outside of the band until the end is not settled."""
    speed = 1 + 0.1 * np.sin(2 * np.pi * 5 * TIMES)
    assert step_measures(TIMES, speed, 1.0).settling_time is None


def test_a_backward_step_is_measured_like_a_forward_one() -> None:
    """The sign of the speed does not matter."""
    speed = -3.0 * (1 - np.exp(-TIMES / 0.1))
    measures = step_measures(TIMES, speed, -3.0)
    assert measures.settling_time == pytest.approx(0.1 * math.log(50), abs=2e-4)
    assert measures.overshoot < 1e-6


def test_rise_time_is_from_a_tenth_to_nine_tenths() -> None:
    """A first-order response rises in tau ln 9."""
    measures = step_measures(TIMES, 1 - np.exp(-TIMES / 0.1), 1.0)
    assert measures.rise_time == pytest.approx(0.1 * math.log(9), abs=3e-4)


@pytest.mark.parametrize("heading", [0.0, 0.7, -2.0])
def test_lateral_deviation_of_an_arc_is_its_height(heading: float) -> None:
    """An arc of radius 10 m leaves its tangent by 10 (1 - cos 0.2) m after 2 m."""
    turn = np.linspace(0, 0.3, 5001)
    along, across = 10 * np.sin(turn), 10 * (1 - np.cos(turn))
    x = 3 + along * math.cos(heading) - across * math.sin(heading)
    y = 1 + along * math.sin(heading) + across * math.cos(heading)
    measures = path_measures(x, y, heading, 2.0)
    assert measures.lateral_deviation == pytest.approx(10 * (1 - math.cos(0.2)), rel=1e-3)
    assert measures.distance == pytest.approx(3.0, rel=1e-6)


def test_a_path_that_is_too_short_has_no_deviation() -> None:
    """A vehicle that stopped half-way has not driven the distance."""
    x = np.linspace(0, 1.2, 100)
    assert path_measures(x, 0 * x, 0.0, 2.0).lateral_deviation is None
