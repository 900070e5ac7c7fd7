# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Generated C compiled for the host and for the brick's processor."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

WARNINGS = ("-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic")
STRICT = ("-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Wstrict-prototypes", "-Wfloat-equal")
ARM = ("-mcpu=arm7tdmi", "-ffreestanding", "-ffunction-sections", "-fdata-sections")
START = 0x0020_2000


def run(*command: str | Path) -> str:
    """Run a tool; its output is in the failure."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}"
    return done.stdout


def host_library(folder: Path, *sources: str, level: str = "-O2") -> ctypes.CDLL:
    """Shared library of the sources in `folder`."""
    library = folder / f"library{level}.so"
    files = [folder / source for source in sources]
    run("gcc", level, *WARNINGS, *STRICT, "-shared", "-fPIC", *files, "-o", library)
    return ctypes.CDLL(str(library))


def arm_image(folder: Path, entry: str, *sources: str, options: tuple[str, ...] = ()) -> Path:
    """ELF at 0x202000 with `entry` and what it needs, without C library."""
    objects = []
    for source in sources:
        target = folder / f"{Path(source).stem}.o"
        run(
            "arm-none-eabi-gcc",
            "-O2",
            *ARM,
            *WARNINGS,
            *options,
            "-c",
            folder / source,
            "-o",
            target,
        )
        objects.append(target)
    image = folder / "image.elf"
    link = ("-nostdlib", f"-Wl,-Ttext={START:#x}", f"-Wl,--entry={entry}", "-Wl,--gc-sections")
    run("arm-none-eabi-gcc", *ARM, *options, *link, *objects, "-lgcc", "-o", image)
    return image
