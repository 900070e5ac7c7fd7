# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The fixture that runs the test programs."""

from __future__ import annotations

import json

import pytest
import virtual_brick

from verification.support.bricks.runtime_programs import BENCH, CYCLES_PER_MS, Run, Runner, build
from verification.support.failing_program import put_values


@pytest.fixture(scope="session")
def run() -> Runner:
    """Run a program of this folder for a number of cycles.

    `values` are initial values of its exported integers, which must not be 0 in the source.
    """

    def run_program(
        name: str,
        cycles: int = 100 * CYCLES_PER_MS,
        image: str = "ram",
        code: str = "arm",
        runtime: str = "arm",
        options: tuple[str, ...] = (),
        values: dict[str, int] | None = None,
    ) -> Run:
        path = build(name, image, code, runtime, options)
        content = bytearray(path.read_bytes())
        put_values(content, path, values or {})
        brick = virtual_brick.VirtualBrick(json.dumps(BENCH), bytes(content))
        return Run(brick, brick.run_until(cycles))

    return run_program
