# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Build a project's image by its own Makefile, and say clearly what went wrong."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from ravenbrick.errors import (
    BuildError,
    ImageFileError,
    ProjectFileError,
    ToolMissingError,
    shown_path,
)
from ravenbrick.target.elf_image import ElfImage, ImageKind, read_image
from ravenbrick.target.memory import MemoryReport, memory_report
from ravenbrick.target.robot import Robot
from ravenbrick.target.workspace import Workspace

__all__ = ["TOOLS", "Built", "Tool", "build_image", "find_tool", "require_tools"]

_OVERFLOW = re.compile(r"region `(\w+)' overflowed by (\d+) bytes?")
_FIRST_ERROR = re.compile(r"^(\S+?:\d+(?::\d+)?: (?:error: )?.*)$", re.MULTILINE)
DETAIL_LINES = 20


@dataclass(frozen=True)
class Tool:
    """A program that building needs, and what it is for."""

    program: str
    purpose: str
    package: str


TOOLS = (
    Tool("make", "runs the steps of the build", "make"),
    Tool("gprbuild", "finds what to compile, bind and link", "gprbuild"),
    Tool(
        "arm-linux-gnueabi-gcc-12",
        "compiles Ada and C for the ARM7TDMI",
        "gnat-12-arm-linux-gnueabi",
    ),
    Tool("arm-none-eabi-gcc", "links, with the ARMv4T support library", "gcc-arm-none-eabi"),
)


@dataclass(frozen=True)
class Built:
    """A checked image and its memory report."""

    image: ElfImage
    memory: MemoryReport
    memory_file: Path
    output: str


def find_tool(tool: Tool) -> str | None:
    """Path of the program, None when it is not installed."""
    return shutil.which(tool.program)


def require_tools() -> None:
    """Raise `ToolMissingError` naming each tool that is missing."""
    missing = [tool for tool in TOOLS if find_tool(tool) is None]
    if missing:
        names = ", ".join(f"'{tool.program}' ({tool.purpose})" for tool in missing)
        packages = " ".join(tool.package for tool in missing)
        raise ToolMissingError(
            f"the toolchain is incomplete: {names} not found; run 'make setup', which installs "
            f"the Debian package(s) {packages}"
        )


def _run_make(workspace: Workspace, kind: ImageKind, robot: Robot) -> str:
    if not (workspace.project / "Makefile").is_file():
        raise ProjectFileError(
            workspace.project / "Makefile", 1, "", "is missing; a project needs it to be built"
        )
    # The generated C comes from design.py, run with the same Python as this program.
    command = ["make", "-C", str(workspace.project), kind, f"PYTHON={sys.executable}"]
    # From its environment to the run-time's Makefile and to gprbuild, which both know the names.
    command.append(f"PROFILE={robot.profile}")
    command.append(f"EXECUTION_TIME={'yes' if robot.execution_time else 'no'}")
    command.append(f"STACK_CHECK={'yes' if robot.stack_check else 'no'}")
    # A project outside the tree asks 'ravenbrick home' where the tree is.
    path = os.pathsep.join([os.environ.get("PATH", os.defpath), str(Path(sys.executable).parent)])
    done = subprocess.run(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        env=os.environ | {"PATH": path},
    )
    log = workspace.build(kind) / "build.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text(done.stdout)
    if done.returncode != 0:
        raise _failure(workspace, kind, done.stdout, log)
    return done.stdout


def _failure(
    workspace: Workspace, kind: ImageKind, output: str, log: Path
) -> BuildError | ImageFileError:
    detail = "\n".join(output.strip().split("\n")[-DETAIL_LINES:])
    overflow = _OVERFLOW.search(output)
    if overflow:
        advice = "shorten stacks or code"
        if kind == "ram":
            advice += ", or build a flash image with '--image flash'"
        return ImageFileError(
            f"{workspace.project.name}: the {kind} image is {overflow.group(2)} bytes too large "
            f"for the {overflow.group(1)}; {advice}",
            detail=detail,
        )
    first = _FIRST_ERROR.search(output)
    what = first.group(1) if first else "make reported an error"
    return BuildError(
        f"{workspace.project.name} could not be built: {what}; correct it and build again "
        f"(whole output: {shown_path(log)})",
        detail=detail,
    )


def build_image(workspace: Workspace, robot: Robot, kind: ImageKind) -> Built:
    """Build, check and measure an image.

    Raises `ToolMissingError`, `BuildError`, `ImageFileError` or `ProjectFileError`.
    """
    require_tools()
    output = _run_make(workspace, kind, robot)
    image = read_image(workspace.image(kind, robot.name))
    memory = memory_report(image, robot)
    memory_file = workspace.build(kind) / "memory.json"
    memory.write(memory_file)
    return Built(image, memory, memory_file, output)
