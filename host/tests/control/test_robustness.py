# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Tolerances: the paper's loop against independently computed figures, and known extremes."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from ravenbrick.control import (
    SampledLoop,
    Tolerance,
    monte_carlo,
    pi_by_lambda,
    worst_case,
)
from ravenbrick.errors import DesignError
from ravenbrick.model import IntegrationMethod, SpeedLoop

NOMINAL = SpeedLoop(2.029, 0.037, 116.0)
TOLERANCES = (
    Tolerance.relative("gain", NOMINAL.gain, 0.2),
    Tolerance.relative("time_constant", NOMINAL.time_constant, 0.2),
)


def loop_figures(parameters: Mapping[str, float]) -> dict[str, float]:
    """Settling time (at the samples) and overshoot with the gains of the nominal loop."""
    pi = pi_by_lambda(NOMINAL, 0.4).discretised(IntegrationMethod.FORWARD_EULER, 0.004)
    loop = SpeedLoop(parameters["gain"], parameters["time_constant"], 116.0)
    metrics = SampledLoop(loop, pi.controller()).step_metrics()
    return {
        "settling_time": metrics.settling_time,
        "overshoot": metrics.overshoot,
    }


def test_twenty_percent_in_the_plant_gives_the_published_spread() -> None:
    """Settling from 0.286 to 0.510 s, overshoot below 0.001 %."""
    done: list[tuple[int, int]] = []
    found = worst_case(loop_figures, TOLERANCES, lambda *step: done.append(step))
    least, largest = found["settling_time"]
    assert least.value == pytest.approx(0.286, abs=0.004)
    assert largest.value == pytest.approx(0.510, abs=0.004)
    assert found["overshoot"][1].value < 1e-5
    assert done[-1] == (4, 4)


def test_random_samples_lie_inside_the_worst_case_and_repeat() -> None:
    """20 samples, the same for the same seed; progress is told for each."""
    done: list[tuple[int, int]] = []
    first = monte_carlo(loop_figures, TOLERANCES, 20, 1, lambda *step: done.append(step))
    second = monte_carlo(loop_figures, TOLERANCES, 20, 1)
    times = first.figures["settling_time"]
    assert (times == second.figures["settling_time"]).all()
    assert 0.28 < times.min() < times.max() < 0.515
    assert first.percentile("settling_time", 0.5) == pytest.approx(0.385, abs=0.03)
    assert done == [(index, 20) for index in range(1, 21)]
    assert first.failures == ()


def test_an_extreme_inside_the_box_is_found() -> None:
    """A hill whose top lies between the corners."""

    def hill(point: Mapping[str, float]) -> dict[str, float]:
        return {"height": 3.0 - (point["x"] - 0.3) ** 2 - 2 * (point["y"] + 0.4) ** 2}

    found = worst_case(hill, (Tolerance("x", -1.0, 1.0), Tolerance("y", -1.0, 1.0)))
    least, largest = found["height"]
    assert least.value == pytest.approx(3.0 - 1.69 - 2 * 1.96)
    assert largest.value == pytest.approx(3.0, abs=0.01)
    assert largest.parameters["x"] == pytest.approx(0.3, abs=0.1)


def test_unstable_samples_are_counted_with_their_reason() -> None:
    """A third of the samples has no figures."""

    def fragile(point: Mapping[str, float]) -> dict[str, float]:
        if point["x"] > 2.0:
            raise DesignError("the loop is not stable")
        return {"y": point["x"]}

    found = monte_carlo(fragile, [Tolerance("x", 0.0, 3.0)], 300, 2)
    assert len(found.failures) == pytest.approx(100, abs=30)
    assert len(found.failures) + len(found.figures["y"]) == 300
    assert found.failures[0][1] == "the loop is not stable"
    with pytest.raises(DesignError, match="not stable"):
        worst_case(fragile, [Tolerance("x", 0.0, 3.0)])


def test_tolerances_are_checked() -> None:
    """Order of the ends and number of corners."""
    with pytest.raises(DesignError, match=r"low 2\.0 is above 1\.0"):
        Tolerance("x", 2.0, 1.0)
    with pytest.raises(DesignError, match="too many corners"):
        worst_case(lambda point: {}, [Tolerance(f"x{i}", 0.0, 1.0) for i in range(13)])
