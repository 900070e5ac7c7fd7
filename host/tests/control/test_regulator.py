# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""State feedback, observers and LQG against closed forms and other solvers."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest
from scipy.linalg import solve_continuous_are, solve_discrete_are

from ravenbrick.control import (
    dlqr,
    kalman,
    lqg,
    lqr,
    observer_by_poles,
    with_integrators,
)
from ravenbrick.errors import DesignError


def random_plant(seed: int, sample_time: float | None = None) -> control.StateSpace:
    """Four states, two inputs, two outputs, not stable."""
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(4, 4))
    b, c = random.normal(size=(4, 2)), random.normal(size=(2, 4))
    if sample_time is None:
        return control.ss(matrix, b, c, np.zeros((2, 2)))
    return control.ss(matrix, b, c, np.zeros((2, 2)), sample_time)


def test_the_scalar_regulator_has_its_closed_form() -> None:
    """x' = a x + u with weights q and 1: k = a + sqrt(a^2 + q)."""
    for a, q in ((0.5, 3.0), (-2.0, 1.0)):
        found = lqr(control.ss([[a]], [[1.0]], [[1.0]], 0), [[q]], [[1.0]])
        assert found.gain[0, 0] == pytest.approx(a + math.sqrt(a * a + q), rel=1e-12)
        assert found.poles[0].real == pytest.approx(-math.sqrt(a * a + q), rel=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_both_regulators_agree_with_the_riccati_solvers(seed: int) -> None:
    """Random plants against scipy's solutions of the Riccati equations."""
    weights = np.diag([1.0, 2.0, 0.5, 3.0]), np.diag([1.0, 0.1])
    plant = random_plant(seed)
    solution = solve_continuous_are(plant.A, plant.B, *weights)
    expected = np.linalg.solve(weights[1], plant.B.T @ solution)
    assert np.allclose(lqr(plant, *weights).gain, expected, rtol=1e-7, atol=1e-9)
    plant = random_plant(seed, 0.1)
    solution = solve_discrete_are(plant.A, plant.B, *weights)
    left = weights[1] + plant.B.T @ solution @ plant.B
    expected = np.linalg.solve(left, plant.B.T @ solution @ plant.A)
    assert np.allclose(dlqr(plant, *weights).gain, expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("sample_time", [None, 0.1])
def test_the_kalman_filter_is_the_dual_regulator(sample_time: float | None) -> None:
    """The same gains as a regulator of the transposed plant."""
    plant = random_plant(3, sample_time)
    process, measured = np.diag([1.0, 2.0, 0.5, 3.0]), np.diag([0.2, 0.7])
    found = kalman(plant, process, measured)
    dt = 0 if sample_time is None else sample_time
    dual = control.ss(plant.A.T, plant.C.T, np.eye(4), np.zeros((4, 2)), dt)
    solve = lqr if sample_time is None else dlqr
    assert np.allclose(found.gain, solve(dual, process, measured).gain.T, rtol=1e-8)


def test_the_filter_s_error_is_as_small_as_the_riccati_equation_says() -> None:
    """Simulated noise: variance of the prediction error within 5 %."""
    plant = control.ss([[1.0, 0.1], [0.0, 0.95]], [[0.0], [0.1]], [[1.0, 0.0]], 0, 0.1)
    process, measured = np.diag([1e-4, 1e-2]), np.array([[0.05]])
    gain = kalman(plant, process, measured).gain
    covariance = solve_discrete_are(plant.A.T, plant.C.T, process, measured)
    random = np.random.default_rng(6)
    error, samples = np.zeros(2), []
    for _ in range(60_000):
        samples.append(error)
        noise = random.normal(size=2) * np.sqrt(np.diag(process))
        error = (plant.A - gain @ plant.C) @ error + noise
        error = error - gain[:, 0] * random.normal() * math.sqrt(0.05)
    assert np.cov(np.array(samples).T)[0, 0] == pytest.approx(covariance[0, 0], rel=0.05)


@pytest.mark.parametrize("sample_time", [None, 0.1])
def test_the_lqg_loop_has_the_poles_of_both_designs(sample_time: float | None) -> None:
    """Separation principle, with the controller connected as it is."""
    plant = random_plant(5, sample_time)
    solve = lqr if sample_time is None else dlqr
    feedback = solve(plant, np.eye(4), np.eye(2))
    observer = kalman(plant, np.eye(4), np.eye(2))
    loop = control.feedback(plant, lqg(plant, feedback, observer), sign=1)
    expected = np.concatenate([feedback.poles, observer.poles])
    assert np.allclose(np.sort_complex(loop.poles()), np.sort_complex(expected), atol=1e-6)


def test_an_observer_has_the_poles_asked_for() -> None:
    """Complex and real ones."""
    plant = random_plant(2, 0.1)
    poles = [0.1, 0.2, 0.3 + 0.1j, 0.3 - 0.1j]
    found = observer_by_poles(plant, poles)
    assert np.allclose(np.sort_complex(found.poles), np.sort_complex(np.array(poles)), atol=1e-6)


def test_integrators_follow_the_chosen_states() -> None:
    """One row sums two states; the new state is its integral."""
    plant = with_integrators(random_plant(1), [[1.0, 0.0, 2.0, 0.0]])
    assert plant.nstates == 5
    assert plant.A[4].tolist() == [1.0, 0.0, 2.0, 0.0, 0.0]


def test_wrong_weights_and_plants_are_named() -> None:
    """Shape, symmetry, sign, kind of time, and what cannot be observed or controlled."""
    plant = random_plant(1)
    for states, inputs, message in (
        (np.eye(3), np.eye(2), r"state weights must have shape \(4, 4\)"),
        (np.triu(np.ones((4, 4))), np.eye(2), "state weights must be symmetric"),
        (np.eye(4), np.diag([1.0, 0.0]), "input weights must be positive"),
        (-np.eye(4), np.eye(2), "state weights must be positive"),
    ):
        with pytest.raises(DesignError, match=message):
            lqr(plant, states, inputs)
    with pytest.raises(DesignError, match="must be discrete; for the other kind use lqr"):
        dlqr(plant, np.eye(4), np.eye(2))
    stuck = control.ss(np.diag([1.0, -1.0]), [[0.0], [1.0]], [[0.0, 1.0]], 0)
    with pytest.raises(DesignError, match=r"controllable|not stable"):
        lqr(stuck, np.eye(2), [[1.0]])
    with pytest.raises(DesignError, match="only 1 of the plant's 2 states are observable"):
        observer_by_poles(stuck, [-1.0, -2.0])
