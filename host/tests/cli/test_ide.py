# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Files for other programs: VS Code's tasks and launches, OpenOCD's configuration."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import typer
from verification.support.projects import VEHICLE

from ravenbrick.cli.app import app

ROOT = VEHICLE.parent.parent
CODE = VEHICLE / ".vscode"
ADAPTER = "adapter driver dummy"
SCHEMAS = os.environ.get("RAVENBRICK_VSCODE_SCHEMAS")
with_schemas = pytest.mark.skipif(
    not SCHEMAS,
    reason="RAVENBRICK_VSCODE_SCHEMAS is not set: a folder with tasks.json, launch.json and "
    "extensions.json as VS Code exports its schemas, and cpptools-package.json, the package.json "
    "of its extension for C and C++",
)


def schema(name: str) -> Any:
    """A schema that we did not write."""
    return json.loads((Path(SCHEMAS or "") / name).read_text(encoding="utf-8"))


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
    assert image.endswith("build/vehicle/debug/vehicle.elf")


@with_schemas
@pytest.mark.parametrize("name", ["tasks.json", "extensions.json"])
def test_a_file_is_valid_by_the_editors_own_schema(name: str) -> None:
    """And the schema is not one that takes everything."""
    judge = jsonschema.validators.validator_for(schema(name))(schema(name))
    assert [error.message for error in judge.iter_errors(read(name))] == []
    assert not judge.is_valid({"version": "2.0.0", "tasks": 5, "recommendations": 5})


@with_schemas
def test_a_launch_is_valid_by_the_schema_of_the_extension_that_serves_it() -> None:
    """Each field is one of VS Code's common ones or of the debugger `cppdbg`, and of its type."""
    # VS Code itself adds `type` and `request` to the schema of each debugger.
    common = {"type", "request", *schema("launch.json")["definitions"]["common"]["properties"]}
    debuggers = schema("cpptools-package.json")["contributes"]["debuggers"]
    (own,) = (d["configurationAttributes"]["launch"] for d in debuggers if d["type"] == "cppdbg")
    for launch in read("launch.json")["configurations"]:
        assert [e.message for e in jsonschema.Draft7Validator(own).iter_errors(launch)] == []
        assert set(launch) <= set(own["properties"]) | common
    wrong = jsonschema.Draft7Validator(own)
    assert not wrong.is_valid({"program": 5})


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
