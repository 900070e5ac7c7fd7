# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick view`: the brick in a browser tab."""

from __future__ import annotations

import json
import shutil
import webbrowser
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.build import ImageChoice
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import scenario_or_none
from ravenbrick.errors import ToolMissingError, UsageError, shown_path
from ravenbrick.target.bounds_file import own_bounds, read_bounds
from ravenbrick.target.elf_image import read_image
from ravenbrick.target.robot import read_robot
from ravenbrick.target.run_file import session_of
from ravenbrick.target.workspace import Workspace, tree

__all__ = ["page_server", "view_command"]

LOOPBACK = "127.0.0.1"
TYPES = {".js": "text/javascript", ".wasm": "application/wasm"}
SESSION, IMAGE, BOUNDS = "session.json", "image.elf", "timing.json"
# The page needs its own files, its worker, and permission to compile the brick.
POLICY = (
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; connect-src 'self'; worker-src 'self'; frame-ancestors 'none'"
)


def _bundle() -> Path:
    bundle = tree() / "build" / "page"
    if not (bundle / "index.html").is_file():
        raise ToolMissingError(
            f"{shown_path(bundle)}: the page is not built; run 'make page' in the repository "
            "(it needs Node.js 18 or newer, npm, and Rust's target wasm32-unknown-unknown)"
        )
    return bundle


class _Handler(SimpleHTTPRequestHandler):
    """Files of the bundle, and the project's session and image beside them."""

    def __init__(self, *arguments: Any, own: dict[str, bytes], **options: Any) -> None:
        self._own = own
        self.extensions_map = {**SimpleHTTPRequestHandler.extensions_map, **TYPES}
        super().__init__(*arguments, **options)

    def end_headers(self) -> None:
        """Nothing from elsewhere, nothing stale."""
        self.send_header("Content-Security-Policy", POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cache-Control", "no-cache")
        super().end_headers()

    def do_GET(self) -> None:
        """The project's own files come first."""
        content = self._own.get(self.path.partition("?")[0].lstrip("/"))
        if content is None:
            super().do_GET()
            return
        self.send_response(200)
        kind = "application/json" if self.path.startswith(f"/{SESSION}") else "application/elf"
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_arguments: Any) -> None:
        """Requests are not news."""


def page_server(bundle: Path, own: dict[str, bytes], port: int) -> ThreadingHTTPServer:
    """A server on this machine only; port 0 takes a free one. Raises `UsageError`."""
    handler = partial(_Handler, own=own, directory=str(bundle))
    try:
        return ThreadingHTTPServer((LOOPBACK, port), handler)
    except OSError as error:
        raise UsageError(
            f"the server cannot use port {port} ({error.strerror or error}); name a free one with "
            "'--port', or 0 to take any"
        ) from None


def _write(bundle: Path, own: dict[str, bytes], folder: Path) -> dict[str, Any]:
    if folder.exists() and any(folder.iterdir()):
        raise UsageError(f"--out {folder}: is not empty; name a new folder")
    shutil.copytree(bundle, folder, dirs_exist_ok=True)
    for name, content in own.items():
        (folder / name).write_bytes(content)
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {"folder": str(folder), "bytes": sum(path.stat().st_size for path in files)}


@command("ravenbrick view examples/vehicle drive")
def view_command(
    directory: Annotated[Path, typer.Argument(help="Project folder with robot.toml.")],
    scenario: Annotated[
        str | None, typer.Argument(help="Whose inputs come; without it, you give them all.")
    ] = None,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="TCP port on this machine; 0 takes a free one.")
    ] = 8080,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
    out: Annotated[
        Path | None, typer.Option(help="Write the page with the project here and end.")
    ] = None,
    elf: Annotated[Path | None, typer.Option(help="Another image than the project's own.")] = None,
    image: Annotated[ImageChoice, typer.Option(help="Which image to run.")] = ImageChoice.RAM,
    bounds: Annotated[
        Path | None,
        typer.Option(help="timing.json of 'ravenbrick analyse'; the project's unless given."),
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    robot = read_robot(directory)
    chosen = scenario_or_none(directory, scenario, robot)
    workspace = Workspace.of(directory)
    loaded = read_image(elf or workspace.image(image.kind, robot.name))
    bundle = _bundle()
    if bounds is not None:
        proven = read_bounds(bounds, loaded)
    else:
        proven = own_bounds(workspace.results / BOUNDS, loaded)
    session = session_of(robot, chosen, named=scenario is not None, bounds_cycles=proven)
    if elf is not None:
        # Another program has other variables: those of the project that it has are recorded.
        session["probes"] = [p for p in session["probes"] if p["symbol"] in loaded.symbols]
    own = {SESSION: json.dumps(session).encode(), IMAGE: loaded.content}
    reporter = Reporter(json_output)
    if out is not None:
        written = _write(bundle, own, out)
        reporter.print(f"{out}: the page; put it on any static web server")
        return written
    with page_server(bundle, own, port) as server:
        address = f"http://{LOOPBACK}:{server.server_port}/"
        reporter.print(f"the brick is at {address}; Ctrl-C ends it")
        if not proven:
            reporter.print("no bounds of response times; 'ravenbrick analyse' finds this image's")
        if browser:
            webbrowser.open(address)
        server.serve_forever(poll_interval=0.1)
    return {"address": address}
