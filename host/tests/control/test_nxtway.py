# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The published regulator of the balancing robot NXTway-GS, to all printed digits."""

from __future__ import annotations

import control
import numpy as np
import pytest

from ravenbrick.control import StateFeedback, lqr, with_integrators
from ravenbrick.model import NXTWAY_GS

# Wheel angle, pitch, their rates, integral of the wheel angle.
PUBLISHED = [-0.83508, -34.18958, -1.29354, -2.81409, -0.44721]
PUBLISHED_SCALED = [-0.83508, -34.18958, -1.09951, -2.81409]
PRINTED = [-0.8351, -34.1896, -1.2935, -2.8141, -0.4472]


def published_design() -> tuple[control.StateSpace, StateFeedback]:
    """Weights of the original, with the integral of the wheel angle as fifth state."""
    plant = with_integrators(NXTWAY_GS.state_space(), [[1.0, 0.0, 0.0, 0.0]])
    return plant, lqr(plant, [1.0, 6e5, 1.0, 1.0, 4e2], [1e3, 1e3])


def test_the_published_gains_come_out_to_all_digits() -> None:
    """Five digits after the point of one source and four of the other, both motors alike."""
    gain = published_design()[1].gain
    for row in gain:
        assert [round(value, 5) for value in row] == PUBLISHED
        assert [round(value, 4) for value in row] == PRINTED
    assert [round(float(v), 5) for v in gain[0, :4] * [1, 1, 0.85, 1]] == PUBLISHED_SCALED


def test_the_closed_loop_with_the_scaled_gain_has_the_published_poles() -> None:
    """-306.2, -11.91, -1.00, -1.09 +- 1.27j rad/s."""
    plant, feedback = published_design()
    gain = feedback.gain * [1.0, 1.0, 0.85, 1.0, 1.0]
    poles = np.sort_complex(np.linalg.eigvals(plant.A - plant.B @ gain))
    assert np.allclose(poles, [-306.17, -11.91, -1.09 - 1.27j, -1.09 + 1.27j, -1.0], atol=6e-3)


@pytest.mark.parametrize("delay_samples", [0, 1, 2])
def test_the_gains_balance_at_4_ms_with_up_to_two_samples_of_delay(delay_samples: int) -> None:
    """All poles inside the unit circle, the slowest at 0.996."""
    plant, feedback = published_design()
    gain = feedback.gain * [1.0, 1.0, 0.85, 1.0, 1.0]
    sampled = control.sample_system(plant, 0.004, "zoh")
    order = plant.nstates
    size = order + 2 * delay_samples
    matrix = np.zeros((size, size))
    matrix[:order, :order] = sampled.A
    if delay_samples == 0:
        matrix = sampled.A - sampled.B @ gain
    else:
        matrix[:order, -2:] = sampled.B
        matrix[order : order + 2, :order] = -gain
        matrix[order + 2 :, order:-2] = np.eye(2 * delay_samples - 2)
    assert np.abs(np.linalg.eigvals(matrix)).max() == pytest.approx(0.996, abs=5e-4)
