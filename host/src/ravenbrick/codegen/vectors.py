# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Steps of a diagram with their expected results, to compare the C wherever it runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ravenbrick.codegen.c_text import c_literal
from ravenbrick.errors import DesignError
from ravenbrick.model import DataType, Diagram, Execution
from ravenbrick.model.program import Slot

__all__ = ["StepVectors", "check_program", "random_vectors"]


@dataclass(frozen=True, eq=False)
class StepVectors:
    """Successive steps of one instance: `inputs` (steps, inputs), `outputs` (steps, outputs),

    both float32, columns in the order of the diagram's ports.
    """

    model: str
    inputs: npt.NDArray[np.float32]
    outputs: npt.NDArray[np.float32]


def random_vectors(
    diagram: Diagram, count: int, seed: int, largest: float = 12.0, exact_share: float = 0.25
) -> StepVectors:
    """`count` steps with inputs between -`largest` and `largest`, the same for the same seed.

    A share of the inputs is held from the step before or is 0, so that limits are reached and left
    and differences cancel.
    """
    execution = Execution(diagram)
    program = execution.program
    _require_real32((*program.inputs, *program.outputs))
    generator = np.random.default_rng(seed)
    inputs = generator.uniform(-largest, largest, (count, len(program.inputs))).astype(np.float32)
    choice = generator.random(inputs.shape)
    inputs[choice < exact_share / 2] = 0.0
    held = choice > 1 - exact_share
    for step in range(1, count):
        inputs[step] = np.where(held[step], inputs[step - 1], inputs[step])
    outputs = np.empty((count, len(program.outputs)), dtype=np.float32)
    for step in range(count):
        row = {
            slot.name: float(value)
            for slot, value in zip(program.inputs, inputs[step], strict=True)
        }
        outputs[step] = list(execution.step(row).values())
    return StepVectors(program.name, inputs, outputs)


def _require_real32(slots: tuple[Slot, ...]) -> None:
    for slot in slots:
        if slot.data_type is not DataType.REAL32:
            raise DesignError(
                f"port '{slot.name}' is {slot.data_type.value}; vectors are made for real32_T"
            )


def check_program(vectors: StepVectors) -> str:
    """C with `void <model>_check(void)`, which runs the vectors on a new instance.

    Afterwards `<model>_check_steps` holds the number of steps done and `<model>_check_failures`
    that of the steps with any other bit in an output. Without C library, for host and brick.
    """
    name, count = vectors.model, len(vectors.inputs)
    rows = []
    for given, expected in zip(vectors.inputs, vectors.outputs, strict=True):
        values = [c_literal(float(value), DataType.REAL32) for value in given]
        bits = [f"0x{value:08X}U" for value in expected.view(np.uint32)]
        rows.append(f"  {{ {{ {', '.join(values)} }}, {{ {', '.join(bits)} }} }}")
    width = vectors.outputs.shape[1]
    return f"""\
#include "{name}.h"

typedef struct {{
  ExternalInputs_{name} inputs;
  uint32_T outputs[{width}];
}} Check_Step;

typedef union {{
  ExternalOutputs_{name} outputs;
  uint32_T bits[{width}];
}} Check_Result;

static const Check_Step check_steps[{count}] = {{
{("," + chr(10)).join(rows)}
}};

volatile uint32_T {name}_check_steps;
volatile uint32_T {name}_check_failures;

extern void {name}_check(void);

void {name}_check(void)
{{
  D_Work_{name} work;
  uint32_T step;
  uint32_T port;
  {name}_check_steps = 0U;
  {name}_check_failures = 0U;
  {name}_initialize_instance(&work);
  for (step = 0U; step < {count}U; step++) {{
    Check_Result result;
    uint32_T differs = 0U;
    {name}_step_instance(&work, &check_steps[step].inputs, &result.outputs);
    for (port = 0U; port < {width}U; port++) {{
      differs |= result.bits[port] ^ check_steps[step].outputs[port];
    }}
    if (differs != 0U) {{
      {name}_check_failures = {name}_check_failures + 1U;
    }}
    {name}_check_steps = step + 1U;
  }}
}}
"""
