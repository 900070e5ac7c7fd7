# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagrams drawn by lot: their C equals their simulation bit for bit, single and fixed point."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from pathlib import Path

import pytest
from verification.support.codegen.block_programs import write_checks
from verification.support.codegen.c_build import host_library
from verification.support.codegen.random_diagrams import fixed_form, random_diagram

from ravenbrick.model import Diagram
from ravenbrick.model.program import Program

SEEDS = range(16)
STEPS = 120


@pytest.fixture(scope="module")
def models() -> dict[str, Diagram | Program]:
    """By name; those in fixed point that have a form."""
    found: dict[str, Diagram | Program] = {f"lot_{seed}": random_diagram(seed) for seed in SEEDS}
    for seed in SEEDS:
        fixed = fixed_form(random_diagram(100 + seed, fixed=True))
        if fixed is not None:
            found[f"fixed_lot_{seed}"] = replace(fixed, name=f"fixed_lot_{seed}")
    return found


def test_the_c_of_random_diagrams_has_the_bits_of_their_simulation(
    models: dict[str, Diagram | Program], tmp_path: Path
) -> None:
    """With feedback, slower rates and parts that run on a condition."""
    assert len(models) >= len(SEEDS) + len(SEEDS) // 2
    library = host_library(tmp_path, *write_checks(models, tmp_path, STEPS))
    for name in models:
        getattr(library, f"{name}_check")()
        assert ctypes.c_uint32.in_dll(library, f"{name}_check_steps").value == STEPS, name
        assert ctypes.c_uint32.in_dll(library, f"{name}_check_failures").value == 0, name


def test_a_seed_names_a_diagram() -> None:
    """The same again; another seed gives another."""
    assert random_diagram(3).lower().statements == random_diagram(3).lower().statements
    assert random_diagram(3).lower().statements != random_diagram(4).lower().statements
