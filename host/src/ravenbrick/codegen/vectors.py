# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Steps of a diagram with their expected results, to compare the C wherever it runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ravenbrick.codegen.c.text import c_literal
from ravenbrick.errors import DesignError
from ravenbrick.model import DataType, Diagram, Execution
from ravenbrick.model.number_format import FixedFormat
from ravenbrick.model.program import Program, Slot, is_fixed_point

__all__ = ["StepVectors", "check_program", "random_vectors"]


@dataclass(frozen=True, eq=False)
class StepVectors:
    """Successive steps of one instance: `inputs` (steps, inputs), `outputs` (steps, outputs),

    columns in the order of the diagram's ports: float32, or raw int32 of a fixed-point program,
    whose outports are named in `integer_ports`.
    """

    model: str
    inputs: npt.NDArray[np.generic]
    outputs: npt.NDArray[np.generic]
    integer_ports: tuple[str, ...] = ()


def random_vectors(
    diagram: Diagram | Program,
    count: int,
    seed: int,
    largest: float = 12.0,
    exact_share: float = 0.25,
) -> StepVectors:
    """`count` steps with inputs between -`largest` and `largest`, the same for the same seed.

    A share of the inputs is held from the step before or is 0, so that limits are reached and left
    and differences cancel. Inputs of a fixed-point program take all values of their formats.
    """
    execution = Execution(diagram)
    program = execution.program
    integers = is_fixed_point(program)
    generator = np.random.default_rng(seed)
    shape = (count, len(program.inputs))
    if integers:
        low, high = np.transpose([_limits(slot) for slot in program.inputs])
        inputs = generator.integers(low, high, shape, dtype=np.int32, endpoint=True)
    else:
        _require_real32((*program.inputs, *program.outputs))
        inputs = generator.uniform(-largest, largest, shape).astype(np.float32)
    choice = generator.random(shape)
    inputs[choice < exact_share / 2] = 0
    held = choice > 1 - exact_share
    for step in range(1, count):
        inputs[step] = np.where(held[step], inputs[step - 1], inputs[step])
    outputs = np.empty((count, len(program.outputs)), dtype=inputs.dtype)
    for step in range(count):
        row = {
            slot.name: value.item()
            for slot, value in zip(program.inputs, inputs[step], strict=True)
        }
        outputs[step] = list(execution.step(row).values())
    ports = tuple(slot.name for slot in program.outputs) if integers else ()
    return StepVectors(program.name, inputs, outputs, ports)


def _limits(slot: Slot) -> tuple[int, int]:
    assert isinstance(slot.data_type, FixedFormat)
    return slot.data_type.limits


def _require_real32(slots: tuple[Slot, ...]) -> None:
    for slot in slots:
        if slot.data_type is not DataType.REAL32:
            raise DesignError(
                f"port '{slot.name}' is {slot.data_type.value}; vectors are made for real32_T"
            )


def check_program(vectors: StepVectors) -> str:
    """C with `void <model>_check(void)`, which runs the vectors on a new instance.

    Afterwards `<model>_check_steps` holds the number of steps done and `<model>_check_failures`
    that of the steps with any other bit in an output. Sign and payload of a NaN may differ, as
    IEEE 754, 6.2, leaves them to the machine. Without C library, for host and brick.
    """
    if vectors.integer_ports:
        return _integer_check_program(vectors)
    name, count = vectors.model, len(vectors.inputs)
    rows = []
    for given, expected in zip(vectors.inputs, vectors.outputs, strict=True):
        values = [c_literal(float(value), DataType.REAL32) for value in given] or ["0U"]
        bits = [f"0x{value:08X}U" for value in expected.view(np.uint32)]
        rows.append(f"  {{ {{ {', '.join(values)} }}, {{ {', '.join(bits)} }} }}")
    width = vectors.outputs.shape[1]
    return f"""\
#include <stdint.h>

#include "{name}.h"

typedef struct {{
  ExternalInputs_{name} inputs;
  uint32_t outputs[{width}];
}} Check_Step;

typedef union {{
  ExternalOutputs_{name} outputs;
  uint32_t bits[{width}];
}} Check_Result;

{_steps_and_counters(name, rows)}  uint32_t port;
  {name}_check_steps = 0U;
  {name}_check_failures = 0U;
  {name}_initialize_instance(&work);
  for (step = 0U; step < {count}U; step++) {{
    Check_Result result;
    uint32_t differs = 0U;
    {name}_step_instance(&work, &check_steps[step].inputs, &result.outputs);
    for (port = 0U; port < {width}U; port++) {{
      const uint32_t found = result.bits[port];
      const uint32_t expected = check_steps[step].outputs[port];
      const uint32_t infinite = 0x7F800000U;
      if (((found & 0x7FFFFFFFU) <= infinite) || ((expected & 0x7FFFFFFFU) <= infinite)) {{
        differs |= found ^ expected;
      }}
    }}
    if (differs != 0U) {{
      {name}_check_failures = {name}_check_failures + 1U;
    }}
    {name}_check_steps = step + 1U;
  }}
}}
"""


def _steps_and_counters(name: str, rows: Sequence[str]) -> str:
    """The table of steps, the counters, and the check up to its variables."""
    return f"""\
static const Check_Step check_steps[{len(rows)}] = {{
{("," + chr(10)).join(rows)}
}};

volatile uint32_t {name}_check_steps;
volatile uint32_t {name}_check_failures;

extern void {name}_check(void);

void {name}_check(void)
{{
  D_Work_{name} work;
  uint32_t step;
"""


def _integer_check_program(vectors: StepVectors) -> str:
    name, count = vectors.model, len(vectors.inputs)
    rows = [
        f"  {{ {{ {', '.join(map(str, given)) or '0U'} }}, {{ {', '.join(map(str, expected))} }} }}"
        for given, expected in zip(vectors.inputs, vectors.outputs, strict=True)
    ]
    tests = "\n".join(
        f"    differs |= (uint32_t)(result.{port} != check_steps[step].outputs.{port});"
        for port in vectors.integer_ports
    )
    return f"""\
#include <stdint.h>

#include "{name}.h"

typedef struct {{
  ExternalInputs_{name} inputs;
  ExternalOutputs_{name} outputs;
}} Check_Step;

{_steps_and_counters(name, rows)}  {name}_check_steps = 0U;
  {name}_check_failures = 0U;
  {name}_initialize_instance(&work);
  for (step = 0U; step < {count}U; step++) {{
    ExternalOutputs_{name} result;
    uint32_t differs = 0U;
    {name}_step_instance(&work, &check_steps[step].inputs, &result);
{tests}
    {name}_check_failures = {name}_check_failures + differs;
    {name}_check_steps = step + 1U;
  }}
}}
"""
