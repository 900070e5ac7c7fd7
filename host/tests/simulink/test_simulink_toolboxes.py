# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks of toolboxes that signals express: linear systems, PID with two degrees of freedom."""

from __future__ import annotations

from pathlib import Path

import control
import numpy as np
import pytest
from verification.support.codegen.simulink_files import block, line, run, single_file

from ravenbrick.simulink import ModelSource, import_simulink, read_workspace, survey_simulink
from ravenbrick.simulink.numbers import Workspace
from ravenbrick.simulink.simulate import Simulation, simulate

LTI = "cstblocks/LTI System"


def step_into(**parameters: str) -> str:
    """A step at 0 into a block of a library, with a scope."""
    root = block("Step", "r", 1, Time="0") + block("Reference", "B", 2, **parameters)
    root += block("Scope", "S", 3) + line("1#out:1", "2#in:1")
    return root + line("2#out:1", "3#in:1")


def simulated(path: Path, root: str, program: str = "") -> Simulation:
    """A model whose variables a program gives, for 1 s."""
    script = path.with_suffix(".m")
    script.write_text(program)
    variables = read_workspace(script)
    return simulate(ModelSource(single_file(path, root), 0.0, variables, ()), 1.0)


PLANT = control.tf([2, 3], [1, 4, 5])
SYSTEMS = {
    "an expression": ("tf([2 3], [1 4 5])", ""),
    "a transfer function": ("G", "G = tf([2 3], [1 4 5]);"),
    "a state space": ("G", "G = ss([0 1; -5 -4], [0; 1], [3 2], 0);"),
    "a product": ("2*G", "G = tf([1 1.5], [1 4 5]);"),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_linear_system_answers_as_python_controls(name: str, tmp_path: Path) -> None:
    """(2 s + 3) / (s^2 + 4 s + 5), however it is written."""
    text, program = SYSTEMS[name]
    found = simulated(tmp_path / "m.slx", step_into(SourceBlock=LTI, sys=text, IC="[]"), program)
    _, expected = control.step_response(PLANT, found.times)
    assert found.signals[0].values == pytest.approx(expected, abs=1e-7)


def test_a_sampled_system_runs_at_its_own_rate(tmp_path: Path) -> None:
    """z / (z - 0.5) at 0.1 s: a staircase of 2 - 0.5^k."""
    root = step_into(SourceBlock=LTI, sys="C", IC="[]")
    found = simulated(tmp_path / "m.slx", root, "C = tf([1 0], [1 -0.5], 0.1);")
    assert found.sample_time == 0.1
    at = [int(np.argmin(np.abs(found.times - (0.1 * k + 0.05)))) for k in range(10)]
    expected = [2 - 0.5**k for k in range(10)]
    assert found.signals[0].values[at] == pytest.approx(expected, abs=1e-9)


def test_a_system_begins_at_its_initial_states_and_has_all_outputs(tmp_path: Path) -> None:
    """Two states that decay, both of them outputs."""
    root = step_into(SourceBlock=LTI, sys="ss([-1 0; 0 -2], [0; 0], eye(2), [0; 0])", IC="[3 5]")
    found = simulated(tmp_path / "m.slx", root)
    decay = [3 * np.exp(-found.times), 5 * np.exp(-2 * found.times)]
    for signal, expected in zip(found.signals, decay, strict=True):
        assert signal.values == pytest.approx(expected, abs=1e-7)


def test_a_linear_system_becomes_a_sampled_block(tmp_path: Path) -> None:
    """By Tustin's method, as a transfer function's block does."""
    one = step_into(SourceBlock=LTI, sys="tf(1, [0.5 1])", IC="[]")
    two = step_into(Numerator="1", Denominator="[0.5 1]").replace("Reference", "TransferFcn")
    found = [run(import_simulink(single_file(tmp_path / "m.slx", t), 0.01)) for t in (one, two)]
    assert np.any(found[0]) and np.array_equal(found[0], found[1])


@pytest.mark.parametrize("form", ["Parallel", "Ideal"])
def test_a_pid_of_two_degrees_weighs_its_reference(form: str, tmp_path: Path) -> None:
    """P (b r - y) + I/s (r - y) + D N s/(s + N) (c r - y), here with y = t and r = 1."""
    root = block("Constant", "r", 1, Value="1") + block("Clock", "t", 2)
    root += block("Reference", "B", 3, SourceBlock="slpidlib/PID Controller (2DOF)", Form=form,
                  Controller="PID", P="2", I="3", D="0.5", N="40", b="0.25", c="0.75",
                  Ports="[2, 1]")  # fmt: skip
    root += block("Scope", "S", 4) + line("1#out:1", "3#in:1") + line("2#out:1", "3#in:2")
    path = single_file(tmp_path / "m.slx", root + line("3#out:1", "4#in:1"))
    found = simulate(ModelSource(path, 0.0, Workspace({}), ()), 1.0)
    t, all_of = found.times, 2.0 if form == "Ideal" else 1.0
    rate = 0.75 * 40 * np.exp(-40 * t) - (1 - np.exp(-40 * t))
    expected = 2 * (0.25 - t) + all_of * (3 * (t - t**2 / 2) + 0.5 * rate)
    assert found.signals[0].values == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("library", ["slctrlblks", "simulink"])
def test_blocks_that_only_check_are_left_out(library: str, tmp_path: Path) -> None:
    """Of any library of model verification; no refusal, no output."""
    root = block("Constant", "C", 1, Value="3") + block("Outport", "y", 2)
    root += block("Reference", "K", 3, SourceBlock=f"{library}/Model&#10;Verification/Check Bode")
    path = single_file(tmp_path / "m.slx", root + line("1#out:1", "2#in:1", "3#in:1"))
    assert not survey_simulink(path).refusals
    assert run(import_simulink(path, 0.01))[-1] == 3.0
