# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The debugging build: GDB shows every variable, and nothing takes it for the release image."""

from __future__ import annotations

import shutil
from pathlib import Path
from queue import Queue
from threading import Thread

import pytest
from tools.docs.gdb_session import talk
from typer.testing import CliRunner, Result
from verification.support.needed_tools import NEEDS_TOOLCHAIN, NEEDS_VIRTUAL_BRICK

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import app
from ravenbrick.cli.debug import GDB, gdb_command
from ravenbrick.errors import ExitCode
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import DEBUGGING_BUILD, ElfImage
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario
from ravenbrick.project.templates import create_project
from ravenbrick.project.workspace import Workspace

pytestmark = [
    NEEDS_VIRTUAL_BRICK,
    NEEDS_TOOLCHAIN,
]
SHORT = """schema_version = 1
name = "short"
seed = 1
duration_ms = 1200
[[inputs]]
at_ms = 1_000
input = "touch.1"
value = 1
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """A line follower, whose Ada calls generated C, with a short scenario."""
    workspace = create_project(tmp_path_factory.mktemp("debugging") / "robot", "line")
    (workspace.project / "scenarios" / "short.toml").write_text(SHORT)
    return workspace


@pytest.fixture(scope="module")
def image(project: Workspace) -> ElfImage:
    """Its debugging build."""
    return build_image(project, read_robot(project.project), "debug").image


def ravenbrick(*words: str | Path) -> Result:
    """A command that is called in this process."""
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.mark.skipif(shutil.which(GDB) is None, reason=f"{GDB} is not installed")
def test_locals_and_parameters_of_ada_and_of_generated_c_are_shown(
    project: Workspace, image: ElfImage
) -> None:
    """In the frame that stops and in those that called it."""
    robot = read_robot(project.project)
    scenario = read_scenario(project.project / "scenarios" / "short.toml", robot)
    brick = VirtualTarget().prepare(robot, scenario, image)
    ports: Queue[int] = Queue()
    wanted = {"on_listening": ports.put, "once": True}
    server = Thread(target=brick.serve_debugger, kwargs=wanted, daemon=True)
    server.start()
    command = gdb_command(GDB, image.path, ports.get(timeout=60))
    _, stop, parameters, c_locals, _, ada_locals, _, caller, backtrace, tasks = talk(
        command,
        (
            "break functional_step_instance if Error != 0",
            "continue",
            "info args",
            "info locals",
            "up",
            "info locals",
            "up",
            "info locals",
            "bt",
            "info threads",
        ),
    )
    assert "functional.c" in stop
    assert all(f"{name} = 0x" in parameters for name in ("work", "u", "y"))
    assert all(f"{name} = " in c_locals for name in ("Error", "Proportional", "Limited"))
    assert all(f"{name} = " in ada_locals for name in ("supply", "outputs", "half"))
    assert "raw = " in caller
    assert "tasks.control_task" in backtrace
    # Waiting in code that the start has copied to RAM.
    assert "(coprocessor_task: delayed, priority 30)" in tasks and "?? ()" not in tasks
    shown = (parameters, c_locals, ada_locals, caller, backtrace)
    assert "optimized out" not in "".join(shown)


def test_a_run_of_the_debugging_build_is_labelled_and_kept_apart(
    project: Workspace, image: ElfImage
) -> None:
    """On the terminal, in the recording's name and in the report; by the image, not the option."""
    done = ravenbrick("run", project.project, "short", "--debug")
    assert done.exit_code == 0, done.stderr
    assert f"short.debug.npz ({DEBUGGING_BUILD})" in done.stdout
    own = project.recording("short", "debug")
    assert own.is_file() and not project.recording("short").exists()
    own.unlink()
    done = ravenbrick("run", project.project, "short", "--elf", image.path)
    assert DEBUGGING_BUILD in done.stdout and own.is_file()
    done = ravenbrick("report", project.project)
    assert done.exit_code == 0, done.stderr
    assert f"short ({DEBUGGING_BUILD})" in (project.results / "report.html").read_text()


def test_run_and_upload_do_not_take_it_unasked(project: Workspace, image: ElfImage) -> None:
    """`run` builds the release image beside it; `upload` refuses the file."""
    done = ravenbrick("run", project.project, "short")
    assert done.exit_code == 0, done.stderr
    assert DEBUGGING_BUILD not in done.stdout and project.recording("short").is_file()
    assert project.image("ram", "robot").is_file() and image.path.parent.name == "debug"
    done = ravenbrick("upload", image.path, "--out", project.project / "plain.bin")
    assert done.exit_code == int(ExitCode.USAGE)
    assert f"is a {DEBUGGING_BUILD}" in done.stderr.splitlines()[0]
    assert not (project.project / "plain.bin").exists()


def test_a_second_build_compiles_nothing_and_a_changed_source_is_noticed(
    project: Workspace, image: ElfImage
) -> None:
    """The debugging build has a record of its own sources."""
    robot = read_robot(project.project)
    assert not build_image(project, robot, "debug").changed
    source = project.project / "src" / "following.adb"
    text = source.read_text()
    source.write_text(text.replace("Edge : constant := 0.5;", "Edge : constant := 0.4;"))
    try:
        assert build_image(project, robot, "debug").image.content != image.content
    finally:
        source.write_text(text)
