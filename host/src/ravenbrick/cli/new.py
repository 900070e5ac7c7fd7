# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick new`: a project folder that builds, runs, tests and debugs; `ravenbrick home`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import UsageError
from ravenbrick.image.design_script import adopt_design
from ravenbrick.project.templates import FROM_DIAGRAM, TEMPLATES, create_project
from ravenbrick.project.workspace import Workspace, tree

__all__ = ["home_command", "new_command"]

DIAGRAM_TEMPLATE = "diagram"
CHOICES = "; ".join(
    f"{name}: {template.description}"
    for name, template in {**TEMPLATES, DIAGRAM_TEMPLATE: FROM_DIAGRAM}.items()
)


@command("ravenbrick new my-robot --template motor")
def new_command(
    directory: Annotated[
        Path, typer.Argument(help="New project folder; its name becomes the robot's name.")
    ],
    template: Annotated[str, typer.Option(help=CHOICES)] = "blank",
    from_diagram: Annotated[
        str,
        typer.Option(
            help="Diagram (as 'ravenbrick diagram' takes it) that becomes the controller, with its "
            "Ada task."
        ),
    ] = "",
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input", help="PORT=DEVICE of the diagram, such as speed=motor.B.speed; repeatable."
        ),
    ] = None,
    outputs: Annotated[
        list[str] | None,
        typer.Option("--output", help="PORT=DEVICE, such as u=motor.B.voltage; repeatable."),
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    if from_diagram or template == DIAGRAM_TEMPLATE:
        workspace = _from_diagram(directory, from_diagram, inputs or [], outputs or [])
        template, scenario = DIAGRAM_TEMPLATE, FROM_DIAGRAM.scenario
    elif inputs or outputs:
        raise UsageError("--input and --output name ports of a diagram; give --from-diagram, too")
    else:
        workspace = create_project(directory, template)
        scenario = TEMPLATES[template].scenario
    files = sorted(path for path in workspace.project.rglob("*") if path.is_file())
    adopt_design(workspace)
    reporter = Reporter(json_output)
    reporter.print(f"{directory}: {len(files)} files of the template '{template}'")
    reporter.print(f"next: cd {directory} && make && ravenbrick run . {scenario}")
    return {
        "project": str(workspace.project),
        "template": template,
        "scenario": scenario,
        "files": [str(path.relative_to(workspace.project)) for path in files],
    }


def _from_diagram(directory: Path, source: str, inputs: list[str], outputs: list[str]) -> Workspace:
    from ravenbrick.cli.diagram import diagram_of  # slow to load, with the next
    from ravenbrick.cli.diagram_project import create_from_diagram, empty_diagram

    diagram = diagram_of(source) if source else empty_diagram()
    driven = {} if source else {"duty": "motor.B.duty"}
    read = {port: _number_or_device(text) for port, text in _pairs(inputs, "--input")}
    driven |= dict(_pairs(outputs, "--output"))
    return create_from_diagram(directory, diagram, read, driven)


def _pairs(words: list[str], option: str) -> Iterator[tuple[str, str]]:
    for word in words:
        port, sign, device = word.partition("=")
        if not (sign and port and device):
            raise UsageError(f"{option} {word}: expected PORT=DEVICE, such as speed=motor.B.speed")
        yield port, device


def _number_or_device(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


@command("ravenbrick home")
def home_command(json_output: JsonOption = False) -> dict[str, Any]:
    Reporter(json_output).print(str(tree()))
    return {"home": str(tree())}
