# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The campaign of hidden motors, for two motors."""

from __future__ import annotations

import pytest

from verification.control import twin
from verification.control.identification import IMAGE, campaign


@pytest.mark.skipif(not IMAGE.is_file(), reason="'ravenbrick build examples/vehicle' builds it")
def test_hidden_parameters_are_found() -> None:
    """Two motors with constants of their own; at most one interval misses."""
    total = campaign(2)
    assert set(total) == {"gain", "time_constant", "friction_voltage"}
    assert sum(total.values()) >= 5


@pytest.mark.skipif(not IMAGE.is_file(), reason="'ravenbrick build examples/vehicle' builds it")
def test_the_band_covers_the_unseen_manoeuvre_of_hidden_robots() -> None:
    """One robot of the fitted form, one with friction and a bridge of another; both tightly."""
    (first, narrow), (second, wider) = twin.campaign(2)
    assert first
    assert second
    assert 1 < narrow < wider < 10


def test_no_two_hidden_robots_are_alike() -> None:
    """Half of them have what the fitted model lacks."""
    usual = dict.fromkeys(("resistance", "torque_constant", "electric_constant",
                           "viscous_friction", "inertia"), 1.0)  # fmt: skip
    robots = [twin.hidden_robot(seed, usual) for seed in range(twin.ROBOTS)]
    assert len({robot["inertia"] for robot in robots}) == twin.ROBOTS
    assert sum("gear_friction" in robot for robot in robots) == twin.ROBOTS // 2
