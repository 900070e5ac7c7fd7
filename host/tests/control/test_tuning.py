# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""PI gains from the specification of 400 ms, against numbers computed independently."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ravenbrick.control import (
    DiscretisationMethod,
    PiGains,
    discretise,
    margins,
    pi_by_damping,
    pi_by_lambda,
    pi_direct,
    pi_family,
    step_metrics,
)
from ravenbrick.errors import DesignError
from ravenbrick.model import IntegrationMethod, SpeedLoop

LOOP = SpeedLoop(2.029, 0.037, 116.0)
SAMPLE_TIME = 0.004


def test_the_closed_form_meets_the_specification_exactly() -> None:
    """Kp = 0.361074, Ki = 9.758758 settle in 0.4 s without overshoot, at 90 degrees margin."""
    gains = pi_by_lambda(LOOP, 0.4)
    assert gains.proportional == pytest.approx(0.361074, abs=1e-6)
    assert gains.integral == pytest.approx(9.758758, abs=1e-5)
    metrics = step_metrics(LOOP.closed_loop(gains.controller()))
    assert metrics.settling_time == pytest.approx(0.4, abs=1e-9)
    assert metrics.overshoot == 0.0
    found = margins(gains.controller() * LOOP.plant())
    assert found.phase_margin_deg == pytest.approx(90.0, abs=0.05)
    assert found.crossover == pytest.approx(9.780, abs=1e-3)


@pytest.mark.parametrize(
    ("damping", "proportional", "integral", "overshoot", "phase_margin_deg"),
    [
        (0.9, -0.16695, 5.77125, 0.0016, 68.6),
        (1.0, 0.05794, 7.54770, 0.0, 78.1),
        (1.1, 0.28771, 9.24832, 0.0, 87.2),
        (1.2, 0.51780, 10.80195, 0.0, 95.8),
    ],
)
def test_a_settling_time_leaves_a_family_of_gains(
    damping: float, proportional: float, integral: float, overshoot: float, phase_margin_deg: float
) -> None:
    """Each damping ratio has its gains, all with exactly 400 ms.

    The expected gains come from settling times read off a grid, hence the tolerance.
    """
    gains = pi_by_damping(LOOP, damping, 0.4)
    assert gains.proportional == pytest.approx(proportional, abs=1e-4)
    assert gains.integral == pytest.approx(integral, rel=1.5e-4)
    metrics = step_metrics(LOOP.closed_loop(gains.controller()))
    assert metrics.settling_time == pytest.approx(0.4, abs=1e-6)
    assert metrics.overshoot == pytest.approx(overshoot, abs=1e-4)
    found = margins(gains.controller() * LOOP.plant())
    assert found.phase_margin_deg == pytest.approx(phase_margin_deg, abs=0.05)


def test_the_family_is_listed_by_damping_ratio() -> None:
    """The same gains as one by one."""
    assert pi_family(LOOP, 0.4, (1.1,)) == {1.1: pi_by_damping(LOOP, 1.1, 0.4)}


def test_a_settling_time_that_cannot_be_is_refused() -> None:
    """Zero seconds are refused with the value."""
    with pytest.raises(DesignError, match="settling time must be > 0"):
        pi_by_lambda(LOOP, 0.0)


@pytest.mark.parametrize(
    ("method", "b0", "b1"),
    [
        (IntegrationMethod.FORWARD_EULER, 0.36107406, -0.32203903),
        (IntegrationMethod.TUSTIN, 0.38059158, -0.34155654),
        (IntegrationMethod.BACKWARD_EULER, 0.40010909, -0.36107406),
    ],
)
def test_each_integrator_has_its_coefficients(
    method: IntegrationMethod, b0: float, b1: float
) -> None:
    """C(z) = (b0 z + b1) / (z - 1), the same by python-control's substitution of s."""
    gains = pi_by_lambda(LOOP, 0.4)
    found = gains.discretised(method, SAMPLE_TIME).coefficients
    assert found == pytest.approx((b0, b1), abs=2e-7)
    by_library = discretise(gains.controller(), SAMPLE_TIME, DiscretisationMethod[method.name])
    np.testing.assert_allclose(by_library.num[0][0], found, atol=1e-12)


def test_a_zero_order_hold_of_a_pi_is_forward_euler() -> None:
    """Both discretisations have the same numerator."""
    controller = pi_by_lambda(LOOP, 0.4).controller()
    hold = discretise(controller, SAMPLE_TIME, DiscretisationMethod.ZERO_ORDER_HOLD)
    euler = discretise(controller, SAMPLE_TIME, DiscretisationMethod.FORWARD_EULER)
    np.testing.assert_allclose(hold.num[0][0], euler.num[0][0], atol=1e-12)


def test_the_matched_pi_is_finite_and_maps_its_zero() -> None:
    """Zero at exp(-Ki/Kp Ts), pole at 1, the same integral gain at low frequency."""
    gains = PiGains(0.361074, 9.758758)
    found = discretise(gains.controller(), SAMPLE_TIME, DiscretisationMethod.MATCHED)
    zero = math.exp(-gains.integral / gains.proportional * SAMPLE_TIME)
    assert found.zeros().real == pytest.approx([zero], abs=1e-12)
    assert found.poles().real == pytest.approx([1.0], abs=1e-12)
    assert float(np.sum(found.num[0][0])) == pytest.approx(gains.integral * SAMPLE_TIME)


@pytest.mark.parametrize(
    ("method", "proportional"),
    [(IntegrationMethod.FORWARD_EULER, 0.373588), (IntegrationMethod.TUSTIN, 0.354447)],
)
def test_the_direct_design_has_the_known_gains(
    method: IntegrationMethod, proportional: float
) -> None:
    """Ki = 9.570341 in every form, Ki Ts = 0.0382814, Kp by form."""
    found = pi_direct(LOOP, 0.4, SAMPLE_TIME, method)
    assert found.proportional == pytest.approx(proportional, abs=1e-6)
    assert found.gains.integral == pytest.approx(9.570341, abs=5e-6)
    assert found.integral_step == pytest.approx(0.0382814, abs=1e-7)
