# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every block as a diagram, in fixed point, and as C with checks against its simulation."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from ravenbrick.codegen import check_program, generate_c, random_vectors
from ravenbrick.model import Diagram, FixedPoint, FixedPointOptions, to_fixed_point
from ravenbrick.model.program import Program

from verification.support.codegen.block_table import TABLE, block_diagram, wide_diagram

DIAGRAMS = {
    **{name: block_diagram(name) for name in TABLE},
    **{f"wide_{name}": wide_diagram(name) for name in TABLE},
}
INTEGRATORS = ("forward_euler", "tustin", "backward_euler", "pid", "delta_transfer_function")
# Functions of numbers have no integer twin, or need more bits than there are.
NOT_FIXED = (
    "custom",
    "ramp",
    "quotient",
    "sine_of",
    "cosine_of",
    "arc_tangent",
    "square_root",
)
FIXED = tuple(name for name in TABLE if name not in NOT_FIXED)
# States that nothing else bounds.
STATE_RANGES = {**dict.fromkeys(INTEGRATORS, 30.0), "rate_limit": 12.0}


def fixed_program(name: str) -> Program:
    """The block in fixed point, inputs within 10; states saturate at `STATE_RANGES`."""
    diagram = block_diagram(name)
    ports = {slot.block: 10.0 for slot in diagram.lower().inputs}
    ranges = {**ports, "B": STATE_RANGES[name]} if name in STATE_RANGES else ports
    options = FixedPointOptions(ranges, accumulator_bits=32, tolerance=None)
    return replace(to_fixed_point(diagram, options).program, name=f"fixed_{name}")


def wide_program(name: str) -> FixedPoint:
    """The block in fixed point with sums of 64 bits, otherwise as `fixed_program`."""
    diagram = block_diagram(name)
    ranges = {slot.block: 10.0 for slot in diagram.lower().inputs}
    if name in STATE_RANGES:
        ranges["B"] = STATE_RANGES[name]
    return to_fixed_point(diagram, FixedPointOptions(ranges, accumulator_bits=64))


def write_checks(models: dict[str, Diagram | Program], folder: Path, steps: int) -> list[str]:
    """C and checks of all models; returns the files' names."""
    files = []
    for name, source in models.items():
        generate_c(source).write(folder)
        vectors = random_vectors(source, steps, seed=13)
        (folder / f"{name}_check.c").write_text(check_program(vectors))
        files += [f"{name}.c", f"{name}_check.c"]
    ports = [
        f'#include "{name}.h"\nExternalInputs_{name} {name}_U;\nExternalOutputs_{name} {name}_Y;\n'
        for name in models
    ]
    (folder / "ports.c").write_text("".join(ports))
    return [*files, "ports.c"]


@cache
def all_models() -> dict[str, Diagram | Program]:
    """Single, double precision and fixed point."""
    return {**DIAGRAMS, **{f"fixed_{name}": fixed_program(name) for name in FIXED}}
