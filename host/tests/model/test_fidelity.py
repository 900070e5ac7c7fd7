# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What runs is what was designed: default form of transfer functions, and the gate."""

from __future__ import annotations

from collections.abc import Callable

import control
import numpy as np
import pytest
from verification.support.codegen.controller_forms import (
    FORMS,
    exact_answer,
    form_diagram,
    random_controller,
)

from ravenbrick.codegen import generate_ada, generate_c
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Block,
    DeltaTransferFunction,
    Diagram,
    DiscreteIntegrator,
    DiscreteTransferFunction,
    Execution,
    Inport,
    IntegrationMethod,
    Outport,
    ZeroPoleGain,
    fidelity,
    linear_system,
    transfer_function_block,
)

SAMPLE_TIME = 0.004
# 1 / (s (s + 1)^2): its step response is 18 after 20 s.
SLOW = ZeroPoleGain((), (0.0, -1.0, -1.0), 1.0)


def last_output(diagram: Diagram, steps: int) -> float:
    """Of a unit step."""
    run = Execution(diagram)
    for _ in range(steps):
        found = run.step({"In": 1.0})
    return float(found["Out"])


def test_slow_poles_keep_their_digits_in_single_precision() -> None:
    """20 s of integrator and two poles at 1 rad/s, sampled every 4 ms."""
    exact = exact_answer(SLOW, SAMPLE_TIME, 5001, 5001)[-1]
    assert exact == pytest.approx(18.0, abs=3e-3)
    continuous = control.tf([1], np.poly([0, -1, -1]))
    for system in (SLOW, continuous):
        block = transfer_function_block("F", system, sample_time=SAMPLE_TIME)
        diagram = form_diagram([block], SAMPLE_TIME)
        assert last_output(diagram, 5001) == pytest.approx(exact, rel=3e-4)


@pytest.mark.parametrize("generate", [generate_c, generate_ada])
def test_a_direct_form_that_loses_its_digits_is_refused(generate: Callable[..., object]) -> None:
    """The sentence names the block, how wrong it is, and what helps."""
    sampled = SLOW.sampled(SAMPLE_TIME)
    diagram = form_diagram(FORMS["direct"](sampled), SAMPLE_TIME)
    with pytest.raises(DesignError, match=r"block 'Direct' would not do what was designed.*%"):
        generate(diagram)
    generate(diagram, tolerance=None)
    own = form_diagram(FORMS["delta"](sampled), SAMPLE_TIME)
    generate(own)
    (row,) = fidelity(own).blocks
    assert row.worst < 1e-4 and row.pole_shift < 1e-7


@pytest.mark.parametrize("time_constant", [0.02, 0.0639])
def test_a_drift_that_shows_after_many_seconds_is_refused(time_constant: float) -> None:
    """A motor's angle: its poles and its first two seconds are right, but 20 s are not."""
    system, sample_time, steps = ZeroPoleGain((), (0.0, -1 / time_constant), 1.0), 5e-4, 40_000
    exact = exact_answer(system, sample_time, steps, steps)
    sampled = system.sampled(sample_time)
    for form, is_right in (("direct", False), ("delta", True)):
        diagram = form_diagram(FORMS[form](sampled), sample_time)
        rows = Execution(diagram).samples([1.0], steps)
        errors = np.abs(np.array([row[0] for row in rows], dtype=np.float64) - exact)
        assert errors[:2000].max() < 1e-3 * exact[1999]
        assert (errors.max() < 1e-3 * exact[-1]) == is_right
        (row,) = fidelity(diagram).blocks
        assert row.response_error < 1e-3 and row.run_s == row.horizon_s == 20.0
        assert (row.step_error < 1e-3) == is_right


def test_rounding_shows_although_all_numbers_are_exact() -> None:
    """1 / (z - 1) (z - 1 + 2^-7), whose coefficients have few binary digits."""
    slow = 1 - 2**-7
    block = DiscreteTransferFunction(
        "Direct", numerator=(0.0, 0.0, 2**-7), denominator=(1.0, -1 - slow, slow)
    )
    with pytest.raises(DesignError, match="'Direct' would not do what was designed"):
        generate_c(form_diagram([block], 5e-4))


def test_a_slow_pole_is_compared_by_its_numbers_beyond_the_run() -> None:
    """At 0.01 rad/s and 1 ms, of which the first 20 s show a fifth."""
    block = DiscreteTransferFunction(
        "Direct", numerator=(0.0, 1e-5), denominator=(1.0, -np.exp(-1e-5))
    )
    (row,) = fidelity(form_diagram([block], 1e-3)).blocks
    assert row.run_s == 20.0 and row.horizon_s == pytest.approx(300.0, rel=1e-3)
    assert row.step_error == pytest.approx(_error_after(1e-5, 2**19), rel=0.02)
    fast = transfer_function_block("F", ZeroPoleGain((), (-0.01,), 1.0), sample_time=1e-3)
    (row,) = fidelity(form_diagram([fast], 1e-3)).blocks
    assert row.step_error < 1e-3


def _error_after(entry: float, steps: int) -> float:
    """By the closed form of a first-order lag, with its pole as single precision holds it."""
    held, pole = float(np.float32(np.exp(-entry))), float(np.exp(-entry))
    wanted, found = ((1 - p**steps) / (1 - p) for p in (pole, held))
    return abs(found - wanted) / wanted


