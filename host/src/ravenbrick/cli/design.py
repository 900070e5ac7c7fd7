# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick design`: from the plant's constants to generated C."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import design_project
from ravenbrick.target.workspace import Workspace

__all__ = ["design_command"]


@command("ravenbrick design examples/vehicle")
def design_command(
    directory: Annotated[Path, typer.Argument(help="Project folder with design.py.")],
    json_output: JsonOption = False,
) -> dict[str, Any]:
    """Run design.py: tune, discretise, simulate, and generate the controller's C."""
    workspace = Workspace.of(directory)
    reporter = Reporter(json_output)
    with reporter.step("design and generate C"):
        design = design_project(workspace)
    reporter.table(
        ("figure", "value"), [[name, f"{value:.6g}"] for name, value in design.figures.items()]
    )
    generated = sorted(str(path) for path in (workspace.project / "generated").glob("*.[ch]"))
    reporter.print(f"design: {workspace.shown(workspace.design_file)}")
    return {
        "design_file": str(workspace.design_file),
        "figures": dict(design.figures),
        "generated": generated,
    }
