# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step metrics are exact: roots, not samples of a grid."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest

from ravenbrick.control import margins, step_metrics
from ravenbrick.errors import DesignError


def test_a_first_order_lag_settles_at_ln_50_time_constants() -> None:
    """Settling of 1 / (T s + 1) into 2 % is T ln 50."""
    metrics = step_metrics(control.tf([3.0], [0.25, 1.0]))
    assert metrics.settling_time == pytest.approx(0.25 * math.log(50), abs=1e-9)
    assert metrics.overshoot == 0.0
    assert metrics.final_value == pytest.approx(3.0)


@pytest.mark.parametrize("damping", [0.1, 0.3, 0.5, 0.7])
def test_overshoot_of_two_conjugate_poles_has_its_closed_form(damping: float) -> None:
    """exp(-pi zeta / sqrt(1 - zeta^2)), to 1e-9."""
    metrics = step_metrics(control.tf([4.0], [1.0, 4.0 * damping, 4.0]))
    wanted = math.exp(-math.pi * damping / math.sqrt(1 - damping**2))
    assert metrics.overshoot == pytest.approx(wanted, abs=1e-9)


def test_settling_of_a_double_pole_solves_its_own_equation() -> None:
    """(1 + t) exp(-t) = 0.02 at the settling time of 1 / (s + 1)^2."""
    time = step_metrics(control.tf([1.0], [1.0, 2.0, 1.0])).settling_time
    assert (1 + time) * math.exp(-time) == pytest.approx(0.02, abs=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_settling_agrees_with_a_fine_grid(seed: int) -> None:
    """For random stable systems of order 4 the last crossing lies in the grid's interval."""
    generator = np.random.default_rng(seed)
    poles = np.concatenate(
        [-generator.uniform(1, 20, 2), *[[p, p.conjugate()] for p in [-3 + 9j * (seed + 1) / 4]]]
    )
    system = control.tf([float(np.real(np.prod(poles)))], np.real(np.poly(poles)))
    exact = step_metrics(system)
    time = np.linspace(0, exact.settling_time * 2.1, 40001)
    output = control.step_response(system, time).outputs
    last = time[np.flatnonzero(np.abs(output - 1) > 0.02)[-1]]
    assert 0 <= exact.settling_time - last <= time[1]
    assert exact.overshoot == pytest.approx(max(output.max() - 1, 0), abs=1e-6)


def test_a_plain_gain_is_settled_at_once() -> None:
    """Continuous and sampled."""
    for system in (control.tf([3.0], [1.0]), control.tf([3.0], [1.0], 0.01)):
        found = step_metrics(system)
        assert (found.settling_time, found.overshoot, found.final_value) == (0.0, 0.0, 3.0)


@pytest.mark.parametrize("pole", [-0.5, -0.9])
def test_the_overshoot_of_samples_is_that_of_the_first_one(pole: float) -> None:
    """1 - pole^k with a pole below 0: the first sample after the step is 1 - pole."""
    found = step_metrics(control.tf([1 - pole], [1.0, -pole], 0.01))
    assert found.overshoot == pytest.approx(-pole, rel=1e-9)


def test_an_unstable_system_is_refused_with_its_pole() -> None:
    """The message names the pole."""
    with pytest.raises(DesignError, match="not stable"):
        step_metrics(control.tf([1.0], [1.0, -0.5]))


def test_a_response_that_ends_at_zero_has_no_band() -> None:
    """A high-pass is refused."""
    with pytest.raises(DesignError, match="ends at 0"):
        step_metrics(control.tf([1.0, 0.0], [1.0, 1.0]))


def test_discrete_margins_count_half_the_sampling_frequency() -> None:
    """k / (z - 1) is real and -k/2 there, so its gain margin is 2 / k."""
    found = margins(control.tf([0.4], [1.0, -1.0], 0.01))
    assert found.gain_margin == pytest.approx(5.0)
    assert found.crossover == pytest.approx(2 / 0.01 * math.asin(0.2), rel=1e-9)
    assert found.phase_margin_deg == pytest.approx(90 - math.degrees(math.asin(0.2)), abs=1e-6)


def test_a_gain_margin_at_zero_frequency_counts() -> None:
    """An unstable motor, held at its input: below half the gain the loop falls over."""
    plant = control.sample_system(control.tf([2.0], [1.0, -1.0]), 0.04, "zoh")
    found = margins(plant)
    assert found.lowest_gain == pytest.approx(0.5)
    assert found.gain_margin == pytest.approx(0.5) and found.phase_crossover == 0.0
    half_rate = float(np.real(plant(-1.0)))
    assert found.highest_gain == pytest.approx(-1 / half_rate)


def test_the_gain_margin_is_the_nearest_in_decibels() -> None:
    """Of 1/20 and 3, three is nearer although it is larger."""
    triple = control.tf([10.0, 20.0, 10.0], [1.0, 0.0, 0.0, 0.0])
    lag = control.tf([1.0], [0.05, 1.0]) ** 3
    loop = control.sample_system(triple * lag, 0.002, "zoh")
    found = margins(loop)
    assert 0 < found.lowest_gain < 0.1 and 1 < found.highest_gain < 10
    assert found.gain_margin == found.highest_gain


@pytest.mark.parametrize("pole", [0.5, 0.9, 0.99])
def test_a_discrete_step_is_measured_at_its_samples(pole: float) -> None:
    """1 - pole^k: the first sample with an error of at most 2 %."""
    found = step_metrics(control.tf([1 - pole], [1.0, -pole], 0.01))
    wanted = math.ceil(math.log(0.02) / math.log(pole)) * 0.01
    assert found.settling_time == pytest.approx(wanted)
    assert found.overshoot == 0 and found.final_value == pytest.approx(1.0)


def test_a_system_with_several_channels_is_refused() -> None:
    """It does not say which one is meant."""
    with pytest.raises(DesignError, match="2 inputs and 1 outputs; choose one channel"):
        step_metrics(control.ss([[-1.0]], [[1.0, 1.0]], [[1.0]], [[0.0, 0.0]]))
