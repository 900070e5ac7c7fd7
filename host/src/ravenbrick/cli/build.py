# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick build`: build the image and report its memory use."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import shown_path
from ravenbrick.image.build import build_image, clean_project
from ravenbrick.image.elf import DEBUGGING_BUILD, ImageKind
from ravenbrick.image.memory import MemoryReport
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import BuildKind, Workspace

__all__ = ["DebugOption", "ElfOption", "ImageChoice", "ImageOption", "build_command", "build_kind"]

MEMORY_HEAD = ("memory", "bytes", "")
DebugOption = Annotated[
    bool, typer.Option("--debug", help="Debugging build: all variables are visible in GDB.")
]


class ImageChoice(Enum):
    """Memory that the image runs from."""

    RAM = "ram"
    FLASH = "flash"

    @property
    def kind(self) -> ImageKind:
        """The kind of image."""
        return "ram" if self is ImageChoice.RAM else "flash"


ElfOption = Annotated[Path | None, typer.Option(help="ELF image in place of the project's.")]
ImageOption = Annotated[ImageChoice, typer.Option(help="Memory of the image: RAM or flash.")]


def build_kind(image: ImageChoice, debug: bool) -> BuildKind:
    """The kind of build that the options name."""
    return "debug" if debug else image.kind


@command("ravenbrick build examples/vehicle --image ram")
def build_command(
    directory: ProjectArgument,
    image: ImageOption = ImageChoice.RAM,
    debug: DebugOption = False,
    tools: Annotated[
        bool, typer.Option("--tools", help="Print each tool with its source and product.")
    ] = False,
    clean: Annotated[
        bool, typer.Option("--clean", help="Remove everything built for the project.")
    ] = False,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    reporter = Reporter(json_output)
    if clean:
        removed = clean_project(workspace)
        reporter.print(f"removed: {', '.join(map(shown_path, removed))}")
        return {"removed": [str(folder) for folder in removed]}
    robot = read_robot(directory)
    kind = build_kind(image, debug)
    with reporter.step(f"build the {kind} image") as step:
        built = build_image(workspace, robot, kind, reporter.print if tools else None)
        step.note = shown_path(built.image.path)
        step.note += "" if built.changed else " (nothing has changed)"
    reporter.table(MEMORY_HEAD, _memory_rows(built.memory))
    if debug:
        reporter.print(DEBUGGING_BUILD)
    return {
        "image": str(built.image.path),
        "memory_file": str(built.memory_file),
        "memory": built.memory.as_json(),
        "steps": reporter.durations(),
    }


def _memory_rows(memory: MemoryReport) -> list[list[str]]:
    """Sizes and stacks for the terminal."""
    share = 100 * memory.used / memory.available
    rows = [
        ["text", str(memory.text), ""],
        ["data", str(memory.data), ""],
        ["bss", str(memory.bss), ""],
        ["used", str(memory.used), f"{share:.1f} % of {memory.available}"],
    ]
    for task in memory.tasks:
        size = task.storage_size_bytes or task.declared_bytes
        used = "not run yet" if task.used_bytes is None else f"{task.used_bytes} used"
        rows.append([f"stack of {task.name}", str(size) if size else "unknown", used])
    return rows
