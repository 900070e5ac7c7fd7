# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick studio`: edit, build and run a project in the browser."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.brick.session import session_of
from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import scenario_or_none
from ravenbrick.cli.view import BOUNDS, page_files, project_files
from ravenbrick.image.elf import read_image
from ravenbrick.local_server import LOOPBACK, access_token, packed_files
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace
from ravenbrick.studio.server import studio_server
from ravenbrick.studio.studio import Studio
from ravenbrick.timing.results.bounds_file import own_bounds

__all__ = ["studio_command"]

PAGE = Path(__file__).resolve().parents[1] / "studio.zip"


@command("ravenbrick studio my-robot")
def studio_command(
    directory: ProjectArgument,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="TCP port on this machine (0: any free port).")
    ] = 8081,
    browser: Annotated[bool, typer.Option(help="Open the studio in the browser.")] = True,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    read_robot(directory)
    reporter = Reporter(json_output)

    def show(scenario: str | None) -> dict[str, bytes]:
        robot = read_robot(directory)
        chosen = scenario_or_none(directory, scenario, robot)
        image = read_image(workspace.image("ram", robot.name))
        bounds = own_bounds(workspace.results / BOUNDS, image)
        session = session_of(robot, chosen, named=scenario is not None, bounds_cycles=bounds)
        return page_files() | project_files(workspace, session, image)

    studio, token = Studio(workspace, show), access_token()
    with studio_server(studio, packed_files(PAGE), port, token) as server:
        address = f"http://{LOOPBACK}:{server.server_port}/{token}/"
        reporter.tell(f"the studio is at {address}; Ctrl-C ends it")
        if browser:
            webbrowser.open(address)
        try:
            server.serve_forever(poll_interval=0.1)
        finally:
            studio.close()
    return {"address": address}
