# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Builds the drivers' test programs."""

from __future__ import annotations

import os
import subprocess
from functools import cache
from pathlib import Path

__all__ = ["BUILD", "PROGRAMS", "ROOT", "build_run_time", "image_of"]

ROOT = Path(__file__).resolve().parents[3]
PROGRAMS = ROOT / "drivers" / "tests"
BUILD = Path(os.environ.get("RAVENBRICK_BUILD", ROOT / "build"))


@cache
def build_run_time() -> None:
    """The run-time, built once; RAVENBRICK_RTS names another one, taken as it is."""
    if "RAVENBRICK_RTS" not in os.environ:
        subprocess.run(["make", "--silent", "-C", ROOT / "runtime"], check=True)


@cache
def image_of(name: str, kind: str = "ram") -> bytes:
    """The ELF file of a test program as an image in `kind`, "ram" or "flash"."""
    build_run_time()
    config = [f"--config={ROOT / 'tools' / 'ravenbrick.cgpr'}"]
    if "RAVENBRICK_RTS" not in os.environ:
        config.append(f"--implicit-with={ROOT / 'tools' / 'run_time.gpr'}")
    project = ["-P", str(PROGRAMS / "test.gpr"), f"-XTEST={name}", f"-XIMAGE={kind}"]
    done = subprocess.run(
        ["gprbuild", "-q", "-j2", *config, *project], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return (BUILD / "drivers" / "tests" / name / kind / f"{name}.elf").read_bytes()
