# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick upload`: the image on a real brick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.build import ImageChoice
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.hardware.upload import brick_to_load, load
from ravenbrick.hardware.usb_bricks import find_bricks
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import DEBUGGING_BUILD, read_image
from ravenbrick.image.raw_binary import FlatImage, flat_flash_file, flat_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace

__all__ = ["upload_command"]


def _project_image(source: Path, kind: Literal["ram", "flash"], reporter: Reporter) -> FlatImage:
    if source.is_file():
        image = read_image(source)
        if image.build == "debug":
            raise UsageError(
                f"{shown_path(source)} is a {DEBUGGING_BUILD}; upload the release image, or the "
                "project's folder"
            )
        if image.kind != kind:
            raise UsageError(
                f"{source} is a {image.kind} image; use '--image {image.kind}' to load it there"
            )
        return flat_image(image)
    workspace = Workspace.of(source)
    with reporter.step(f"build the {kind} image") as step:
        built = build_image(workspace, read_robot(source), kind)
        step.note = shown_path(built.image.path)
    return flat_image(built.image)


@command("ravenbrick upload examples/vehicle --image ram")
def upload_command(
    source: Annotated[
        Path, typer.Argument(help="Project folder, image (.elf), or firmware file with --restore.")
    ],
    image: Annotated[
        ImageChoice,
        typer.Option(help="Memory to load: RAM (until power-off) or flash (permanent)."),
    ] = ImageChoice.RAM,
    restore: Annotated[
        bool, typer.Option("--restore", help="Write a firmware file, such as LEGO's, to flash.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="File for the raw image; no brick is loaded.")
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    reporter = Reporter(json_output)
    kind: Literal["ram", "flash"] = "flash" if restore else image.kind
    flat = flat_flash_file(source) if restore else _project_image(source, kind, reporter)
    facts = {"kind": kind, "bytes": len(flat.content), "address": flat.address}
    if out is not None:
        atomic_write(out, flat.content)
        reporter.print(f"written: {out}, {len(flat.content):,} bytes for 0x{flat.address:08X}")
        return {**facts, "file": str(out)}
    brick = brick_to_load(find_bricks())
    with reporter.step(f"load {len(flat.content):,} bytes into {kind}") as step:
        said = load(flat, kind)
        step.note = "the program runs" if kind == "ram" else "written and started"
    return {**facts, "device": str(brick.node), "loader": said}
