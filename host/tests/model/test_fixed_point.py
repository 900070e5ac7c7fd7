# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Formats, rounding, ranges and the proof that nothing overflows."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest
from verification.support.codegen.block_table import block_diagram

from ravenbrick.codegen import prove
from ravenbrick.control import PlantInLoop, one_step_errors
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Constant,
    DataType,
    Diagram,
    DiscreteIntegrator,
    DiscreteStateSpace,
    DiscreteTransferFunction,
    Execution,
    FixedFormat,
    FixedPointOptions,
    Gain,
    Inport,
    Interval,
    MinMax,
    Outport,
    Parameter,
    Relay,
    Rounding,
    Sum,
    UnitDelay,
    to_fixed_point,
)
from ravenbrick.model.integer_ranges import integer_ranges
from ravenbrick.model.number_format import finest_fraction
from ravenbrick.model.program import Binary, Kind, Literal, Program, Read, Slot, Statement
from ravenbrick.model.ranges import real_ranges


@pytest.mark.parametrize(
    ("largest", "width", "fraction"),
    [(10.0, 16, 11), (20.0, 16, 10), (9.0, 32, 27), (16.2, 32, 26), (0.361, 16, 16), (300.0, 16, 6)]
)  # fmt: skip
def test_the_finest_format_just_holds_the_range(largest: float, width: int, fraction: int) -> None:
    """One more fractional bit would overflow."""
    assert finest_fraction(Interval.around_zero(largest), width) == fraction
    FixedFormat(width, fraction).raw(largest)
    with pytest.raises(DesignError, match="does not fit"):
        FixedFormat(width, fraction + 1).raw(largest)


def test_a_power_of_two_fits_on_the_negative_side_only() -> None:
    """-1 has 15 fractional bits, +1 only 14."""
    assert finest_fraction(Interval(-1.0, 0.5), 16) == 15
    assert finest_fraction(Interval(-1.0, 1.0), 16) == 14


@pytest.mark.parametrize("rounding", list(Rounding))
def test_rounding_errs_by_no_more_than_it_says(rounding: Rounding) -> None:
    """All values around zero; zero itself is exact."""
    for value in range(-64, 65):
        error = abs(rounding.divide(value, 3) - value / 8)
        assert error <= rounding.largest_error
    assert rounding.divide(0, 3) == 0


def test_the_range_of_a_filter_is_its_peak_gain() -> None:
    """A first-order filter with gain 1 keeps the input's range; an oscillating one exceeds it."""
    for pole, factor in ((0.9, 1.0), (-0.9, 19.0)):
        diagram = Diagram("one", 0.01)
        source = diagram.add(Inport("In"))
        numerator = (0.0, 1.0 - pole) if pole < 0 else (0.0, 0.1)
        block = diagram.add(
            DiscreteTransferFunction("Filter", numerator=numerator, denominator=(1.0, -pole))
        )
        diagram.connect_chain(source, block, diagram.add(Outport("Out")))
        fixed = to_fixed_point(diagram, FixedPointOptions({"In": 4.0}))
        size = fixed.ranges[Kind.STATE, "Filter_DSTATE1"].size
        assert size == pytest.approx(4.0 * factor, rel=1e-4)


def offset_state_space(a: np.ndarray, b: np.ndarray, start: np.ndarray, offset: float) -> Program:
    """x' = a x + b (In + offset), from `start`."""
    wide = DataType.REAL64
    diagram = Diagram("one", 0.01)
    source, constant = (
        diagram.add(Inport("In", wide)),
        diagram.add(Constant("C", wide, value=offset)),
    )
    total = diagram.add(Sum("Total", wide))
    first = tuple(float(place == 0) for place in range(len(b)))
    rows = tuple(map(tuple, a)), tuple((value,) for value in b), (first,), ((0.0,),)
    space = DiscreteStateSpace("X", wide, None, *rows, tuple(start))
    diagram.connect(source, total)
    diagram.connect(constant, total, 1)
    diagram.connect_chain(total, diagram.add(space), diagram.add(Outport("Out", wide)))
    return diagram.lower()


