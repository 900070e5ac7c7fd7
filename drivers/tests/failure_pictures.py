# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of the display after a failure, for the run-time's documentation.

`python -m drivers.tests.failure_pictures` writes docs/pictures/; the test programs must be built,
which `pytest drivers/tests/test_end.py` does.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import virtual_brick

from examples.devices.pictures import picture
from verification.support.bricks.observe import Brick, bench

ROOT = Path(__file__).resolve().parent.parent.parent
BUILD = Path(os.environ.get("RAVENBRICK_BUILD", ROOT / "build"))
PROGRAMS = ("stack_overflow", "ceiling_violation")
END_MS = 400


def main() -> None:
    """Run each program to its end and draw the display."""
    for name in PROGRAMS:
        elf = BUILD / "drivers" / "tests" / name / "ram" / f"{name}.elf"
        brick = Brick(virtual_brick.VirtualBrick(json.dumps(bench()), elf.read_bytes()))
        brick.run_to_end(END_MS)
        (ROOT / "docs" / "pictures" / f"{name}.svg").write_text(picture(brick), encoding="utf-8")


if __name__ == "__main__":
    main()
