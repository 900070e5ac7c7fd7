# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every block's C against its simulation, bit for bit, and what fixed point makes of it."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from verification.support.codegen.block_table import TABLE, block_diagram, wide_diagram
from verification.support.codegen.c_build import arm_image, host_library
from verification.support.codegen.emulation import run_on_arm

from ravenbrick.codegen import check_program, generate_c, random_vectors
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, FixedPointOptions, to_fixed_point
from ravenbrick.model.program import Program

STEPS = 300
ARM_STEPS = 100
DIAGRAMS = {
    **{name: block_diagram(name) for name in TABLE},
    **{f"wide_{name}": wide_diagram(name) for name in TABLE},
}
INTEGRATORS = ("forward_euler", "tustin", "backward_euler", "pid")
# Functions of numbers have no integer twin, or need more bits than there are.
NOT_FIXED = (
    "custom",
    "sine",
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
    return replace(to_fixed_point(diagram, FixedPointOptions(ranges)).program, name=f"fixed_{name}")


def write(models: dict[str, Diagram | Program], folder: Path, steps: int) -> list[str]:
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


def all_models() -> dict[str, Diagram | Program]:
    """Single, double precision and fixed point."""
    return {**DIAGRAMS, **{f"fixed_{name}": fixed_program(name) for name in FIXED}}


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """All models compiled into one library, with all warnings as errors."""
    folder = tmp_path_factory.mktemp("blocks")
    return host_library(folder, *write(all_models(), folder, STEPS))


@pytest.mark.parametrize("name", [*DIAGRAMS, *(f"fixed_{name}" for name in FIXED)])
def test_each_block_in_c_equals_its_simulation_bit_for_bit(name: str, library: ctypes.CDLL) -> None:
    """Random steps; no bit of the output differs."""
    getattr(library, f"{name}_check")()
    assert ctypes.c_uint32.in_dll(library, f"{name}_check_steps").value == STEPS
    assert ctypes.c_uint32.in_dll(library, f"{name}_check_failures").value == 0


@pytest.mark.parametrize("name", [*DIAGRAMS, *(f"fixed_{name}" for name in FIXED)])
def test_the_random_steps_exercise_the_block(name: str) -> None:
    """The compared outputs are not all alike."""
    outputs = random_vectors(all_models()[name], 200, seed=13).outputs
    assert len(np.unique(outputs)) >= (1 if "constant" in name else 2)


def test_all_blocks_on_the_arm_equal_their_simulation(tmp_path: Path) -> None:
    """Single precision and fixed point on an emulated ARM, soft float of the brick."""
    emulation = pytest.importorskip(
        "unicorn", reason="the Python package unicorn (an ARM emulator) is not installed"
    )
    models = {name: model for name, model in all_models().items() if not name.startswith("wide_")}
    files = write(models, tmp_path, ARM_STEPS)[:-1]
    calls = "".join(f"  {name}_check();\n" for name in models)
    declared = "".join(f"extern void {name}_check(void);\n" for name in models)
    head = f"{declared}extern void all_checks(void);\n"
    (tmp_path / "all.c").write_text(f"{head}void all_checks(void)\n{{\n{calls}}}\n")
    image = arm_image(tmp_path, "all_checks", "all.c", *files)
    value = run_on_arm(emulation, image, "all_checks")
    for name in models:
        assert value(f"{name}_check_steps") == ARM_STEPS, name
        assert value(f"{name}_check_failures") == 0, name


@pytest.mark.parametrize("name", NOT_FIXED)
def test_a_block_without_fixed_point_says_so(name: str) -> None:
    """By name, with what to use instead."""
    ranges = {slot.block: 10.0 for slot in block_diagram(name).lower().inputs}
    with pytest.raises(
        DesignError,
        match=r"block .B..*(LookupTable|keeps too few bits)|no accumulator of 32 bits",
    ):
        to_fixed_point(block_diagram(name), FixedPointOptions(ranges))