def test_a_block_of_a_slow_rate_runs_for_as_long() -> None:
    """An integrator of 20 ms in a diagram of 1 ms: 20 s are 1,000 of its samples."""
    diagram = Diagram("rates", 0.001)
    slow = DiscreteIntegrator("Slow", sample_time=0.02, gain=0.013)
    diagram.connect_chain(diagram.add(Inport("In")), diagram.add(slow), diagram.add(Outport("Out")))
    (row,) = fidelity(diagram).blocks
    assert row.run_s == pytest.approx(20.0)


def test_an_unstable_controller_is_compared_while_it_grows() -> None:
    """A pole at 3 in z: not until its numbers overflow."""
    block = DiscreteTransferFunction("Fast", numerator=(0.0, 0.1), denominator=(1.0, -3.3))
    (row,) = fidelity(form_diagram([block], 0.01)).blocks
    assert row.worst < 1e-5 and row.run_s < 0.2


@pytest.mark.parametrize("seed", range(8))
def test_each_section_passes_a_constant_on_as_it_is(seed: int) -> None:
    """So that no signal between sections is much larger than the input: C (I - A)^-1 B + D = 1."""
    system = random_controller(np.random.default_rng(seed))
    block = transfer_function_block("F", system, sample_time=0.01)
    assert isinstance(block, DeltaTransferFunction)
    for section in (one for one in block.sections if one.returned):
        alone = linear_system(form_diagram([DeltaTransferFunction("F", sections=(section,))], 0.01))
        settled = np.linalg.solve(np.eye(alone.nstates) - alone.A, alone.B)
        assert alone.C @ settled + alone.D == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("sample_time", [0.001, 0.02])
def test_the_default_form_answers_as_sixty_digits_do(seed: int, sample_time: float) -> None:
    """Random controllers, a step up and down."""
    system = random_controller(np.random.default_rng(seed))
    block = transfer_function_block("F", system, sample_time=sample_time)
    run = Execution(form_diagram([block], sample_time))
    exact = exact_answer(system, sample_time, 1200, 600)
    found = [float(run.step({"In": float(k < 600)})["Out"]) for k in range(1200)]
    assert np.abs(np.array(found) - exact).max() < 1e-3 * np.abs(exact).max()


@pytest.mark.parametrize("method", list(IntegrationMethod))
def test_roots_are_mapped_as_the_method_says(method: IntegrationMethod) -> None:
    """Against python-control's mapping of the polynomials, at frequencies."""
    names = {"forward Euler": "euler", "Tustin": "bilinear", "backward Euler": "backward_diff"}
    zeros, poles = (-3.0,), (-1.0, -5 + 4j, -5 - 4j)
    own = ZeroPoleGain(zeros, poles, 2.5).sampled(0.01, method)
    wanted = control.sample_system(control.zpk(zeros, poles, 2.5), 0.01, names[method.value])
    frequencies = np.geomspace(0.1, 300, 20)
    assert np.allclose(own.response(frequencies), wanted(np.exp(1j * frequencies * 0.01)))


def test_polynomials_that_do_not_fix_the_response_are_refused() -> None:
    """Five poles at 1 rad/s every millisecond: sixteen digits are too few, their roots are not."""
    slow = 1 - 1e-3
    system = control.tf([1.0], np.poly([slow] * 5), 0.001)
    with pytest.raises(DesignError, match=r"block 'F': the coefficients do not .*give the roots"):
        transfer_function_block("F", system)
    roots = ZeroPoleGain((), (slow - 1,) * 5, 1e-15, 0.001)
    assert last_output(form_diagram([transfer_function_block("F", roots)], 0.001), 6000) > 0.5


def test_an_integrator_beside_a_lag_is_one_although_its_coefficients_are_rounded() -> None:
    """The product of z - 1 and z - 0.9048 in double precision."""
    system = control.tf([1.0, 0.0], np.convolve([1, -1], [1, -0.9048]), 0.01)
    assert 0 in ZeroPoleGain.of(system).poles


def refused(make: Callable[[], Block | ZeroPoleGain]) -> str:
    """The sentence."""
    with pytest.raises((DesignError, ValueError)) as caught:
        make()
    return str(caught.value)


def test_what_is_no_controller_is_refused_with_a_sentence() -> None:
    """More zeros than poles, half a pair, a number."""
    assert "at least as many poles" in refused(lambda: ZeroPoleGain((1.0,), (), 1.0))
    assert "conjugate pairs" in refused(lambda: ZeroPoleGain((), (1j,), 1.0))
    number = ZeroPoleGain((), (), 2.0, 0.01)
    assert "use a Gain" in refused(lambda: transfer_function_block("F", number))


def test_a_finite_impulse_response_stays_a_polynomial() -> None:
    """Its poles are all at 0, where a polynomial is exact."""
    block = transfer_function_block("F", control.tf([0.5, 0.25, 0.25], [1, 0, 0], 0.01))
    assert isinstance(block, DiscreteTransferFunction)


def test_a_zero_at_the_rate_of_the_method_goes_to_infinity() -> None:
    """(s - 200) (s + 3) / ((s + 1) (s + 2)) at 10 ms: by Tustin's method 200 has no place in z."""
    system = ZeroPoleGain((200 + 0j, -3 + 0j), (-1 + 0j, -2 + 0j), 1.0)
    sampled = system.sampled(0.01)
    expected = control.sample_system(control.zpk([200, -3], [-1, -2], 1), 0.01, "bilinear")
    frequencies = np.array([1.0, 10.0, 100.0, 300.0])
    wanted = expected(np.exp(1j * frequencies * 0.01))
    assert sampled.response(frequencies) == pytest.approx(wanted, rel=1e-9)
