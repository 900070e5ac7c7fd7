# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Lead, lag, feed-forward and Smith predictor, judged by python-control."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest

from ravenbrick.control import feed_forward, lag, lead, smith_predictor
from ravenbrick.errors import DesignError

SERVO = control.tf([4.0], [1.0, 2.0, 0.0])


@pytest.mark.parametrize("delay", [0.0, 0.02])
def test_a_lead_gives_the_margin_at_the_crossover(delay: float) -> None:
    """As `control.margin` finds it, and the delay's phase once more."""
    found = lead(SERVO, 50, 5.0, delay)
    _, phase_margin, _, crossover = control.margin(found * SERVO)
    assert crossover == pytest.approx(5.0)
    assert phase_margin - math.degrees(5.0 * delay) == pytest.approx(50)


def test_a_lead_that_cannot_be_had_is_refused() -> None:
    """With the degrees that are missing."""
    with pytest.raises(DesignError, match=r"a lead of -\d"):
        lead(SERVO, 20, 0.5)
    with pytest.raises(DesignError, match=r"a lead of 1\d\d"):
        lead(SERVO, 120, 20.0)


def test_a_lag_raises_the_gain_at_low_frequencies_only() -> None:
    """Ten times at 0; a tenth of a decibel and 6 degrees at ten times the corner."""
    found = lag(10, 0.5)
    assert control.dcgain(found) == pytest.approx(10)
    value = complex(found(5j))
    assert abs(value) == pytest.approx(1, abs=0.01)
    assert -6 < math.degrees(np.angle(value)) < 0
    with pytest.raises(DesignError, match="ratio > 1"):
        lag(0.5, 1.0)


def test_behind_a_feed_forward_the_plant_is_so_many_lags() -> None:
    """Two poles more than zeros: 1 / (1 + s T)**2."""
    plant = control.tf([2.0, 6.0], [1.0, 4.0, 5.0, 1.0])
    path = feed_forward(plant, 0.1) * plant
    for frequency in (0.1, 3.0, 50.0):
        assert complex(path(1j * frequency)) == pytest.approx((1 + 0.1j * frequency) ** -2)
    with pytest.raises(DesignError, match="a zero at 3"):
        feed_forward(control.tf([1.0, -3.0], [1.0, 2.0, 1.0]), 0.1)


def test_a_smith_predictor_shifts_the_loop_without_delay() -> None:
    """Its step is the other's, five samples later; without it the loop would not be stable."""
    motor, delay, sample_time = control.tf([2.0], [0.037, 1.0]), 0.1, 0.02
    own = control.tf([0.9, -0.5], [1.0, -1.0], sample_time)
    sampled = control.sample_system(control.ss(motor), sample_time, "zoh")
    late = control.tf([1.0], [1.0, 0, 0, 0, 0, 0], sample_time)
    time = np.arange(60) * sample_time
    ideal = control.step_response(control.feedback(own * sampled, 1), time).outputs
    predicted = control.feedback(smith_predictor(own, motor, delay) * sampled * late, 1)
    found = control.step_response(predicted, time).outputs
    assert found[5:] == pytest.approx(ideal[:-5], abs=1e-9)
    assert found[:5] == pytest.approx(0)
    assert np.abs(control.feedback(own * sampled * late, 1).poles()).max() > 1


@pytest.mark.parametrize(
    ("plant", "delay", "sentence"),
    [
        (control.tf([1.0], [1.0, 1.0]), 0.03, "whole samples of 0.02 s"),
        (control.tf([1.0], [1.0, -1.0]), 0.04, "not stable"),
    ],
)
def test_what_a_smith_predictor_cannot_do_is_refused(
    plant: control.TransferFunction, delay: float, sentence: str
) -> None:
    """Parts of samples, and predictions that run away."""
    with pytest.raises(DesignError, match=sentence):
        smith_predictor(control.tf([0.5], [1.0, -1.0], 0.02), plant, delay)
