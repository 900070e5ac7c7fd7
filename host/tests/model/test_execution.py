# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagram's simulation against python-control and by hand."""

from __future__ import annotations

import control
import numpy as np
import pytest

from ravenbrick import model

DOUBLE = model.DataType.REAL64


def single(block: model.Block) -> model.Diagram:
    """One block between an input and an output."""
    diagram = model.Diagram("single", 0.1)
    source = diagram.add(model.Inport("In", block.data_type))
    diagram.add(block)
    diagram.connect_chain(source, block, diagram.add(model.Outport("Out", block.data_type)))
    return diagram


def run(diagram: model.Diagram, inputs: np.ndarray) -> np.ndarray:
    """Outputs of successive steps."""
    execution = model.Execution(diagram)
    return np.array([execution.step({"In": value})["Out"] for value in inputs])


CASES = [
    (model.Gain("B", DOUBLE, gain=-2.5), ([-2.5], [1.0])),
    (model.UnitDelay("B", DOUBLE), ([1.0], [1.0, 0.0])),
    (model.DiscreteIntegrator("B", DOUBLE, gain=0.1), ([0.1], [1.0, -1.0])),
    (
        model.DiscreteIntegrator("B", DOUBLE, gain=0.1, method=model.IntegrationMethod.TUSTIN),
        ([0.05, 0.05], [1.0, -1.0]),
    ),
    (
        model.DiscreteIntegrator(
            "B", DOUBLE, gain=0.1, method=model.IntegrationMethod.BACKWARD_EULER
        ),
        ([0.1, 0.0], [1.0, -1.0]),
    ),
    (
        model.DiscreteTransferFunction("B", DOUBLE, None, (0.5, 0.2, -0.1), (1.0, -0.9, 0.3)),
        ([0.5, 0.2, -0.1], [1.0, -0.9, 0.3]),
    ),
    (
        model.DiscreteTransferFunction("B", DOUBLE, None, (0.0, 0.2, 0.0), (1.0, 0.0, 0.25)),
        ([0.2, 0.0], [1.0, 0.0, 0.25]),
    ),
]


@pytest.mark.parametrize(("block", "expected"), CASES, ids=lambda value: type(value).__name__)
def test_each_linear_block_is_its_transfer_function(
    block: model.Block, expected: tuple[list[float], list[float]]
) -> None:
    """Execution and linearisation agree with python-control's response to a random input."""
    inputs = np.random.default_rng(1).normal(size=60)
    system = control.tf(*expected, 0.1)
    wanted = control.forced_response(system, U=inputs).outputs
    diagram = single(block)
    np.testing.assert_allclose(run(diagram, inputs), wanted, atol=1e-12)
    linear = control.forced_response(model.linearise(diagram), U=inputs).outputs
    np.testing.assert_allclose(np.ravel(linear), wanted, atol=1e-12)


def test_saturation_holds_both_limits_and_passes_the_rest() -> None:
    """Values beyond the limit become the limit; the parameter can be changed while running."""
    diagram = single(model.Saturation("B", limit=model.Parameter("Limit", 2.0, "V", "limit")))
    assert run(diagram, np.array([-3.0, -2.0, 0.5, 2.5])).tolist() == [-2.0, -2.0, 0.5, 2.0]
    execution = model.Execution(diagram)
    execution.set_parameter("Limit", 1.0)
    assert execution.step({"In": 1.5})["Out"] == 1.0
    with pytest.raises(KeyError, match="no parameter 'Other'; there are: Limit"):
        execution.set_parameter("Other", 1.0)


def test_single_precision_rounds_after_every_operation() -> None:
    """A sum that double precision would keep is lost in single precision."""
    diagram = single(model.DiscreteIntegrator("B", gain=1.0, initial=16777216.0))
    assert run(diagram, np.array([1.0, 1.0, 0.0])).tolist() == [16777216.0] * 3


def test_reset_restores_the_initial_states() -> None:
    """After a reset the same inputs give the same outputs."""
    execution = model.Execution(single(model.UnitDelay("B", initial=3.0)))
    first = [float(execution.step({"In": value})["Out"]) for value in (1.0, 2.0)]
    execution.reset()
    assert first == [3.0, 1.0]
    assert float(execution.step({"In": 5.0})["Out"]) == 3.0