@pytest.mark.parametrize("seed", range(12))
def test_the_worst_inputs_reach_the_range_of_a_state(seed: int) -> None:
    """They have the signs of its impulse response, reversed, and so add up its sizes; what the
    system does by itself, from its initial values and with an offset, comes to that."""
    dice = np.random.default_rng(seed)
    a, b, start = dice.normal(size=(3, 3)), dice.normal(size=3), dice.normal(size=3) * (seed % 3)
    a *= dice.uniform(0.7, 0.93) / np.abs(np.linalg.eigvals(a)).max()
    offset = float(seed % 2) * 2.0
    ranges = real_ranges(offset_state_space(a, b, start, offset), {"In": Interval(-1.0, 1.0)})
    alone, impulse, forced = [start], b, [np.zeros(3)]
    for _ in range(400):
        alone.append(a @ alone[-1] + b * offset)
        forced.append(forced[-1] + np.abs(impulse))
        impulse = a @ impulse
    worst = (np.abs(alone) + forced).max(axis=0)
    most = np.abs(alone).max(axis=0) + forced[-1]
    sizes = np.array([ranges[Kind.STATE, f"X_DSTATE{place}"].size for place in (1, 2, 3)])
    assert np.all(worst * (1 - 1e-9) <= sizes) and np.all(sizes <= most * (1 + 1e-4))


def test_a_filter_in_fixed_point_follows_the_real_one() -> None:
    """Within a few LSB of the accumulator over 2000 random steps."""
    diagram = Diagram("one", 0.01)
    source = diagram.add(Inport("In"))
    block = diagram.add(
        DiscreteTransferFunction(
            "Filter", numerator=(0.02, 0.04, 0.02), denominator=(1.0, -1.5625, 0.640625)
        )
    )
    diagram.connect_chain(source, block, diagram.add(Outport("Out")))
    fixed = to_fixed_point(diagram, FixedPointOptions({"In": 5.0}))
    ports = fixed.format(Kind.INPUT, "In"), fixed.format(Kind.OUTPUT, "Out")
    real, integer = Execution(diagram), Execution(fixed.program)
    worst = 0.0
    for value in np.random.default_rng(2).uniform(-5, 5, 2000):
        raw = ports[0].raw(value)
        wanted = real.step({"In": ports[0].real(raw)})["Out"]
        got = ports[1].real(integer.step({"In": raw})["Out"])
        worst = max(worst, abs(got - wanted))
    assert worst < 20 * ports[1].lsb


def test_delays_keep_sixteen_bits() -> None:
    """A stored sample has the format of its range."""
    diagram = Diagram("delays", 0.01)
    source = diagram.add(Inport("In"))
    memory = diagram.add(UnitDelay("Memory"))
    diagram.connect_chain(source, memory, diagram.add(Outport("Out")))
    fixed = to_fixed_point(diagram, FixedPointOptions({"In": 3.0}))
    assert fixed.format(Kind.STATE, "Memory_DSTATE") == FixedFormat(16, 13)


def test_a_format_is_given_by_the_name_of_a_block_or_of_a_parameter() -> None:
    """Of a state by its block's name, which is not its own; of a parameter not by its block's."""
    diagram = Diagram("one", 0.01)
    source, gain = (
        diagram.add(Inport("In")),
        diagram.add(Gain("K", gain=Parameter("slope", 0.3, "1", ""))),
    )
    memory = diagram.add(UnitDelay("Memory"))
    diagram.connect_chain(source, gain, memory, diagram.add(Outport("Out")))
    formats = {"Memory": FixedFormat(16, 7), "K": FixedFormat(32, 9), "slope": FixedFormat(16, 8)}
    fixed = to_fixed_point(diagram, FixedPointOptions({"In": 3.0}, formats, tolerance=None))
    assert fixed.format(Kind.STATE, "Memory_DSTATE") == FixedFormat(16, 7)
    assert fixed.format(Kind.SIGNAL, "K") == FixedFormat(32, 9)
    assert fixed.format(Kind.PARAMETER, "slope") == FixedFormat(16, 8)


@pytest.mark.parametrize(("largest", "fraction"), [(3.0, 29), (7.0, 28)])
def test_what_is_compared_is_as_fine_as_32_bits_hold(largest: float, fraction: int) -> None:
    """The larger of a tenth of the input and a number: with one more bit it would not fit."""
    with pytest.raises(DesignError, match="does not fit"):
        FixedFormat(32, fraction + 1).raw(largest)
    diagram = Diagram("one", 0.01)
    weak, larger = diagram.add(Gain("Weak", gain=0.1)), diagram.add(MinMax("Larger"))
    diagram.connect_chain(diagram.add(Inport("In")), weak, larger, diagram.add(Outport("Out")))
    diagram.connect(diagram.add(Constant("Limit", value=largest)), larger, 1)
    fixed = to_fixed_point(diagram, FixedPointOptions({"In": 1.0}, accumulator_bits=32))
    assert fixed.format(Kind.SIGNAL, "Larger") == FixedFormat(32, fraction)


