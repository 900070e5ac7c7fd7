# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick new`: a project folder that builds, runs, tests and debugs; `ravenbrick home`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.project.templates import TEMPLATES, create_project
from ravenbrick.project.workspace import tree

__all__ = ["home_command", "new_command"]

CHOICES = "; ".join(f"{name}: {template.description}" for name, template in TEMPLATES.items())


@command("ravenbrick new my-robot --template motor")
def new_command(
    directory: Annotated[
        Path, typer.Argument(help="New project folder; its name becomes the robot's name.")
    ],
    template: Annotated[str, typer.Option(help=CHOICES)] = "blank",
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = create_project(directory, template)
    files = sorted(path for path in workspace.project.rglob("*") if path.is_file())
    reporter, scenario = Reporter(json_output), TEMPLATES[template].scenario
    reporter.print(f"{directory}: {len(files)} files of the template '{template}'")
    reporter.print(f"next: cd {directory} && make && ravenbrick run . {scenario}")
    return {
        "project": str(workspace.project),
        "template": template,
        "scenario": scenario,
        "files": [str(path.relative_to(workspace.project)) for path in files],
    }


@command("ravenbrick home")
def home_command(json_output: JsonOption = False) -> dict[str, Any]:
    Reporter(json_output).print(str(tree()))
    return {"home": str(tree())}
