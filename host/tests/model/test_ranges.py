# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ranges of loops with limits, beside what the loops reach when they are run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pytest

from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Block,
    DataType,
    Diagram,
    Gain,
    Inport,
    Interval,
    Outport,
    Saturation,
    Sum,
    UnitDelay,
)
from ravenbrick.model.program import Program
from ravenbrick.model.ranges import real_ranges

Array = npt.NDArray[np.float64]

WIDE = DataType.REAL64
STEPS, RUNS = 200, 48


@dataclass(frozen=True)
class LimitedLoops:
    """x' = to_states z and v = to_limits z, where z holds the states x, the input, and v limited.

    Row i of `to_limits` is 0 from the place of limit i on.
    """

    to_states: Array
    to_limits: Array
    limits: Array

    def program(self) -> Program:
        """The same as a diagram of delays, gains, sums and saturations."""
        diagram = Diagram("loops", 0.01)
        values: list[Block] = [
            diagram.add(UnitDelay(f"X{place}", WIDE)) for place in range(len(self.to_states))
        ]
        delays = [*values]
        values.append(diagram.add(Inport("In", WIDE)))

        def weighted(name: str, row: Array) -> Block:
            total = diagram.add(Sum(name, WIDE, signs="+" * len(values)))
            for port, (value, weight) in enumerate(zip(values, row, strict=False)):
                scaled = diagram.add(Gain(f"{name}_{port}", WIDE, gain=float(weight)))
                diagram.connect_chain(value, scaled)
                diagram.connect(scaled, total, port)
            return total

        for place, (row, limit) in enumerate(zip(self.to_limits, self.limits, strict=True)):
            before = weighted(f"V{place}", row)
            limited = diagram.add(Saturation(f"W{place}", WIDE, limit=float(limit)))
            diagram.connect_chain(before, limited, diagram.add(Outport(f"Out{place}", WIDE)))
            values.append(limited)
        for place, (row, delay) in enumerate(zip(self.to_states, delays, strict=True)):
            diagram.connect(weighted(f"Next{place}", row), delay)
        return diagram.lower()

    def reached(self, dice: np.random.Generator) -> dict[str, float]:
        """The largest sizes in many runs with inputs within 1 that are random, that switch rarely,
        or that push what they find."""
        order = len(self.to_states)
        x = np.zeros((order, RUNS))
        pushed = dice.normal(size=(RUNS, order)) * (np.arange(RUNS) % 3 == 0)[:, None]
        kept = np.where(np.arange(RUNS) % 3 == 1, 0.9, 0.0)
        u = np.ones(RUNS)
        most: dict[str, float] = {}
        for _ in range(STEPS):
            fresh = np.where(np.arange(RUNS) % 3 == 1, 1.0, dice.uniform(-1.0, 1.0, RUNS))
            fresh = np.copysign(fresh, dice.uniform(-1.0, 1.0, RUNS))
            u = np.where(dice.random(RUNS) < kept, u, fresh)
            push = np.sum(pushed * x.T, axis=1)
            u = np.where(push != 0.0, np.sign(push), u)
            z = np.vstack([x, u, np.zeros((len(self.limits), RUNS))])
            found = {f"X{place}": x[place] for place in range(order)}
            for place, (row, limit) in enumerate(zip(self.to_limits, self.limits, strict=True)):
                found[f"V{place}"] = row @ z
                z[order + 1 + place] = np.clip(found[f"V{place}"], -limit, limit)
                found[f"W{place}"] = z[order + 1 + place]
            x = self.to_states @ z
            for name, value in found.items():
                most[name] = max(most.get(name, 0.0), float(np.abs(value).max()))
        return most

    def ranges(self) -> dict[str, float]:
        """The size of each variable's range."""
        found = real_ranges(self.program(), {"In": Interval(-1.0, 1.0)})
        return {name: interval.size for (_, name), interval in found.items()}


def loop(pole: float, back: float, limit: float) -> LimitedLoops:
    """x' = pole x + back (x limited) + u."""
    return LimitedLoops(
        np.array([[pole, 1.0, back]]), np.array([[1.0, 0.0, 0.0]]), np.array([limit])
    )


def some_loops(dice: np.random.Generator) -> LimitedLoops:
    """Two or three states; limits between them and after the input, in loops or not.

    In every second one the loops decay as long as no limit is reached, else with all that are.
    """
    order, count = dice.integers(2, 4), dice.integers(1, 4)
    width = order + 1 + count
    to_states = dice.normal(size=(order, width)) * (dice.random((order, width)) < 0.7)
    to_limits = dice.normal(size=(count, width)) * (dice.random((count, width)) < 0.7)
    for place in range(count):
        to_limits[place, order + 1 + place :] = 0.0
    alone = np.abs(np.linalg.eigvals(to_states[:, :order])).max()
    to_states[:, :order] *= dice.uniform(0.3, 0.9) / max(alone, 0.1)
    if dice.random() < 0.5:
        among = np.eye(len(to_limits)) - to_limits[:, order + 1 :]
        unlimited = np.linalg.solve(among, to_limits[:, :order])
        to_states[:, :order] -= to_states[:, order + 1 :] @ unlimited
    return LimitedLoops(to_states, to_limits, dice.uniform(0.05, 4.0, count))


def test_a_limit_in_a_loop_that_it_keeps_from_diverging_has_a_range_only_if_unreached() -> None:
    """x' = 1.5 x - x limited + u: bounded by 2 as long as the limit is above."""
    assert loop(1.5, -1.0, 2.1).ranges()["X0"] == pytest.approx(2.0, rel=1e-5)
    assert loop(1.5, -1.0, 1.0).reached(np.random.default_rng(1))["X0"] > 1e6
    with pytest.raises(DesignError, match="the state of 'X0' has no bound of its own"):
        loop(1.5, -1.0, 1.9).ranges()


def test_the_output_of_a_limit_that_is_reached_counts_as_an_input() -> None:
    """x' = 0.9 x + 0.05 (x limited to 2) + u reaches (1 + 0.05 * 2) / (1 - 0.9), not 20."""
    limited = loop(0.9, 0.05, 2.0)
    assert limited.ranges()["X0"] == pytest.approx(11.0, rel=1e-5)
    assert limited.reached(np.random.default_rng(1))["X0"] == pytest.approx(11.0, rel=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_no_run_leaves_the_ranges(seed: int) -> None:
    """Of random loops with limits; in several of them a state's range tells what it reaches."""
    dice = np.random.default_rng(seed)
    bounded = close = 0
    for _ in range(20):
        loops = some_loops(dice)
        try:
            ranges = loops.ranges()
        except DesignError:
            continue
        reached = loops.reached(dice)
        assert {n: s for n, s in reached.items() if s > ranges[n] * (1.0 + 1e-9)} == {}
        bounded += 1
        close += any(size > 0.7 * ranges[name] for name, size in reached.items() if name[0] == "X")
    assert bounded >= 8 and close >= 4
