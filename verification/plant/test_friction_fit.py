# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The catalogue's fitted motor is the optimum, and the plant computes what the fit computes."""

from __future__ import annotations

import json

import pytest

from verification.plant.friction_fit import RPM, SET_A, catalogue, cost, optimum, steady
from verification.plant.points import RESULTS


def test_the_catalogue_has_the_optimum_rounded() -> None:
    """From other constants least squares come back to it, and to no smaller sum."""
    own = catalogue()
    best = optimum(own * [1.1, 1.0, 0.95, 0.95, 1.1, 1.01, 0.99, 1.0])
    assert cost(own) < 1.01 * cost(best)
    assert own[[0, 2, 3, 4, 5, 6, 7]] == pytest.approx(best[[0, 2, 3, 4, 5, 6, 7]], rel=0.02)


@pytest.mark.parametrize(("condition", "load"), [("9 V, no load", 0.0), ("9 V, 0.167 N m", 0.167)])
def test_the_plant_turns_as_the_balance_of_torques_says(condition: str, load: float) -> None:
    """Speed and current of set A and of the fitted motor, which the emulator's plant simulated."""
    own = catalogue()
    for point in json.loads(RESULTS.read_text())["points"]:
        if point["condition"] != condition:
            continue
        values = {one["set"]: one["value"] for one in point["measured"]}
        for name, winding in (("A", SET_A), ("fitted", tuple(own[5:]))):
            speed, current = steady(own, winding, 9.0, load)
            wanted = speed / RPM if "rpm" in point["quantity"] else current
            assert values[name] == pytest.approx(wanted, rel=1e-4)
