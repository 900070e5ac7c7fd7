# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Worst-case peak gains, and the bounds that they give, beside closed forms and what is reached."""

from __future__ import annotations

import control
import numpy as np
import pytest
from verification.support.codegen.paper_pi import fixed_pi

from ravenbrick.control import PlantInLoop, closed_loop_bound, peak_gain
from ravenbrick.control.rounding.ideal_error import ideal_bounds
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Block,
    Diagram,
    DiscreteStateSpace,
    DiscreteTransferFunction,
    Execution,
    FixedPoint,
    FixedPointOptions,
    Inport,
    Outport,
    to_fixed_point,
)
from ravenbrick.model.program import Kind


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


@pytest.mark.parametrize(
    ("system", "measured", "sentence"),
    [
        (control.ss([[0.9]], [[0.1]], [[1.0]], 0, 0.01), ("Speed",), "sample time 0.01.*0.004 s"),
        (
            control.ss([[0.9]], [[0.1, 0.1]], [[1.0]], 0, 0.004),
            ("Speed",),
            "2 inputs and 1 outputs",
        ),
        (control.ss([[0.9]], [[0.1]], [[1.0]], 1.0, 0.004), ("Speed",), "passes its input on"),
        (control.ss([[0.9]], [[0.1]], [[1.0]], 0, 0.004), ("Sped",), "'Sped' is not an Inport"),
    ],
)
def test_a_plant_that_does_not_fit_the_diagram_is_refused(
    system: control.StateSpace, measured: tuple[str, ...], sentence: str
) -> None:
    with pytest.raises(DesignError, match=sentence):
        closed_loop_bound(fixed_pi(), PlantInLoop(system, measured))


def chain(block: Block) -> Diagram:
    """From In through the block to Out."""
    diagram = Diagram("lag", 0.01)
    parts = diagram.add(Inport("In")), diagram.add(block), diagram.add(Outport("Out"))
    diagram.connect_chain(*parts)
    return diagram


def lag(pole: float) -> FixedPoint:
    """x' = pole x + (1 - pole) In in fixed point, however coarse its gains are."""
    block = DiscreteTransferFunction("F", numerator=(0.0, 1 - pole), denominator=(1.0, -pole))
    options = FixedPointOptions({"In": 1.0}, accumulator_bits=32, tolerance=None)
    return to_fixed_point(chain(block), options)


@pytest.mark.parametrize("pole", [0.9, 0.99, 0.998])
def test_a_filter_in_fixed_point_stays_within_its_bound_of_the_design(pole: float) -> None:
    """For inputs that stay at 1 or -1 for long; they come to a tenth of the bound at least."""
    fixed = lag(pole)
    (bound,) = ideal_bounds(fixed).values()
    ports = fixed.format(Kind.INPUT, "In"), fixed.format(Kind.OUTPUT, "Out")
    run, dice = Execution(fixed.program), np.random.default_rng(1)
    state = worst = 0.0
    for value in np.repeat(dice.choice((-1.0, 1.0), 12), round(4 / (1 - pole))):
        got = ports[1].real(run.step({"In": ports[0].raw(value)})["Out"])
        worst = max(worst, abs(got - state))
        state = pole * state + (1 - pole) * value
    total = bound.rounding + bound.coefficients + ports[1].lsb
    assert 0.1 * total < worst <= total


def test_the_bound_of_gains_as_held_counts_the_initial_value() -> None:
    """By hand, from 1/2 with a pole of 0.9 held with 15 bits: a sum over what is left of it."""
    bounds = []
    for start in (0.0, 0.5):
        block = DiscreteStateSpace(
            "F", a=((0.9,),), b=((0.1,),), c=((1.0,),), d=((0.0,),), initial=(start,)
        )
        options = FixedPointOptions({"In": 1.0}, accumulator_bits=32, tolerance=None)
        (bound,) = ideal_bounds(to_fixed_point(chain(block), options)).values()
        bounds.append(bound.coefficients)
    held, steps = round(0.9 * 2**15) / 2**15, np.arange(500)
    assert bounds[1] - bounds[0] == pytest.approx(0.5 * np.abs(held**steps - 0.9**steps).sum())


def test_in_a_loop_the_bound_of_gains_as_held_counts_the_initial_value() -> None:
    """The same of z' = 0.9 z + 0.1 x with the plant x' = 0.5 x + 0.1 z, of which x is looked at."""
    block = DiscreteStateSpace(
        "F", a=((0.9,),), b=((0.1,),), c=((1.0,),), d=((0.0,),), initial=(0.5,)
    )
    options = FixedPointOptions({"In": 1.0}, accumulator_bits=32, tolerance=None)
    plant = PlantInLoop(control.ss([[0.5]], [[0.1]], [[1.0]], 0, 0.01), ("In",))
    found = closed_loop_bound(to_fixed_point(chain(block), options), plant)
    wanted = np.array([[0.5, 0.1], [0.1, 0.9]])
    held = np.array([[0.5, 0.1], np.round(wanted[1] * 2**15) / 2**15])
    powers = [(np.linalg.matrix_power(held, k) - np.linalg.matrix_power(wanted, k))[0, 1]
              for k in range(600)]  # fmt: skip
    assert found.coefficients == pytest.approx(0.5 * np.abs(powers).sum(), rel=1e-6)


def test_no_bound_is_stated_where_errors_drive_a_state_to_its_limit() -> None:
    """A thirty-second of its range is left: at 0.9988, roundings and gains add up to more."""
    with pytest.raises(DesignError, match=r"state 'F_DSTATE1' may be wrong by 0\.03"):
        ideal_bounds(lag(0.9988))


def test_an_integrator_has_no_peak_gain() -> None:
    """The message gives the distance of its pole."""
    with pytest.raises(DesignError, match=r"distance 1\.000000"):
        peak_gain(control.ss([[1.0]], [[1.0]], [[1.0]], 0, 1.0))
