# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Fixed point with 64-bit sums, and bounds of the error against the design that hold."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from pathlib import Path

import control
import numpy as np
import pytest
from scipy import linalg
from verification.support.codegen.block_programs import FIXED, wide_program, write_checks
from verification.support.codegen.c_build import host_library
from verification.support.codegen.fixed_point_cases import slow_limit

from ravenbrick.codegen import generate_ada, generate_c, generate_fixed_c
from ravenbrick.control.rounding.ideal_error import PhysicalForms, ideal_bounds
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Block,
    Constant,
    Diagram,
    Execution,
    FixedFormat,
    FixedPoint,
    FixedPointOptions,
    Inport,
    Interval,
    Outport,
    Sum,
    linear_system,
    state_space_block,
    to_fixed_point,
)
from ravenbrick.model.program import Kind, Program

SAMPLE_TIME = 0.004


def kalman_filter() -> control.StateSpace:
    """Speed from an angle: two states, both poles at 0.996."""
    a, c = np.array([[1.0, SAMPLE_TIME], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    noise, measured = np.diag([1e-4, 50.0]), np.array([[1e6]])
    p = linalg.solve_discrete_are(a.T, c.T, noise, measured)
    gain = a @ p @ c.T @ np.linalg.inv(c @ p @ c.T + measured)
    return control.ss(a - gain @ c, gain, [[0.0, 1.0]], [[0.0]], SAMPLE_TIME)


def lqg() -> control.StateSpace:
    """Of four states: two masses with a spring, observed at one of them."""
    matrix = np.array([[0, 1, 0, 0], [-40, -0.4, 40, 0.2], [0, 0, 0, 1], [40, 0.2, -40, -0.4]])
    plant = control.ss(matrix, [[0], [5], [0], [0]], [[0, 0, 1, 0]], [[0]])
    sampled = control.sample_system(plant, SAMPLE_TIME, "zoh")
    feedback = control.dlqr(sampled, np.diag([20.0, 1.0, 40.0, 1.0]), np.eye(1))[0]
    observer = control.dlqe(sampled.A, np.eye(4), sampled.C, np.eye(4), [[0.1]])[0]
    closed = sampled.A - sampled.B @ feedback - sampled.A @ observer @ sampled.C
    return control.ss(closed, sampled.A @ observer, feedback, [[0.0]], SAMPLE_TIME)


def diagram_of(system: control.StateSpace, offset: float = 0.0) -> Diagram:
    """In to Out, with a constant added if there is one."""
    diagram = Diagram("one", SAMPLE_TIME)
    block = diagram.add(state_space_block("K", system))
    diagram.connect_chain(diagram.add(Inport("In")), block)
    last: Block = block
    if offset:
        last = diagram.add(Sum("Shifted"))
        diagram.connect(block, last, 0)
        diagram.connect(diagram.add(Constant("Offset", value=offset)), last, 1)
    diagram.connect(last, diagram.add(Outport("Out")))
    return diagram


def worst_error(fixed: FixedPoint, raws: np.ndarray) -> float:
    """Largest difference to the design in double precision for raw inputs."""
    system = linear_system(fixed.source, constants=True)
    ports = fixed.format(Kind.INPUT, "In"), fixed.format(Kind.OUTPUT, "Out")
    run, state, worst = Execution(fixed.program), np.zeros(system.nstates), 0.0
    for raw in raws:
        given = np.array([ports[0].real(int(raw)), 1.0])
        wanted = float(system.C[0] @ state + system.D[0] @ given)
        state = system.A @ state + system.B @ given
        found = ports[1].real(int(run.step({"In": int(raw)})["Out"]))
        worst = max(worst, abs(found - wanted))
    return worst


@pytest.mark.parametrize("reach", [1000.0, 10_000.0])
def test_a_kalman_filter_shows_the_true_speed(reach: float) -> None:
    """50 deg/s; with 32-bit sums its gains are held too coarsely, which is refused by name."""
    diagram = diagram_of(kalman_filter())
    with pytest.raises(DesignError, match=r"block 'K': its numbers as held change"):
        to_fixed_point(diagram, FixedPointOptions({"In": reach}, accumulator_bits=32))
    fixed = to_fixed_point(diagram, FixedPointOptions({"In": reach}))
    ports = fixed.format(Kind.INPUT, "In"), fixed.format(Kind.OUTPUT, "Out")
    run = Execution(fixed.program)
    for k in range(4000):
        found = run.step({"In": ports[0].raw(50 * SAMPLE_TIME * k)})["Out"]
    (bound,) = ideal_bounds(fixed).values()
    assert abs(ports[1].real(int(found)) - 50.0) <= bound.total + ports[0].lsb
    assert bound.coefficients < 0.05 * bound.rounding


CASES = {
    "kalman": (kalman_filter, 10_000.0, 0.0),
    "lqg": (lqg, 3.0, 0.0),
    "with an offset": (lqg, 0.5, 0.123456),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("bits", [32, 64])
def test_no_search_exceeds_the_bound_against_the_design(name: str, bits: int) -> None:
    """Random inputs, held inputs, and the input that the error's own impulse response asks for."""
    make, reach, offset = CASES[name]
    options = FixedPointOptions({"In": reach}, accumulator_bits=bits, tolerance=None)
    try:
        fixed = to_fixed_point(diagram_of(make(), offset), options)
        (bound,) = ideal_bounds(fixed).values()
    except DesignError as error:
        assert bits == 32, error
        return
    most = fixed.format(Kind.INPUT, "In").raw(reach)
    random = np.random.default_rng(3)
    tries = [
        random.integers(-most, most + 1, 2500),
        np.repeat(random.integers(-most, most + 1, 25), 100),
        np.where(random.random(2500) < 0.02, -1, 1).cumprod() * most,
        worst_input(fixed, 2500) * most,
    ]
    worst = max(worst_error(fixed, raws) for raws in tries)
    assert 0.1 * bound.total < worst <= bound.total


def worst_input(fixed: FixedPoint, steps: int) -> np.ndarray:
    """The signs for which the shares of the gains' errors in the last output add up."""
    system = PhysicalForms.of(fixed).difference()
    column, response = system.B[:, 0], []
    for _ in range(steps):
        response.append(float(system.C[0] @ column))
        column = system.A @ column
    return np.where(np.array(response[::-1]) < 0, -1, 1)


def test_a_brute_search_of_a_small_filter_stays_below_its_bound() -> None:
    """All sequences of five extreme or small inputs, each held for three steps."""
    system = control.ss([[0.9]], [[0.1]], [[1.0]], [[0.0]], SAMPLE_TIME)
    fixed = to_fixed_point(diagram_of(system), FixedPointOptions({"In": 1.0}))
    (bound,) = ideal_bounds(fixed).values()
    most = fixed.format(Kind.INPUT, "In").raw(1.0)
    levels = np.array([-most, -1, 0, 1, most])
    worst = 0.0
    for number in range(5**5):
        digits = [(number // 5**place) % 5 for place in range(5)]
        worst = max(worst, worst_error(fixed, np.repeat(levels[digits], 3)))
    assert 0.2 * bound.total < worst <= bound.total


def test_states_have_ranges_and_fractions_of_their_own() -> None:
    """Named alone, a state saturates at its own range."""
    options = FixedPointOptions({"In": 3.0, "K_DSTATE2": 100.0}, accumulator_bits=64)
    fixed = to_fixed_point(diagram_of(lqg()), options)
    fractions = {fixed.format(Kind.STATE, f"K_DSTATE{n}").fraction for n in range(1, 5)}
    assert len(fractions) > 1
    assert fixed.ranges[Kind.STATE, "K_DSTATE2"] == Interval(-100.0, 100.0)
    with pytest.raises(DesignError, match="'K_DSTATE9', which is not an Inport"):
        to_fixed_point(diagram_of(lqg()), FixedPointOptions({"In": 3.0, "K_DSTATE9": 1.0}))
    with pytest.raises(DesignError, match="16, 32 or 64 bits"):
        FixedFormat(24, 3)


def test_sums_of_64_bits_are_generated_in_c_only() -> None:
    """Ada says what to do instead; the proof lies beside the C."""
    fixed = to_fixed_point(diagram_of(lqg()), FixedPointOptions({"In": 3.0}))
    with pytest.raises(DesignError, match="in C only"):
        generate_ada(fixed)
    files = generate_fixed_c(fixed).files
    (bound,) = ideal_bounds(fixed).values()
    assert f"|error of Out| <= {bound.total:.6g}" in files["one_proof.txt"]
    assert "int64_T" in generate_c(fixed.program).files["one.c"]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """All blocks with 64-bit sums, compiled with all warnings as errors."""
    folder: Path = tmp_path_factory.mktemp("wide")
    models: dict[str, Diagram | Program] = {}
    for name in FIXED:
        models[f"long_{name}"] = replace(wide_program(name).program, name=f"long_{name}")
    return host_library(folder, *write_checks(models, folder, 100))


@pytest.mark.parametrize("name", FIXED)
def test_each_block_with_64_bit_sums_equals_its_simulation(name: str, library: ctypes.CDLL) -> None:
    """Random steps; no bit of the output differs."""
    getattr(library, f"long_{name}_check")()
    assert ctypes.c_uint32.in_dll(library, f"long_{name}_check_failures").value == 0


def test_a_limit_at_a_slower_rate_becomes_c(tmp_path: Path) -> None:
    """The limited signal has 32 bits, and what is held of it another fraction."""
    program = slow_limit(64).program
    library = host_library(tmp_path, *write_checks({program.name: program}, tmp_path, 100))
    library.slow_limit_check()
    assert ctypes.c_uint32.in_dll(library, "slow_limit_check_steps").value == 100
    assert ctypes.c_uint32.in_dll(library, "slow_limit_check_failures").value == 0