def test_a_huge_gain_is_refused_by_name() -> None:
    """The sum of 1e9 V and 1 mV has no format."""
    diagram = Diagram("wide", 0.01)
    source, small = diagram.add(Inport("In")), diagram.add(Inport("Small"))
    scale = diagram.add(Gain("Scale", gain=1e12))
    total = diagram.add(Sum("Total"))
    diagram.connect_chain(source, scale, total, diagram.add(Outport("Out")))
    diagram.connect(small, total, 1)
    with pytest.raises(DesignError, match="Total"):
        to_fixed_point(diagram, FixedPointOptions({"In": 1.0, "Small": 1e-3}, accumulator_bits=32))


def test_overflow_is_found_by_intervals_and_by_execution() -> None:
    """A product of 16-bit numbers times 4 exceeds 32 bits for the largest input."""
    narrow, wide = FixedFormat(16, 0), FixedFormat(32, 0)
    source = Slot(Kind.INPUT, "In", narrow, "In")
    target = Slot(Kind.OUTPUT, "Out", wide, "Out")
    expression = Binary("*", Read(source), Literal(2**17, wide))
    statement = Statement(target, expression, "Out", "Outport")
    program = Program("over", 0.01, (source,), (target,), (), (), (), (statement,))
    with pytest.raises(OverflowError, match="block 'Out' reaches"):
        integer_ranges(program)
    assert Execution(program).step({"In": 16383})["Out"] == 16383 * 2**17
    with pytest.raises(OverflowError, match="does not fit into 32 bits"):
        Execution(program).step({"In": 16384})


def test_a_format_names_itself() -> None:
    """As Simulink writes it."""
    assert str(FixedFormat(16, 11)) == "sfix16_En11"
    assert str(FixedFormat(32, -2)) == "sfix32_E2"
    assert math.isclose(FixedFormat(16, 11).lsb, 0.000488, rel_tol=1e-3)


def test_a_choice_states_no_bound_of_its_error() -> None:
    """A rounding error before a comparison may change the branch, so nothing is promised."""
    diagram = Diagram("relay", 0.01)
    chain = (Inport("In"), Gain("Share", gain=0.3), Relay("Level", on_above=1.0), Outport("Out"))
    diagram.connect_chain(*(diagram.add(block) for block in chain))
    fixed = to_fixed_point(diagram, FixedPointOptions({"In": 4.0}))
    assert one_step_errors(fixed) == {}
    assert "Out: not stated, a block before it decides" in prove(fixed).text()
    system = control.ss([[0.5]], [[1.0]], [[1.0]], [[0.0]], 0.01)
    with pytest.raises(DesignError, match="'Level' decides or rounds"):
        prove(fixed, PlantInLoop(system, ("In",)))


def test_a_counter_is_bounded_by_what_it_is_compared_with() -> None:
    """Interval analysis sees the comparison, so that a state machine needs no range."""
    program = to_fixed_point(
        block_diagram("state_machine"), FixedPointOptions({"In0": 10.0, "In1": 10.0})
    )
    found = program.ranges[Kind.STATE, "B_SINCE"]
    assert 3.0 <= found.high < 1e7


@pytest.mark.parametrize("nonlinear", [False, True])
def test_the_error_about_a_missing_range_names_the_block_that_needs_it(nonlinear: bool) -> None:
    """An integrator: neither what it drives nor the relay that cannot be linearised."""
    diagram = Diagram("drift", 0.01)
    integral = DiscreteIntegrator("Integral", gain=1.0)
    smooth = DiscreteTransferFunction("Smooth", numerator=(0.0, 0.5), denominator=(1.0, -0.5))
    last = [Relay("Contact")] if nonlinear else []
    chain = [Inport("In"), integral, smooth, UnitDelay("Memory"), *last, Outport("Out")]
    diagram.connect_chain(*(diagram.add(block) for block in chain))
    with pytest.raises(DesignError, match=r"^the state of 'Integral' has no bound of its own"):
        to_fixed_point(diagram, FixedPointOptions({"In": 1.0}))
