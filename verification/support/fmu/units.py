# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Builds the co-simulation units of this folder with the computer's C compiler."""

from __future__ import annotations

import subprocess
import zipfile
from collections.abc import Mapping
from pathlib import Path

from ravenbrick.catalogue import part_values

HERE = Path(__file__).parent
MOTOR = [f"-D{name.upper()}={value!r}" for name, value in part_values("motors", "nxt").items()]
# Where a unit of each version keeps its library.
FOLDERS = {2: "linux64", 3: "x86_64-linux"}


def flywheel(folder: Path, version: int, *options: str, replaced: Mapping[str, str] = {}) -> Path:
    """The unit for a version of FMI; `replaced` are words of its description and others."""
    library = folder / f"flywheel{version}.so"
    command = ["gcc", "-O1", "-fPIC", "-shared", "-Wall", "-Werror", *MOTOR, *options]
    subprocess.run([*command, "-o", str(library), str(HERE / f"fmi{version}.c")], check=True)
    description = (HERE / f"fmi{version}.xml").read_text(encoding="utf-8")
    for old, new in replaced.items():
        assert old in description
        description = description.replace(old, new)
    return packed(library, "flywheel", version, description)


def packed(library: Path, name: str, version: int, description: str) -> Path:
    """The unit beside its library: that and the description in an archive."""
    unit = library.with_suffix(".fmu")
    with zipfile.ZipFile(unit, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(library, f"binaries/{FOLDERS[version]}/{name}.so")
    return unit
