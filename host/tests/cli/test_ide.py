# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Files for other programs: VS Code's tasks and launches, OpenOCD's configuration."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from typing import Any

import pytest
import typer
from host.tests.conftest import VEHICLE

from ravenbrick.cli.app import app

ROOT = VEHICLE.parent.parent
CODE = VEHICLE / ".vscode"
ADAPTER = "adapter driver dummy"


def read(name: str) -> Any:
    """A file of VS Code."""
    return json.loads((CODE / name).read_text())


def tasks() -> dict[str, Any]:
    """The tasks by label."""
    return {task["label"]: task for task in read("tasks.json")["tasks"]}


def test_every_task_calls_a_command_that_exists() -> None:
    """With scenarios that exist."""
    commands = set(typer.main.get_group(app).commands)
    called = [t["args"][0] for t in tasks().values() if t["command"].endswith("/ravenbrick")]
    assert called and set(called) <= commands
    (choice,) = read("tasks.json")["inputs"]
    scenarios = {path.stem for path in (VEHICLE / "scenarios").glob("*.toml")}
    assert set(choice["options"]) <= scenarios


def test_a_launch_begins_when_the_server_says_that_it_waits() -> None:
    """The task's pattern matches what `ravenbrick debug` prints, and the port is its default."""
    launches = {launch["name"]: launch for launch in read("launch.json")["configurations"]}
    virtual = launches["Virtual brick"]
    matcher = tasks()[virtual["preLaunchTask"]]["problemMatcher"]["background"]
    said = "the brick waits on 127.0.0.1:3333; Ctrl-C ends it; connect with"
    assert re.search(matcher["endsPattern"], said)
    assert virtual["miDebuggerServerAddress"] in said
    assert {launch["preLaunchTask"] for launch in launches.values()} <= set(tasks())
    image = virtual["program"].replace("${workspaceFolder}", str(VEHICLE))
    assert image.endswith("build/vehicle/ram/vehicle.elf")


def test_an_error_of_the_compiler_is_found() -> None:
    """GNAT's and GCC's way to write a place."""
    (matcher,) = tasks()["build"]["problemMatcher"]
    found = re.search(matcher["pattern"]["regexp"], 'vehicle.adb:12:05: error: missing ";"')
    assert found is not None
    assert found.group(1, 2, 3, 4) == ("vehicle.adb", "12", "05", "error")


@pytest.mark.skipif(
    shutil.which("openocd") is None, reason="openocd is not installed (Debian package openocd)"
)
def test_openocd_takes_the_configuration_of_the_brick() -> None:
    """Read by OpenOCD itself, with an adapter that does nothing."""
    file = ROOT / "tools" / "openocd" / "nxt.cfg"
    command = ["openocd", "-c", ADAPTER, "-f", str(file), "-c"]
    report = "echo [target names]; echo [flash list]; echo [jtag names]; shutdown"
    done = subprocess.run([*command, report], capture_output=True, text=True, check=False)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert "Error" not in said
    assert "nxt.cpu" in said and "at91sam7" in said


@pytest.mark.skipif(
    shutil.which("openocd") is None, reason="openocd is not installed (Debian package openocd)"
)
def test_openocd_refuses_a_wrong_configuration(tmp_path: Any) -> None:
    """The test above can fail."""
    wrong = tmp_path / "wrong.cfg"
    text = (ROOT / "tools" / "openocd" / "nxt.cfg").read_text()
    wrong.write_text(text.replace("arm7tdmi -endian", "arm8tdmi -endian"))
    command = ["openocd", "-c", ADAPTER, "-f", str(wrong), "-c", "shutdown"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
