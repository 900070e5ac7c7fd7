# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Signals that a simulation finds beside the states, against exact solutions of their equations."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from scipy.special import lambertw

from ravenbrick.errors import DesignError
from ravenbrick.model import Block, CustomFunction, DataType, Diagram, Inport, Integrator, Outport
from ravenbrick.model.blocks.implicit import ImplicitSignal, LateSignal, LoopSignal
from ravenbrick.model.simulation.hybrid import Given, Hybrid, Response

WIDE = DataType.REAL64


def computed(name: str, function: Callable[..., float]) -> CustomFunction:
    """A block of this function; its C is not used."""
    return CustomFunction(name, WIDE, function=function, c="return 0.0;")


def closed(blocks: Mapping[Block, tuple[str, ...]], stop: float, source: Given) -> Response:
    """Blocks with the names of what feeds their ports, `r` being the source; those that are not
    implicit have an outport of their name and `_out`."""
    diagram = Diagram("loop", 0.1)
    named: dict[str, Block] = {"r": diagram.add(Inport("r", WIDE))}
    named |= {block.name: diagram.add(block) for block in blocks}
    for block, feeding in blocks.items():
        for port, name in enumerate(feeding):
            diagram.connect(named[name], block, port)
        if not isinstance(block, ImplicitSignal):
            diagram.connect(block, diagram.add(Outport(f"{block.name}_out", WIDE)))
    return Hybrid(diagram, set()).run(stop, None, {"r": source})


def ramp(time: float) -> float:
    return 3.0 * time - 1.0


def ramps(found: Response) -> np.ndarray:
    """Its values in a run."""
    return np.array([ramp(time) for time in found.times])


@pytest.mark.parametrize(
    ("function", "solution"),
    [
        (lambda r, y: 4.0 * (r - y), lambda r: 0.8 * r),
        (lambda r, y: math.exp(r - y), lambda r: np.real(lambertw(np.exp(r)))),
        (lambda r, y: r + 1.0 / y, lambda r: (r + np.sqrt(r * r + 4.0)) / 2.0),
        (lambda r, y: r - y**3, lambda r: [real_root([1.0, 0.0, 1.0, -value]) for value in r]),
        (
            lambda r, y: -10.0 * math.cbrt(y - r),
            lambda r: r + [real_root([1.0, 0.0, 10.0, value]) ** 3 for value in r],
        ),
    ],
    ids=["linear", "exponential", "pole at the first guess", "cubic", "steep"],
)
def test_a_loop_has_the_value_of_its_equation(
    function: Callable[..., float], solution: Callable[[np.ndarray], np.ndarray]
) -> None:
    """At every instant of a ramp through 0."""
    blocks = {computed("f", function): ("r", "y"), LoopSignal("y"): ("f",)}
    found = closed(blocks, 1.0, ramp)
    assert len(found.times) > 900
    assert found.signals["f_out"] == pytest.approx(solution(ramps(found)), abs=2e-8)


def real_root(falling: list[float]) -> float:
    """The only real one of a polynomial."""
    return next(float(root.real) for root in np.roots(falling) if abs(root.imag) < 1e-9)


def test_two_loops_through_each_other_are_solved_together() -> None:
    """x = cos(y) / 2 and y = r + sin(x) / 2: what repeated insertion converges to."""
    blocks = {
        computed("f", lambda y: math.cos(y) / 2.0): ("y",),
        computed("g", lambda r, x: r + math.sin(x) / 2.0): ("r", "x"),
        LoopSignal("x"): ("f",),
        LoopSignal("y"): ("g",),
    }
    found = closed(blocks, 1.0, ramp)
    x = y = np.zeros_like(found.times)
    for _ in range(80):
        x, y = np.cos(y) / 2.0, ramps(found) + np.sin(x) / 2.0
    assert found.signals["f_out"] == pytest.approx(x, abs=1e-8)
    assert found.signals["g_out"] == pytest.approx(y, abs=1e-8)


