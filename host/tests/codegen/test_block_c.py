# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every block's C against its simulation, bit for bit, and what fixed point makes of it."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest
from verification.support.codegen.block_programs import (
    DIAGRAMS,
    FIXED,
    NOT_FIXED,
    all_models,
    write_checks,
)
from verification.support.codegen.block_table import block_diagram
from verification.support.codegen.c_build import arm_image, host_library
from verification.support.codegen.emulation import run_on_arm

from ravenbrick.codegen import random_vectors
from ravenbrick.errors import DesignError
from ravenbrick.model import FixedPointOptions, to_fixed_point

STEPS = 300
ARM_STEPS = 100


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """All models compiled into one library, with all warnings as errors."""
    folder = tmp_path_factory.mktemp("blocks")
    return host_library(folder, *write_checks(all_models(), folder, STEPS))


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
    files = write_checks(models, tmp_path, ARM_STEPS)[:-1]
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
        to_fixed_point(block_diagram(name), FixedPointOptions(ranges, accumulator_bits=32))
