# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Worst-case peak gains against closed forms and against the inputs that reach them."""

from __future__ import annotations

import control
import numpy as np
import pytest

from ravenbrick.control import peak_gain
from ravenbrick.errors import DesignError


@pytest.mark.parametrize("pole", [0.0, 0.5, -0.9, 0.999])
def test_a_first_order_system_has_the_closed_form(pole: float) -> None:
    """Sum of b |pole|^k."""
    system = control.ss([[pole]], [[0.3]], [[2.0]], [[0.1]], 0.01)
    assert peak_gain(system)[0, 0] == pytest.approx(0.1 + 0.6 / (1 - abs(pole)), rel=1e-8)


def test_the_peak_gain_is_reached_but_not_exceeded() -> None:
    """Inputs of +-1 with the signs of the reversed impulse response reach it in random systems."""
    random = np.random.default_rng(8)
    for _ in range(5):
        matrix = random.normal(size=(4, 4))
        matrix *= 0.95 / np.abs(np.linalg.eigvals(matrix)).max()
        b, c = random.normal(size=(4, 1)), random.normal(size=(1, 4))
        gain = peak_gain(control.ss(matrix, b, c, 0, 1.0))[0, 0]
        responses = [float((c @ np.linalg.matrix_power(matrix, k) @ b)[0, 0]) for k in range(900)]
        state = np.zeros((4, 1))
        for response in reversed(responses):
            state = matrix @ state + b * np.sign(response)
        reached = float((c @ state)[0, 0])
        assert reached <= gain
        assert reached == pytest.approx(gain, rel=1e-6)


def test_an_integrator_has_no_peak_gain() -> None:
    """The message gives the distance of its pole."""
    with pytest.raises(DesignError, match=r"distance 1\.000000"):
        peak_gain(control.ss([[1.0]], [[1.0]], [[1.0]], 0, 1.0))
