# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick import`: a Simulink model becomes C."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.diagram import DRAWN, write_drawn
from ravenbrick.codegen import generate_c
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.image.controller_origin import replace_controller
from ravenbrick.simulink import ModelSource, import_model, read_workspace
from ravenbrick.simulink.numbers import Variables, Workspace

__all__ = [
    "LibraryOption",
    "VariablesOption",
    "WorkspaceOption",
    "assigned",
    "import_command",
    "model_variables",
]

VariablesOption = Annotated[
    list[str] | None,
    typer.Option("--set", help="Workspace variable, as NAME=NUMBER; may be repeated."),
]
WorkspaceOption = Annotated[
    list[Path] | None,
    typer.Option(help="File with workspace variables: .m with assignments, or .mat."),
]
LibraryOption = Annotated[
    list[Path] | None,
    typer.Option(help="Folder with libraries and referenced models; may be repeated."),
]


def assigned(option: str, texts: list[str]) -> dict[str, float]:
    """Numbers by name, from NAME=NUMBER; raises `UsageError`."""
    found: dict[str, float] = {}
    for text in texts:
        name, sign, value = text.partition("=")
        try:
            found[name.strip()] = float(value)
        except ValueError:
            sign = ""
        if not sign:
            raise UsageError(f"{option} {text}: give a name and a number, such as Kp=0.5")
    return found


def model_variables(given: list[str], files: list[Path]) -> Variables:
    """Workspace variables of files, and those given by --set."""
    found: dict[str, float | np.ndarray] = {}
    for path in files:
        if not path.is_file():
            raise UsageError(f"{path}: there is no such file")
        found |= read_workspace(path)
    return found | assigned("--set", given)


@command("ravenbrick import controller.slx --sample-time 0.004 --set Kp=0.36 --output generated")
def import_command(
    model: Annotated[Path, typer.Argument(help="Simulink model (.slx or .mdl).")],
    sample_time: Annotated[float, typer.Option(help="Sample time in seconds.")],
    output: Annotated[Path, typer.Option(help="Folder for the generated C.")],
    variables: VariablesOption = None,
    workspace: WorkspaceOption = None,
    library: LibraryOption = None,
    subsystem: Annotated[
        str,
        typer.Option(
            help="Path of the only subsystem to import (default: the model's only atomic subsystem "
            "among continuous blocks, if any)."
        ),
    ] = "",
    name: Annotated[
        str, typer.Option(help="Name of the C model (default: that of the file or subsystem).")
    ] = "",
    picture: Annotated[
        Path | None,
        typer.Option(help="Picture of the diagram (.svg), or a page with it and the C (.html)."),
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    if picture is not None and picture.suffix not in DRAWN:
        raise UsageError(f"--picture {picture}: expected a file that ends with .svg or .html")
    if model.suffix in (".c", ".h") or (model.is_dir() and any(model.glob("*.h"))):
        folder = model if model.is_dir() else model.parent
        raise UsageError(
            f"{model}: C is bound, not imported; try 'ravenbrick bind {folder} binding.toml'"
        )
    if not model.is_file():
        raise UsageError(f"{model}: there is no such file")
    if not sample_time > 0:
        raise UsageError(f"--sample-time must be > 0 s, not {sample_time}")
    reporter = Reporter(json_output, total=2)
    with reporter.step("read the model") as step:
        given = model_variables(variables or [], workspace or [])
        source = ModelSource(
            model, sample_time, Workspace(given), tuple(library or []), subsystem, name
        )
        found = import_model(source)
        diagram = found.diagram
        chosen = [f"atomic subsystem '{found.subsystem}'"] if found.subsystem != subsystem else []
        notes = [f"{len(diagram.blocks)} blocks", *chosen, found.continuous]
        step.note = "; ".join(filter(None, notes))
    program = diagram.lower()
    with reporter.step("generate C"):
        files = generate_c(diagram, only_used=True).files
        replace_controller(output, "import", model, files)
    if picture is not None:
        write_drawn(diagram, picture)
        reporter.print(f"picture: {shown_path(picture)}")
    return {
        "model": str(model),
        "subsystem": found.subsystem,
        "continuous": found.continuous,
        "blocks": [{"name": b.name, "type": type(b).__name__} for b in diagram.blocks],
        "parameters": [
            {"name": slot.name, "value": slot.initial, "description": slot.description}
            for slot in program.parameters
        ],
        "files": [str(output / name) for name in sorted(files)],
    }
