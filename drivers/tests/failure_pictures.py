# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of the display after a failure, for the run-time's documentation.

`python -m drivers.tests.failure_pictures` writes docs/pictures/.
"""

from __future__ import annotations

import json

import virtual_brick

from tools.docs.pictures.lcd import lcd_svg
from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.observe import Brick, bench
from verification.support.paths import ROOT

PROGRAMS = ("stack_overflow", "ceiling_violation")
END_MS = 400


def main() -> None:
    """Run each program to its end and draw the display."""
    for name in PROGRAMS:
        elf = image_of(name, "ram")
        brick = Brick(virtual_brick.VirtualBrick(json.dumps(bench()), elf))
        brick.run_to_end(END_MS)
        (ROOT / "docs" / "pictures" / f"{name}.svg").write_text(
            lcd_svg(brick.picture()), encoding="utf-8"
        )


if __name__ == "__main__":
    main()
