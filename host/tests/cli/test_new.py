# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Project folders from templates: complete, on their own, never over something."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from ravenbrick.cli.app import app
from ravenbrick.errors import UsageError
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.design_script import adopt_design, design_is_due, run_design
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario
from ravenbrick.project.templates import TEMPLATES, create_project
from ravenbrick.project.workspace import Workspace

RAVENBRICK = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]
SLOW = pytest.mark.long("builds and runs a template")


@pytest.mark.parametrize("name", sorted(TEMPLATES))
def test_every_template_makes_a_complete_folder(name: str, tmp_path: Path) -> None:
    """Files of build, editor, container and CI are there; robot and scenarios can be read."""
    project = create_project(tmp_path / "my-robot", name).project
    robot = read_robot(project)
    assert robot.name == "my-robot"
    assert robot.stack_check
    for file in project.glob("scenarios/*.toml"):
        read_scenario(file, robot)
    wanted = ("Makefile", "robot.gpr", "README.md", "src/main.adb", ".gitignore")
    hidden = (".vscode/tasks.json", ".vscode/launch.json", ".devcontainer/devcontainer.json")
    for part in (*wanted, *hidden, ".github/workflows/check.yml"):
        assert (project / part).is_file(), part
    for file in project.rglob("*.json"):
        json.loads(file.read_text())
    files = [file for file in project.rglob("*") if file.is_file()]
    texts = [f.read_text() for f in files if f.suffix not in (".png", ".slx")]
    assert not any(re.search(r"@[A-Z]+@|\.\./\.\.", text) for text in texts)


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_what_exists_is_never_touched(kind: str, tmp_path: Path) -> None:
    """Neither a file nor a folder, not even an empty one."""
    there = tmp_path / "robot"
    if kind == "file":
        there.write_text("mine")
    else:
        there.mkdir()
    with pytest.raises(UsageError, match="exists already"):
        create_project(there, "blank")
    assert there.read_text() == "mine" if kind == "file" else not any(there.iterdir())


DESIGN = "from pathlib import Path\nPath('generated/controller_design.ads').write_text('-- %s')\n"


def test_a_project_made_anew_is_designed_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where one of this name was, with the same design.py, and its products are there."""
    monkeypatch.setenv("RAVENBRICK_BUILD", str(tmp_path / "products"))
    for _ in range(2):
        workspace = create_project(tmp_path / "robot", "motor")
        script = workspace.project / "design.py"
        script.write_text(DESIGN % "anew")
        later_s = script.stat().st_mtime + 60
        os.utime(script, (later_s, later_s))
        settings = Settings.of(read_robot(workspace.project))
        assert design_is_due(workspace, settings)
        run_design(workspace)
        assert not design_is_due(workspace, settings)
        shutil.rmtree(workspace.project)


def test_projects_of_one_name_do_not_take_the_others_design_for_theirs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where they share the folder of products, whichever was designed last."""
    monkeypatch.setenv("RAVENBRICK_BUILD", str(tmp_path / "products"))
    mine, other = (create_project(tmp_path / name / "robot", "motor") for name in ("a", "b"))
    settings = {w.project: Settings.of(read_robot(w.project)) for w in (mine, other)}
    for workspace in (mine, other):
        (workspace.project / "design.py").write_text(DESIGN % "the same")
    run_design(mine)
    mine.design_file.write_text("{}")
    assert not design_is_due(mine, settings[mine.project])
    assert design_is_due(other, settings[other.project])
    adopt_design(other)
    assert not mine.design_file.exists()
    assert design_is_due(mine, settings[mine.project])


def test_a_change_of_the_design_right_after_new_is_seen(tmp_path: Path) -> None:
    """Within the same clock tick as the controller that was copied."""
    assert (
        CliRunner().invoke(app, ["new", str(tmp_path / "robot"), "--template", "motor"]).exit_code
        == 0
    )
    workspace = Workspace.of(tmp_path / "robot")
    settings = Settings.of(read_robot(workspace.project))
    assert not design_is_due(workspace, settings)
    script = workspace.project / "design.py"
    copied_s = script.stat().st_mtime
    script.write_text(script.read_text() + "\n")
    os.utime(script, (copied_s, copied_s))
    assert design_is_due(workspace, settings)


@pytest.mark.parametrize("name", ["My Robot", "9lives", "robot!"])
def test_a_name_that_is_none_is_refused(name: str, tmp_path: Path) -> None:
    """The image and the folder of results are called like the robot."""
    with pytest.raises(UsageError, match="is not a valid robot name"):
        create_project(tmp_path / name, "blank")
    assert not any(tmp_path.iterdir())


def test_an_unknown_template_names_the_others(tmp_path: Path) -> None:
    """All six."""
    with pytest.raises(UsageError, match="vehicle, paper, motor, balance, line, blank"):
        create_project(tmp_path / "robot", "drone")


def run(folder: Path, *command: str) -> str:
    """Output of a command that must succeed in the folder."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {k: v for k, v in os.environ.items() if k != "RAVENBRICK_BUILD"}
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, env={**environment, "PATH": path}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n == "blank" else SLOW) for n in sorted(TEMPLATES)]
)
def test_from_new_to_a_run(name: str, tmp_path: Path) -> None:
    """`new`, then VS Code's tasks: the criteria are met, every time has a bound without a question,
    and all is written inside the folder."""
    run(tmp_path, *RAVENBRICK, "new", "my-robot", "--template", name)
    project = tmp_path / "my-robot"
    listed = json.loads((project / ".vscode" / "tasks.json").read_text())["tasks"]
    tasks = {task["label"]: task for task in listed}
    assert tasks["run"]["dependsOn"] == "build"
    run(project, "bash", "-c", tasks["build"]["command"])
    answer: dict[str, Any] = json.loads(
        run(project, "bash", "-c", f"{tasks['run']['command']} --json")
    )
    assert answer["scenario"] == TEMPLATES[name].scenario
    assert answer["criteria"] and all(criterion["met"] for criterion in answer["criteria"])
    assert Path(answer["recording"]).is_relative_to(project)
    arguments = ("analyse", ".", "--scenario", TEMPLATES[name].scenario, "--no-margins", "--json")
    timing: dict[str, Any] = json.loads(run(project, *RAVENBRICK, *arguments))
    assert timing["schedulable"]
    assert all(task["ratio"] >= 1 and task["stack_bound_bytes"] for task in timing["tasks"])
    assert Path(timing["report"]).is_relative_to(project)
