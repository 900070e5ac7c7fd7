# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Generated C compiled for the host and for the brick's processor."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

WARNINGS = ("-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic")
STRICT = ("-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Wstrict-prototypes", "-Wfloat-equal")
ARM = (
    "-mcpu=arm7tdmi",
    "-ffreestanding",
    "-fno-short-enums",
    "-ffunction-sections",
    "-fdata-sections",
)
# This processor has no load delays: to reorder before registers are chosen only costs registers.
WORD_FLAGS = ("-fno-schedule-insns",)
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


ADA_WARNINGS = ("-gnat2012", "-gnatwa", "-gnatwe", "-gnaty3aAbcefhiklnprtuM100")


def ada_object(folder: Path, body: str, *, checks: bool = True) -> Path:
    """Object of an Ada body in `folder`; with `checks`, contracts and ranges are tested as it runs.

    All warnings and the drivers' style checks are errors.
    """
    target = folder / f"{Path(body).stem}.o"
    tested = ("-gnata", "-gnato") if checks else ("-gnatp",)
    command = ("arm-linux-gnueabi-gcc-12", "-c", "-x", "ada", "-O2", *tested, *ADA_WARNINGS)
    no_memset = "-fno-tree-loop-distribute-patterns"
    plain = (*WORD_FLAGS, no_memset, "-mfloat-abi=soft", "-fno-pic", "-fno-stack-protector")
    no_tables = ("-fno-unwind-tables", "-fno-asynchronous-unwind-tables", "-fno-exceptions")
    arm = ("-mcpu=arm7tdmi", "-marm", *plain, *no_tables, "-ffunction-sections", "-fdata-sections")
    run(*command, *arm, f"-I{folder}", folder / body, "-o", target)
    return target


def arm_image(
    folder: Path,
    entry: str,
    *sources: str,
    options: tuple[str, ...] = (),
    extra: tuple[Path, ...] = (),
) -> Path:
    """ELF at 0x202000 with `entry` and what it needs, without C library; `extra` are objects."""
    objects = list(extra)
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
