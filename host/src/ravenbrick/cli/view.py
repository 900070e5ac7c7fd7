# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick view`: the brick in a browser tab."""

from __future__ import annotations

import json
import webbrowser
from functools import partial
from http.server import ThreadingHTTPServer
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.brick.session import session_of, tunables_of
from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.build import ElfOption, ImageChoice, ImageOption
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import project_image, scenario_or_none
from ravenbrick.errors import DesignError, UsageError
from ravenbrick.image.design_script import DESIGN_SCRIPT
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.image.run_time import run_time_home
from ravenbrick.image.source_texts import source_texts
from ravenbrick.local_server import LOOPBACK, PageHandler, access_token, listen, packed_files
from ravenbrick.packed_files import with_scripts
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace, tree
from ravenbrick.timing.results.bounds_file import own_bounds, own_worst_paths, read_bounds
from ravenbrick.trace.design import Response, read_design

__all__ = [
    "BOUNDS",
    "DESIGN",
    "IMAGE",
    "NO_DESIGN",
    "SESSION",
    "SOURCES",
    "WORST_PATHS",
    "page_files",
    "page_server",
    "project_files",
    "view_command",
]

PAGE = Path(__file__).resolve().parents[1] / "page.zip"
SESSION, IMAGE, BOUNDS = "session.json", "image.elf", "timing.json"
SOURCES, DESIGN, WORST_PATHS = "sources.json", "design.json", "worst_paths.json"
NO_DESIGN = b"{}"


def page_files() -> dict[str, bytes]:
    """The files of the page by their names; `make page` packs them."""
    return packed_files(PAGE)


class _Handler(PageHandler):
    """Files of the page, and the project's session and image beside them."""

    def __init__(self, *arguments: Any, served: dict[str, bytes], **options: Any) -> None:
        self._served = served
        super().__init__(*arguments, **options)

    def content_of(self, name: str) -> bytes | None:
        """See the base class."""
        return self._served.get(name)


def page_server(served: dict[str, bytes], port: int, token: str = "") -> ThreadingHTTPServer:
    """A server on this machine only, below a folder `token`; port 0 takes a free one.

    Raises `UsageError`.
    """
    return listen(partial(_Handler, served=served, token=token), port)


def _write(served: dict[str, bytes], folder: Path) -> dict[str, Any]:
    if folder.exists() and any(folder.iterdir()):
        raise UsageError(f"--out {folder}: is not empty; name a new folder")
    for name, content in with_scripts(served).items():
        atomic_write(folder / name, content)
    return {"folder": str(folder), "bytes": sum(map(len, served.values()))}


def project_files(
    workspace: Workspace, session: dict[str, Any], image: ElfImage
) -> dict[str, bytes]:
    """The files beside the page: a session with its image, and what belongs to that: tunable
    parameters, sources, design and worst paths."""
    tunables = tunables_of(read_robot(workspace.project), image)
    paths = own_worst_paths(workspace.results / BOUNDS, image)
    return {
        SESSION: json.dumps(session | {"tunables": tunables}).encode(),
        IMAGE: image.content,
        SOURCES: _sources(image, workspace),
        DESIGN: _design(workspace),
        WORST_PATHS: json.dumps(paths).encode(),
    }


def _sources(image: ElfImage, workspace: Workspace) -> bytes:
    """JSON of the sources of the project, the drivers and the run-time."""
    own = (tree() / "drivers", tree() / "runtime", run_time_home())
    return json.dumps(source_texts(image, (workspace.project, *own))).encode()


def _response(response: Response) -> dict[str, list[float]]:
    return {
        "times_s": [round(float(time), 6) for time in response.times],
        "values": [round(float(value), 6) for value in response.values],
    }


def _design(workspace: Workspace) -> bytes:
    """JSON of the designed step responses (per unit of set-point) and the controller's diagram;
    an empty object where design.py left none of them."""
    try:
        design = read_design(workspace.design_file)
    except DesignError:
        return NO_DESIGN
    drawn = {name: _response(response) for name, response in design.responses.items()}
    content = {"diagram": design.diagram} | ({"responses": drawn} if drawn else {})
    return json.dumps(content).encode()


@command("ravenbrick view examples/vehicle drive")
def view_command(
    directory: ProjectArgument,
    scenario: Annotated[
        str | None,
        typer.Argument(help="Scenario that provides the inputs (default: you provide all)."),
    ] = None,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="TCP port on this machine (0: any free port).")
    ] = 8080,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
    out: Annotated[
        Path | None, typer.Option(help="Folder for page and project; no server is started.")
    ] = None,
    elf: ElfOption = None,
    image: ImageOption = ImageChoice.RAM,
    bounds: Annotated[
        Path | None,
        typer.Option(help="timing.json of 'ravenbrick analyse' (default: the project's)."),
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    robot = read_robot(directory)
    chosen = scenario_or_none(directory, scenario, robot)
    workspace = Workspace.of(directory)
    reporter = Reporter(json_output)
    loaded = read_image(elf) if elf else project_image(workspace, robot, image.kind, reporter)
    if bounds is not None:
        proven = read_bounds(bounds, loaded)
    else:
        proven = own_bounds(workspace.results / BOUNDS, loaded)
    session = session_of(robot, chosen, named=scenario is not None, bounds_cycles=proven)
    if elf is not None:
        # Another program has other variables: those of the project that it has are recorded.
        session["probes"] = [p for p in session["probes"] if p["symbol"] in loaded.symbols]
    served = page_files() | project_files(workspace, session, loaded)
    if not proven:
        reporter.print("no response-time bounds; run 'ravenbrick analyse' to compute them")
    if served[DESIGN] == NO_DESIGN and (directory / DESIGN_SCRIPT).is_file():
        reporter.print("no diagram, no designed response; run 'ravenbrick design' to compute them")
    if out is not None:
        written = _write(served, out)
        reporter.print(f"{out}: the page; put it on any web server, or open its index.html")
        return written
    token = access_token()
    with page_server(served, port, token) as server:
        address = f"http://{LOOPBACK}:{server.server_port}/{token}/"
        reporter.tell(f"the brick is at {address}; Ctrl-C ends it")
        if browser:
            webbrowser.open(address)
        server.serve_forever(poll_interval=0.1)
    return {"address": address}
