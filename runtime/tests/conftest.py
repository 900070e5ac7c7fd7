# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The fixture that runs the test programs."""

from __future__ import annotations

import json

import pytest
import virtual_brick

from verification.support.bricks.runtime_programs import BENCH, CYCLES_PER_MS, Run, Runner, build


@pytest.fixture(scope="session")
def run() -> Runner:
    """Run a program of this folder for a number of cycles."""

    def run_program(
        name: str,
        cycles: int = 100 * CYCLES_PER_MS,
        image: str = "ram",
        code: str = "arm",
        runtime: str = "arm",
        options: tuple[str, ...] = (),
    ) -> Run:
        elf = build(name, image, code, runtime, options).read_bytes()
        brick = virtual_brick.VirtualBrick(json.dumps(BENCH), elf)
        return Run(brick, brick.run_until(cycles))

    return run_program
