# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Algebraic loops and transport delays of simulated models, against exact solutions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from verification.support.codegen.simulink_files import block, line, single_file

from ravenbrick.errors import DesignError
from ravenbrick.simulink import ModelSource, import_simulink
from ravenbrick.simulink.numbers import Workspace
from ravenbrick.simulink.simulate import Simulation, simulate


def run(path: Path, root: str, stop: float, sample_time: float = 0.0) -> Simulation:
    """A model of these blocks, simulated."""
    return simulate(ModelSource(single_file(path, root), sample_time, Workspace({}), ()), stop)


def values(found: Simulation, name: str) -> np.ndarray:
    """The values of a signal."""
    return next(signal.values for signal in found.signals if signal.name == name)


def fed_back(source: str, *forward: str) -> str:
    """A source less the last block's output, through blocks numbered 3, 4, ... with a scope."""
    last = len(forward) + 2
    root = source + block("Sum", "E", 2, Inputs="+-") + "".join(forward)
    root += block("Scope", "S", 99) + line("1#out:1", "2#in:1")
    root += "".join(line(f"{n}#out:1", f"{n + 1}#in:1") for n in range(2, last))
    return root + line(f"{last}#out:1", "99#in:1", "2#in:2")


SINE = block("Sin", "r", 1, Frequency="3", Amplitude="2")


def test_a_loop_of_gains_has_the_value_of_its_equation(tmp_path: Path) -> None:
    """y = 4 (r - y): four fifths of the source at every instant."""
    found = run(tmp_path / "m.slx", fed_back(SINE, block("Gain", "K", 3, Gain="4")), 2.0)
    assert found.algebraic_loops == 1
    assert values(found, "K") == pytest.approx(1.6 * np.sin(3 * found.times), abs=1e-8)


def test_a_loop_through_an_exponential_is_solved(tmp_path: Path) -> None:
    """y = exp(r - y): the function of Lambert of exp(r)."""
    from scipy.special import lambertw

    found = run(tmp_path / "m.slx", fed_back(SINE, block("Math", "X", 3, Operator="exp")), 2.0)
    expected = np.real(lambertw(np.exp(2 * np.sin(3 * found.times))))
    assert values(found, "X") == pytest.approx(expected, abs=1e-8)


def test_a_loop_around_direct_feedthrough_is_the_closed_loop(tmp_path: Path) -> None:
    """(s + 2) / (s + 1) with unit feedback is (s + 2) / (2 s + 3)."""
    plant = block("TransferFcn", "P", 3, Numerator="[1 2]", Denominator="[1 1]")
    found = run(tmp_path / "m.slx", fed_back(block("Step", "r", 1, Time="0"), plant), 3.0)
    expected = 2 / 3 - np.exp(-1.5 * found.times) / 6
    assert values(found, "P") == pytest.approx(expected, abs=1e-7)


def test_a_sampled_loop_is_closed_at_its_samples(tmp_path: Path) -> None:
    """A filter with direct feedthrough: y[k] = e[k] + y[k-1] / 2 with e = 1 - y."""
    plant = block("DiscreteTransferFcn", "P", 3, Numerator="[1 0]", Denominator="[1 -0.5]",
                  SampleTime="0.1")  # fmt: skip
    found = run(tmp_path / "m.slx", fed_back(block("Step", "r", 1, Time="0"), plant), 1.0)
    at = [int(np.argmin(np.abs(found.times - (0.1 * k + 0.05)))) for k in range(10)]
    expected, last = [], 0.0
    for _ in range(10):
        last = (1 + 0.5 * last) / 2
        expected.append(last)
    assert values(found, "P")[at] == pytest.approx(expected, abs=1e-9)


def test_a_loop_without_a_solution_is_refused_with_its_instant(tmp_path: Path) -> None:
    """y = 2 + y has none."""
    root = block("Step", "r", 1, Time="0", After="2") + block("Sum", "P", 2, Inputs="++")
    root += block("Scope", "S", 3) + line("1#out:1", "2#in:1")
    root += line("2#out:1", "2#in:2", "3#in:1")
    with pytest.raises(DesignError, match=r"algebraic loop .* no solution .* at 0 s"):
        run(tmp_path / "m.slx", root, 1.0)


def test_no_c_is_made_of_a_loop(tmp_path: Path) -> None:
    """The sampled program has no place for its solution."""
    path = single_file(tmp_path / "m.slx", fed_back(SINE, block("Gain", "K", 3, Gain="4")))
    with pytest.raises(DesignError, match="algebraic loop"):
        import_simulink(path, 0.01).order()


def test_a_delay_is_the_input_of_before(tmp_path: Path) -> None:
    """Of a sine, with its initial output until then."""
    root = SINE + block("TransportDelay", "D", 2, DelayTime="0.7", InitialOutput="-1")
    root += block("Scope", "S", 3) + line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    found = run(tmp_path / "m.slx", root, 3.0)
    late = found.times - 0.7
    expected = np.where(late < -1e-9, -1.0, 2 * np.sin(3 * late))
    jump = np.abs(late) < 1e-6
    assert values(found, "D")[~jump] == pytest.approx(expected[~jump], abs=1e-6)


def test_a_loop_with_a_delay_follows_the_method_of_steps(tmp_path: Path) -> None:
    """y' = 1 - y(t - 1): polynomials from one delay to the next (Bellman and Cooke, 1963)."""
    parts = block("Integrator", "Y", 3), block("TransportDelay", "D", 4, DelayTime="1")
    root = fed_back(block("Step", "r", 1, Time="0"), *parts) + block("Scope", "T", 98)
    found = run(tmp_path / "m.slx", root + line("3#out:1", "98#in:1"), 3.0)
    t = found.times
    first = t
    second = 1 + (t - 1) - (t - 1) ** 2 / 2
    at_two = 1.5
    third = at_two + (t - 2) - ((t - 2) + (t - 2) ** 2 / 2 - (t - 2) ** 3 / 6)
    expected = np.select([t <= 1, t <= 2], [first, second], third)
    assert values(found, "Y") == pytest.approx(expected, abs=1e-6)
