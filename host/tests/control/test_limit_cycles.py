# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Oscillations that rounding keeps alive."""

from __future__ import annotations

import json

import pytest
from verification.support.codegen.paper_pi import fixed_pi, plant

from ravenbrick.codegen import generate_fixed_c
from ravenbrick.control import search_limit_cycles
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Diagram,
    FixedFormat,
    FixedPoint,
    FixedPointOptions,
    Gain,
    Inport,
    Outport,
    Rounding,
    Sum,
    UnitDelay,
    to_fixed_point,
)
from ravenbrick.model.program import Kind


def ringing(rounding: Rounding) -> FixedPoint:
    """y(k) = -0.95 y(k-1) + u(k) with a state of 6 fractional bits: known to have cycles."""
    diagram = Diagram("ringing", 0.01)
    source, out = diagram.add(Inport("In")), diagram.add(Outport("Out"))
    total, last = diagram.add(Sum("Total", signs="++")), diagram.add(UnitDelay("Last"))
    back = diagram.add(Gain("Back", gain=-0.95))
    diagram.connect(source, total, 0)
    diagram.connect_chain(total, last, back)
    diagram.connect(back, total, 1)
    diagram.connect(total, out)
    options = FixedPointOptions(
        {"In": 1.0, "Last": 30.0}, formats={"Last": FixedFormat(16, 6)}, rounding=rounding
    )
    return to_fixed_point(diagram, options)


@pytest.mark.parametrize("rounding", Rounding)
def test_the_paper_s_loop_comes_to_rest(rounding: Rounding) -> None:
    """In the loop with the motor, from random states, for zero, small and other set-points."""
    found = search_limit_cycles(fixed_pi(rounding), plant(), starts=6)
    assert found.closed_loop and found.cycles == ()
    assert "all come to rest" in found.sentence()


def test_a_filter_that_rings_is_found() -> None:
    """Rounded to nearest, half a step is kept for ever: period 2, with the theory's amplitude."""
    found = search_limit_cycles(ringing(Rounding.NEAREST), starts=6)
    assert {cycle.period for cycle in found.cycles} == {2}
    dead_band = 0.5 / (1 - 0.95)
    out = 2 ** (10 - 6)
    assert 0 < found.largest_lsb <= 2 * dead_band * out


def test_the_inputs_searched_are_zero_small_or_anywhere_in_half_the_range() -> None:
    """Beyond, states that swing would reach their limits. Each start of this filter rings."""
    fixed = ringing(Rounding.NEAREST)
    found = search_limit_cycles(fixed, starts=60, steps=300).cycles
    form = fixed.format(Kind.INPUT, "In")
    sizes = [abs(form.real(cycle.inputs["In"])) for cycle in found]
    assert len(found) == 60 and sizes[0] == 0.0
    assert max(sizes[1::2]) <= 8 * form.lsb < max(sizes[2::2]) / 10
    assert 0.45 < max(sizes) <= 0.5


def test_cutting_off_lets_a_real_pole_come_to_rest_more_often() -> None:
    """Toward zero, rounding takes energy away."""
    cut = search_limit_cycles(ringing(Rounding.ZERO), starts=6)
    nearest = search_limit_cycles(ringing(Rounding.NEAREST), starts=6)
    assert cut.largest_lsb < nearest.largest_lsb


def test_the_proof_says_what_was_found_and_that_it_is_a_search() -> None:
    """In both files of the proof."""
    files = generate_fixed_c(fixed_pi(), plant()).files
    assert json.loads(files["functional_proof.json"])["limit_cycles"]["oscillating"] == 0
    assert "Limit cycles (a search, no proof):" in files["functional_proof.txt"]


def test_progress_is_reported_and_a_short_search_refused() -> None:
    """A run must be long enough to see a period."""
    seen: list[tuple[int, int]] = []
    search_limit_cycles(
        ringing(Rounding.ZERO), starts=2, steps=300,
        progress=lambda done, total: seen.append((done, total)),
    )  # fmt: skip
    assert seen == [(1, 2), (2, 2)]
    with pytest.raises(DesignError, match="at least 256 steps"):
        search_limit_cycles(ringing(Rounding.ZERO), steps=100)
