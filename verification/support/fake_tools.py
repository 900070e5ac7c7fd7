# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A toolchain that does what a file `recipe` of the project says, for tests of what calls it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from ravenbrick.image.build import TOOLS
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace

from verification.support.elf_files import make_elf

__all__ = ["install_fake_tools", "write_recipe"]

SCRIPTS = {
    "gprbuild": "#!/bin/sh\n. ./recipe\n",
    "gprclean": '#!/bin/sh\necho "Parsing \\"$PWD/robot.gpr\\""\n'
    'echo "adding source dir= \\"$PWD/src/\\""\n',
}


def install_fake_tools(folder: Path, patch: pytest.MonkeyPatch) -> None:
    """Put the toolchain, and a run-time library for it, into a folder, and in front of the PATH."""
    programs, library = folder / "bin", folder / "run-time"
    programs.mkdir(parents=True)
    for name in {*SCRIPTS, *(tool.program for tool in TOOLS)}:
        (programs / name).write_text(SCRIPTS.get(name, "#!/bin/sh\n"))
        (programs / name).chmod(0o755)
    (library / "adalib").mkdir(parents=True)
    (library / "adalib" / "libgnat.a").touch()
    patch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    patch.setenv("RAVENBRICK_RTS", str(library))


def write_recipe(project: Path, commands: str = "true") -> None:
    """Have the toolchain execute commands of the shell and then leave a small image."""
    image = Workspace.of(project).image("ram", read_robot(project).name)
    (project / "robot.gpr").touch()
    (project / "src").mkdir(exist_ok=True)
    (project / "small.elf").write_bytes(make_elf())
    (project / "recipe").write_text(f"{commands}\ncp small.elf {image}\n")
