# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles of the paper's controller in fixed point on the virtual brick, for inputs of all sizes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from verification.support.codegen.brick_cycles import Cost, image_of_checks, step_costs
from verification.support.codegen.c_build import WORD_FLAGS, ada_object
from verification.support.codegen.paper_pi import fixed_pi

from ravenbrick.codegen import StepVectors, check_program, generate_ada, generate_c
from ravenbrick.model import Execution, Rounding
from ravenbrick.model.program import Program, with_constants

GOAL_CYCLES = 45


def vectors_of_all_sizes(program: Program) -> StepVectors:
    """Inputs of 0 to 15 bits, errors from nothing to the whole range, integral at its limits."""
    random, execution = np.random.default_rng(8), Execution(program)
    rows = []
    for bits in [*range(16), 15, 15, *range(15, -1, -1)]:
        reference = int(random.integers(-(2**bits), 2**bits))
        near = min(max(4 * reference + int(random.integers(-9, 10)), -32768), 32767)
        rows.append((reference, int(random.choice([near, 0, -near - 1]))))
    inputs = np.array(rows, dtype=np.int32)
    names = [slot.name for slot in program.inputs]
    outputs = [
        list(execution.step(dict(zip(names, map(int, row), strict=True))).values())
        for row in inputs
    ]
    ports = tuple(slot.name for slot in program.outputs)
    return StepVectors(program.name, inputs, np.array(outputs, dtype=np.int32), ports)


def costs(folder: Path) -> dict[str, Cost]:
    """C and Ada with constant gains, and the tunable C; all outputs are as simulated."""
    program = fixed_pi(Rounding.NEAREST).program
    programs = {
        "constant": replace(with_constants(program), name="constant"),
        "tunable": replace(program, name="tunable"),
        "in_ada": replace(program, name="in_ada"),
    }
    sources = []
    for name, one in programs.items():
        generate_c(one).write(folder)
        (folder / f"{name}_check.c").write_text(check_program(vectors_of_all_sizes(one)))
        ports = f"ExternalInputs_{name} {name}_U;\nExternalOutputs_{name} {name}_Y;\n"
        (folder / f"{name}_ports.c").write_text(f'#include "{name}.h"\n{ports}')
        sources += [f"{name}_check.c", f"{name}_ports.c"]
        sources += [] if name == "in_ada" else [f"{name}.c"]
    generate_ada(programs["in_ada"], c_names=True).write(folder)
    ada = ada_object(folder, "in_ada.adb", checks=False)
    image = image_of_checks(folder, programs, sources, (ada,), WORD_FLAGS)
    found, brick = step_costs(image, {name: f"{name}_step_instance" for name in programs})
    assert all(brick.read_int(f"{name}_check_failures", "u32") == 0 for name in programs)
    return found


def test_the_controller_takes_at_most_45_cycles_whatever_its_inputs(tmp_path: Path) -> None:
    """With constant gains: the same number of cycles in every step, at most 112 bytes."""
    found = costs(tmp_path)
    constant = found["constant"]
    assert constant.least_cycles == constant.most_cycles <= GOAL_CYCLES
    assert constant.size_bytes <= 112
    assert constant.most_cycles < found["tunable"].most_cycles
    assert found["in_ada"].least_cycles == found["in_ada"].most_cycles <= GOAL_CYCLES + 5
