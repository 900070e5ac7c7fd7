# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Builds the drivers' test programs."""

from __future__ import annotations

from functools import cache

from verification.support.bricks.programs import gprbuild
from verification.support.paths import BUILD, ROOT

__all__ = ["image_of"]

PROJECT = ROOT / "drivers" / "tests" / "test.gpr"


@cache
def image_of(name: str, kind: str = "ram") -> bytes:
    """The ELF file of a test program as an image in `kind`, "ram" or "flash"."""
    gprbuild(PROJECT, TEST=name, IMAGE=kind)
    return (BUILD / "drivers" / "tests" / name / kind / f"{name}.elf").read_bytes()
