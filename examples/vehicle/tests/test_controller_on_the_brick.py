# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The generated controller on the virtual brick against the simulation of its diagram."""

from __future__ import annotations

import importlib.util
import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import virtual_brick
from ravenbrick.codegen import (
    StepVectors,
    check_program,
    generate_ada,
    generate_c,
    random_vectors,
)

from verification.support.bricks.programs import gprbuild

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
STEPS = 500
LIMIT_CYCLES = 48_054_857
BENCH = {
    "seed": 1,
    "battery": {"kind": "li_ion", "voltage": 8.0, "internal_resistance": 0.0},
    "body": {"kind": "bench"},
}


def design_module() -> ModuleType:
    """The vehicle's design.py."""
    specification = importlib.util.spec_from_file_location("design", HERE.parent / "design.py")
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def vectors() -> StepVectors:
    """Random steps with the outputs of the simulation."""
    return random_vectors(design_module().design().controller, STEPS, seed=5)


def run_check(
    vectors: StepVectors, folder: Path, code: str, *options: str, units: str = ""
) -> virtual_brick.VirtualBrick:
    """The check on the brick, after it has ended; `units` is what its Ada part names besides."""
    folder.mkdir(exist_ok=True)
    (folder / "controller_parts.ads").write_text(
        f"pragma Warnings (Off);\n{units}package Controller_Parts is\nend Controller_Parts;\n"
    )
    (folder / "functional_check.c").write_text(check_program(vectors))
    project = HERE / "controller_check" / "controller_check.gpr"
    gprbuild(project, *options, BUILD=folder, CODE=code, IMAGE="ram")
    elf = (folder / "controller_check.elf").read_bytes()
    brick = virtual_brick.VirtualBrick(json.dumps(BENCH), elf)
    brick.run_until(LIMIT_CYCLES)
    return brick


@pytest.mark.parametrize("code", ["arm", "thumb"])
def test_the_controller_gives_the_simulation_s_outputs_bit_for_bit(
    vectors: StepVectors, tmp_path: Path, code: str
) -> None:
    """All steps were done and none differs in any bit."""
    brick = run_check(vectors, tmp_path, code)
    assert brick.read_int("functional_check_steps", "u32") == STEPS
    assert brick.read_int("functional_check_failures", "u32") == 0


def test_the_controller_in_ada_gives_the_same(vectors: StepVectors, tmp_path: Path) -> None:
    """The generated Ada under the C's names, with the brick's own run-time, in place of the C."""
    diagram, folder = design_module().design().controller, tmp_path / "in_ada"
    generate_c(diagram).write(folder)
    (folder / "functional.c").unlink()
    generate_ada(diagram, c_names=True).write(folder)
    for name in ("controller_design.ads", "speed_controller.ads"):
        shutil.copy(HERE.parent / "generated" / name, folder)
    instead = f"-XGENERATED={folder}"
    brick = run_check(vectors, tmp_path / "build", "arm", instead, units="with Functional;\n")
    assert brick.read_int("functional_check_steps", "u32") == STEPS
    assert brick.read_int("functional_check_failures", "u32") == 0


def test_a_wrong_bit_in_one_step_is_found(vectors: StepVectors, tmp_path: Path) -> None:
    """The check can fail: one expected output is moved by one unit in the last place."""
    outputs = vectors.outputs.copy()
    outputs[STEPS // 2] = np.nextafter(outputs[STEPS // 2], np.float32(np.inf))
    brick = run_check(replace(vectors, outputs=outputs), tmp_path, "arm")
    assert brick.read_int("functional_check_failures", "u32") == 1
