# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The Ada programs of this folder as images."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from ravenbrick.target.elf_image import ElfImage, read_image

__all__ = ["built"]

ROOT = Path(__file__).resolve().parents[2]


def built(folder: str, program: str) -> ElfImage:
    """The program of `FOLDER/FOLDER.gpr`, with the Ravenscar run-time."""
    build = ROOT / "build" / "conformance" / folder
    project = ROOT / "conformance" / "timing" / folder / f"{folder}.gpr"
    subprocess.run(
        ["gprbuild", "-q", f"--config={ROOT / 'tools' / 'ravenbrick.cgpr'}",
         "-P", str(project), f"-XBUILD={build}"],
        check=True,
        env=os.environ | {
            "LC_ALL": "C",
            "RAVENBRICK_RTS": str(ROOT / "build" / "runtime" / "ravenscar"),
        },
    )  # fmt: skip
    return read_image(build / f"{program}.elf")