def test_a_loop_drives_a_state_as_its_solution_does() -> None:
    """s' = y with y = r - s - y and r = 0: s = exp(-t / 2)."""
    blocks = {
        computed("f", lambda r, s, y: r - s - y): ("r", "s", "y"),
        LoopSignal("y"): ("f",),
        Integrator("s", initial=1.0): ("f",),
    }
    found = closed(blocks, 3.0, 0.0)
    assert found.signals["s_out"] == pytest.approx(np.exp(-found.times / 2.0), abs=1e-6)


def test_a_loop_that_loses_its_solution_is_refused_with_block_and_instant() -> None:
    """y = y^2 + 1/4 + (r - 1) with r = t has y = 1/2 - sqrt(1 - t) until 1 s only."""
    blocks = {computed("f", lambda r, y: y * y + r - 0.75): ("r", "y"), LoopSignal("y"): ("f",)}
    sentence = r"algebraic loop through 'y' has no solution that is found at 1\.\d* s"
    with pytest.raises(DesignError, match=sentence):
        closed(blocks, 2.0, lambda time: time)


def test_a_late_signal_in_a_loop_follows_the_method_of_steps() -> None:
    """s' = r - s(t - 1), s = 1/2 before 0: polynomials from one delay to the next (Bellman, Cooke
    1963); their values do not depend on the solver's steps."""
    blocks = {
        computed("f", lambda r, late: r - late): ("r", "late"),
        Integrator("s", initial=0.5): ("f",),
        LateSignal("late", initial=0.5, delay=1.0): ("s",),
    }
    found = closed(blocks, 3.0, 1.0)
    pieces = [np.poly1d([0.5])]  # in the time since the piece began
    for _ in range(3):
        growth = (1.0 - pieces[-1]).integ()
        pieces.append(growth + pieces[-1](1.0 if len(pieces) > 1 else 0.0))
    number = np.minimum(np.floor(found.times + 1e-9).astype(int), 2)
    values = [pieces[n + 1](t - n) for n, t in zip(number, found.times, strict=True)]
    assert found.signals["s_out"] == pytest.approx(values, abs=1e-8)


def test_a_jump_comes_back_after_each_delay_and_nowhere_else() -> None:
    """y = r - y(t - 1/4) / 2 is constant between, the sum of the first terms of (-1/2)^n; another
    delay of 0.1 gives the same that much later."""
    blocks = {
        computed("f", lambda r, late: r - late / 2.0): ("r", "late"),
        LateSignal("late", delay=0.25): ("f",),
        LateSignal("again", initial=7.0, delay=0.1): ("f",),
        computed("g", lambda again: again): ("again",),
    }
    found = closed(blocks, 2.0, 1.0)
    for name, lag, first in (("f_out", 0.0, 0.0), ("g_out", 0.1, 7.0)):
        terms = np.floor((found.times - lag + 1e-9) / 0.25) + 1.0
        expected = np.where(terms < 1.0, first, (1.0 - (-0.5) ** terms) / 1.5)
        away = np.abs((found.times - lag + 1e-6) % 0.25) > 2e-6
        assert away.mean() > 0.95
        assert found.signals[name][away] == pytest.approx(expected[away], abs=1e-8)


def test_a_late_curve_is_the_curve_of_before() -> None:
    """Of a sine, by cubics between the points that were noted."""
    blocks = {
        computed("f", math.sin): ("r",),
        LateSignal("late", initial=-1.0, delay=0.7): ("f",),
        computed("g", lambda late: late): ("late",),
    }
    found = closed(blocks, 3.0, lambda time: 5.0 * time)
    before = found.times - 0.7
    expected = np.where(before < 0.0, -1.0, np.sin(5.0 * before))
    away = np.abs(before) > 1e-6
    assert found.signals["g_out"][away] == pytest.approx(expected[away], abs=1e-8)
