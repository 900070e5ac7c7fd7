# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Values that random numbers do not hit: halves, neighbours of halves, numbers without fraction."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest
from verification.support.codegen.c_build import host_library

from ravenbrick.codegen import StepVectors, check_program, generate_c, random_vectors
from ravenbrick.model import (
    Diagram,
    Execution,
    FixedPointOptions,
    Gain,
    Inport,
    Outport,
    Rounding,
    RoundingFunction,
    Sum,
    to_fixed_point,
)
from ravenbrick.model.number_format import FixedFormat

# Around 2**23 a number in single precision has its last bit for a half, then for a whole one.
VALUES = [0.0, 0.5, 1.5, 2.5, 3.5, 0.49999997, 0.50000006, 1.4999999, 11.5, 4194303.5, 4194304.5]
VALUES += [8388607.5, 8388607.0, 8388608.0, 8388609.0, 16777217.0, 3e9, 1e20]
WHOLE = {
    "round": lambda x: np.copysign(np.floor(np.abs(x) + 0.5), x),
    "floor": np.floor,
    "ceil": np.ceil,
    "fix": np.trunc,
}


@pytest.mark.parametrize("function", WHOLE)
def test_rounding_in_simulation_and_c_is_that_of_its_definition(
    function: str, tmp_path: Path
) -> None:
    """Halves away from zero, both signs, and beyond the last number with a fraction."""
    diagram = Diagram(f"exact_{function}", 0.01)
    diagram.connect_chain(
        diagram.add(Inport("In")),
        diagram.add(RoundingFunction("B", function=function)),
        diagram.add(Outport("Out")),
    )
    inputs = np.array([[v] for value in VALUES for v in (value, -value)], np.float32)
    expected = WHOLE[function](inputs.astype(np.float64)).astype(np.float32)
    execution = Execution(diagram)
    simulated = [list(execution.step({"In": float(v)}).values()) for (v,) in inputs]
    assert np.array(simulated, np.float32).tolist() == expected.tolist()
    generate_c(diagram).write(tmp_path)
    # A zero's sign is not a value: both zeros are equal, but not bit for bit.
    own = np.array(simulated, np.float32)
    vectors = StepVectors(diagram.name, inputs, own)
    name = diagram.name
    (tmp_path / "check.c").write_text(check_program(vectors))
    (tmp_path / "ports.c").write_text(
        f'#include "{name}.h"\nExternalInputs_{name} {name}_U;\nExternalOutputs_{name} {name}_Y;\n'
    )
    library = host_library(tmp_path, f"{name}.c", "check.c", "ports.c")
    getattr(library, f"{name}_check")()
    assert ctypes.c_uint32.in_dll(library, f"{name}_check_failures").value == 0


@pytest.mark.parametrize("rounding", Rounding)
def test_fixed_point_of_unequal_ranges_follows_the_real_sum(rounding: Rounding) -> None:
    """Inputs with fractions that differ by ten bits meet at one; the error stays below a step."""
    diagram = Diagram("unequal", 0.01)
    total = diagram.add(Sum("Total", signs="+-"))
    for port, (name, gain) in enumerate((("Fine", 1.0), ("Coarse", 0.125))):
        scale = diagram.add(Gain(f"Gain{port}", gain=gain))
        diagram.connect(diagram.add(Inport(name)), scale)
        diagram.connect(scale, total, port)
    diagram.connect_chain(total, diagram.add(Outport("Out")))
    options = FixedPointOptions({"Fine": 0.9, "Coarse": 900.0}, rounding=rounding)
    fixed = to_fixed_point(diagram, options).program
    execution = Execution(fixed)
    formats = [slot.data_type for slot in (*fixed.inputs, *fixed.outputs)]
    steps = [found.lsb for found in formats if isinstance(found, FixedFormat)]
    assert steps[1] >= 512 * steps[0]
    generator = np.random.default_rng(1)
    for fine, coarse in generator.uniform(-1, 1, (200, 2)) * (0.9, 900.0):
        raw = {"Fine": round(fine / steps[0]), "Coarse": round(coarse / steps[1])}
        (out,) = execution.step(raw).values()
        real = raw["Fine"] * steps[0] - 0.125 * raw["Coarse"] * steps[1]
        assert out * steps[2] == pytest.approx(real, abs=1.01 * steps[2])


def test_random_inputs_fill_the_range_and_are_often_exact() -> None:
    """Close to both ends; many are zero or the one before, so that differences cancel."""
    diagram = Diagram("straight", 0.01)
    diagram.connect_chain(
        diagram.add(Inport("In")), diagram.add(Gain("B", gain=1.0)), diagram.add(Outport("Out"))
    )
    for largest in (12.0, 500.0):
        given = {} if largest == 12.0 else {"largest": largest}
        values = random_vectors(diagram, 2000, seed=1, **given).inputs[:, 0]
        assert 0.99 * largest < values.max() <= largest
        assert -largest <= values.min() < -0.99 * largest
        assert 0.1 < np.mean(values == 0) < 0.2
        assert 0.2 < np.mean(values[1:] == values[:-1]) < 0.35
