# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Discretisation methods side by side, pre-warping, and matched where others divide by zero."""

from __future__ import annotations

import cmath
import math

import control
import numpy as np
import pytest

from ravenbrick.control import DiscretisationMethod, compare_discretisations, discretise
from ravenbrick.errors import DesignError

LAG = control.tf([2.0], [0.1, 1.0])
SAMPLE_TIME = 0.01


def response(system: control.TransferFunction, frequency: float) -> complex:
    """Of a discrete system at `frequency` (rad/s)."""
    return complex(system(cmath.exp(1j * frequency * SAMPLE_TIME)))


@pytest.mark.parametrize("frequency", [1.0, 20.0, 150.0, 300.0])
def test_pre_warped_tustin_agrees_exactly_at_its_frequency(frequency: float) -> None:
    """And plain Tustin does not."""
    warped = discretise(LAG, SAMPLE_TIME, DiscretisationMethod.TUSTIN, exact_at=frequency)
    plain = discretise(LAG, SAMPLE_TIME, DiscretisationMethod.TUSTIN)
    wanted = complex(LAG(1j * frequency))
    assert response(warped, frequency) == pytest.approx(wanted, rel=1e-12)
    assert abs(response(plain, frequency) / wanted - 1) > 1e-7


@pytest.mark.parametrize(
    ("numerator", "denominator"),
    [
        ([0.361074, 9.758758], [1.0, 0.0]),
        ([1.0], [1.0, 0.0, 0.0]),
        ([1.0, 0.0], [0.1, 1.0]),
        ([3.0, 1.0, 0.0], [1.0, 2.0, 5.0, 0.0]),
        ([2.0], [1.0, 0.4, 4.0]),
    ],
)
def test_matched_agrees_at_low_frequency_with_integrators_and_differentiators(
    numerator: list[float], denominator: list[float]
) -> None:
    """Finite coefficients, poles by z = exp(s Ts), and the same response as s goes to 0."""
    system = control.tf(numerator, denominator)
    found = discretise(system, SAMPLE_TIME, DiscretisationMethod.MATCHED)
    assert np.isfinite(found.num[0][0]).all()
    expected = np.exp(system.poles() * SAMPLE_TIME)
    assert np.allclose(np.sort_complex(found.poles()), np.sort_complex(expected), atol=1e-6)
    frequency = 1e-3
    assert abs(response(found, frequency) / complex(system(1j * frequency)) - 1) < 1e-4


def test_all_methods_are_compared_at_one_frequency() -> None:
    """Near the bandwidth Tustin is closer than Euler, and the hold costs half a sample of phase."""
    rows = {row.method: row for row in compare_discretisations(LAG, SAMPLE_TIME, 10.0)}
    assert set(rows) == set(DiscretisationMethod)
    errors = {method: abs(row.magnitude_ratio - 1) for method, row in rows.items()}
    assert errors[DiscretisationMethod.TUSTIN] < errors[DiscretisationMethod.FORWARD_EULER] / 5
    hold = rows[DiscretisationMethod.ZERO_ORDER_HOLD].phase_difference
    assert hold == pytest.approx(-10.0 * SAMPLE_TIME / 2, rel=0.02)


def test_a_first_order_hold_is_exact_for_a_ramp_and_an_impulse_is_sampled() -> None:
    """Closed forms of 2 / (0.1 s + 1): the ramp's response, and Ts times that of an impulse."""
    time = SAMPLE_TIME * np.arange(40)
    hold = discretise(LAG, SAMPLE_TIME, DiscretisationMethod.FIRST_ORDER_HOLD)
    ramp = control.forced_response(hold, time, time).outputs
    np.testing.assert_allclose(ramp, 2 * (time - 0.1 * (1 - np.exp(-time / 0.1))), atol=1e-12)
    sampled = discretise(LAG, SAMPLE_TIME, DiscretisationMethod.IMPULSE_INVARIANT)
    found = control.forced_response(sampled, time, np.eye(1, 40)[0]).outputs
    np.testing.assert_allclose(found, SAMPLE_TIME * 20 * np.exp(-time / 0.1), atol=1e-12)


def test_of_a_pi_the_first_order_hold_is_the_trapezoidal_rule_and_impulses_are_refused() -> None:
    """A ramp is integrated exactly by trapezia; the impulse response of Kp has no samples."""
    pi = control.tf([0.361074, 9.758758], [1.0, 0.0])
    hold = discretise(pi, SAMPLE_TIME, DiscretisationMethod.FIRST_ORDER_HOLD)
    tustin = discretise(pi, SAMPLE_TIME, DiscretisationMethod.TUSTIN)
    np.testing.assert_allclose(hold.num[0][0], tustin.num[0][0], atol=1e-12)
    with pytest.raises(DesignError, match=r"IMPULSE_INVARIANT .* more poles than zeros"):
        discretise(pi, SAMPLE_TIME, DiscretisationMethod.IMPULSE_INVARIANT)
    with pytest.raises(DesignError, match="at least as many poles as zeros"):
        discretise(control.tf([1.0, 0.0], [1.0]), SAMPLE_TIME, DiscretisationMethod.TUSTIN)


def test_pre_warping_needs_tustin_and_a_frequency_below_half_the_rate() -> None:
    """The limit is in the message."""
    with pytest.raises(DesignError, match="only Tustin's method"):
        discretise(LAG, SAMPLE_TIME, DiscretisationMethod.MATCHED, exact_at=1.0)
    with pytest.raises(DesignError, match=f"{math.pi / SAMPLE_TIME:.6g} rad/s"):
        discretise(LAG, SAMPLE_TIME, DiscretisationMethod.TUSTIN, exact_at=400.0)
