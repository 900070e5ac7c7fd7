# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick debug`: the program on the virtual brick under GDB, forwards and backwards."""

from __future__ import annotations

import shlex
import shutil
import signal
import subprocess
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from queue import Queue
from typing import Annotated, Any

import typer

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.build import ElfOption, ImageChoice
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import project_image, scenario_or_none
from ravenbrick.errors import ToolMissingError, UsageError
from ravenbrick.image.elf import DEBUGGING_BUILD, read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import BuildKind, Workspace

__all__ = ["GDB", "debug_command", "gdb_command"]

GDB = "gdb-multiarch"
LOOPBACK = "127.0.0.1"
# GDB gives an answer up after 2 s, which a computer with other work may need.
PATIENCE = "set remotetimeout 60\n"
# GDB keeps registers across a reset that it does not know of.
RESET = "define reset\nmonitor reset\nmaintenance flush register-cache\nend\n"
RESET += "document reset\nRestart the run.\nend\n"
PROGRAM = "define program\nmonitor program $arg0\nfile $arg0\n"
PROGRAM += "maintenance flush register-cache\nend\n"
PROGRAM += "document program\nRestart with the program of an ELF file.\nend\n"


def gdb_command(program: str, elf: Path, port: int, script: Path | None = None) -> list[str]:
    """The command line that connects GDB to the server."""
    commands = ["-x", str(script)] if script else []
    return [program, "-q", *commands, "-ex", f"target remote {LOOPBACK}:{port}", str(elf)]


def _serve(brick: Any, port: int, **options: Any) -> None:
    try:
        brick.serve_debugger(port, LOOPBACK, **options)
    except OSError as error:
        raise UsageError(
            f"the server cannot use port {port} ({error.strerror or error}); name a free one with "
            "'--port', or 0 to take any"
        ) from None


def _installed_gdb() -> str:
    program = shutil.which(GDB)
    if program is None:
        raise ToolMissingError(
            f"'{GDB}' is not installed (Debian package gdb-multiarch); install it, or omit "
            "'--gdb' and connect your own debugger"
        )
    return program


def _with_gdb(brick: Any, elf: Path, port: int, program: str) -> int:
    """Run GDB on the terminal and the server beside it; the exit code of GDB."""
    listening: Queue[int | Exception] = Queue()
    finished = threading.Event()

    def serve() -> None:
        try:
            _serve(brick, port, on_listening=listening.put, should_stop=finished.is_set, once=True)
        except Exception as error:
            listening.put(error)

    server = threading.Thread(target=serve, name="debugger")
    server.start()
    told = listening.get()
    if isinstance(told, Exception):
        raise told
    # Ctrl-C is for GDB, which stops the program on the brick.
    before = signal.signal(signal.SIGINT, lambda _number, _frame: None)
    try:
        with tempfile.TemporaryDirectory() as folder:
            script = Path(folder) / "ravenbrick.gdb"
            script.write_text(PATIENCE + RESET + PROGRAM)
            return subprocess.call(gdb_command(program, elf, told, script))
    finally:
        finished.set()
        server.join()
        signal.signal(signal.SIGINT, before)


def _announce(reporter: Reporter, elf: Path) -> Callable[[int], None]:
    def announce(port: int) -> None:
        reporter.tell(f"the brick waits on {LOOPBACK}:{port}; Ctrl-C ends it; connect with")
        reporter.tell(f"  {shlex.join(gdb_command(GDB, elf, port))}")

    return announce


@command("ravenbrick debug examples/vehicle drive --gdb")
def debug_command(
    directory: ProjectArgument,
    scenario: Annotated[
        str | None,
        typer.Argument(help="Scenario that provides the inputs (default: set them in GDB)."),
    ] = None,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="TCP port on this machine (0: any free port).")
    ] = 3333,
    gdb: Annotated[bool, typer.Option("--gdb", help="Start GDB in this terminal.")] = False,
    elf: ElfOption = None,
    image: Annotated[
        ImageChoice | None,
        typer.Option(help="Release image to debug (default: a debugging build)."),
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    robot = read_robot(directory)
    chosen = scenario_or_none(directory, scenario, robot)
    reporter, workspace = Reporter(json_output), Workspace.of(directory)
    program = _installed_gdb() if gdb else None
    kind: BuildKind = image.kind if image else "debug"
    loaded = read_image(elf) if elf else project_image(workspace, robot, kind, reporter)
    if loaded.build == "debug":
        reporter.print(f"{DEBUGGING_BUILD}; '--image ram' takes that one")
    brick = VirtualTarget().prepare(robot, chosen, loaded, any_program=True)
    if program:
        _with_gdb(brick, loaded.path, port, program)
    else:
        announce = _announce(reporter, loaded.path)
        _serve(brick, port, on_listening=announce)
    return {"cycles": brick.cycles, "digest": brick.trace_digest()}
