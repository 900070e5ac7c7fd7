# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""New projects: an example of the tree with what a folder of its own needs besides."""

from __future__ import annotations

import json
import re
import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from ravenbrick.errors import UsageError
from ravenbrick.project.workspace import Workspace, tree

__all__ = ["FROM_DIAGRAM", "TEMPLATES", "Template", "create_from", "create_project", "template_of"]

NAME = re.compile(r"[a-z][a-z0-9_-]*\Z")
LEFT_OUT = ("Makefile", "tests", "__pycache__")


@dataclass(frozen=True)
class Template:
    """An example below examples/, and the scenario to begin with."""

    example: str
    scenario: str
    description: str


TEMPLATES = {
    "vehicle": Template("vehicle", "drive", "two driven wheels, castor, wired joystick"),
    "paper": Template("paper", "drive", "the same with the listings of the 2012 paper"),
    "motor": Template("motor-bench", "step", "one motor on the bench, speed and position"),
    "balance": Template("balancer", "let-go", "two-wheeled balancing robot with a gyro"),
    "line": Template("line-follower", "lap", "line follower with a light sensor"),
    "blank": Template("blank", "press", "one motor, one touch sensor, two tasks"),
}

# The example gives the files that are no sources; a folder here gives those.
FROM_DIAGRAM = Template(
    "blank", "start", "an empty diagram: a number drives motor B; no Ada by hand"
)


def template_of(example: str) -> str | None:
    """The template that is made from a folder of examples/; None where there is none."""
    return next((name for name, known in TEMPLATES.items() if known.example == example), None)


def _ignored(_folder: str, names: list[str]) -> set[str]:
    return {name for name in names if name in LEFT_OUT}


def _rename_main(project: Path) -> None:
    """The vehicle's main procedure gets the name that robot.gpr expects."""
    old = project / "src" / "vehicle.adb"
    if old.is_file():
        text = old.read_text("utf-8")
        (project / "src" / "main.adb").write_text(
            text.replace("procedure Vehicle", "procedure Main").replace("end Vehicle", "end Main"),
            encoding="utf-8",
        )
        old.unlink()
        project_file = project / "robot.gpr"
        project_file.write_text(project_file.read_text("utf-8").replace("vehicle.adb", "main.adb"))


def _adapt(project: Path, template: Template) -> None:
    robot = project / "robot.toml"
    text = robot.read_text("utf-8")
    changed = re.sub(r'^name = ".*"$', f'name = "{project.name}"', text, count=1, flags=re.M)
    robot.write_text(changed, encoding="utf-8")
    for file in (project / "README.md", *project.glob("scenarios/*.toml")):
        text = file.read_text("utf-8").replace(f"examples/{template.example}", ".")
        file.write_text(text, encoding="utf-8")


def _add_own_files(
    project: Path, template: Template, folder: str, marks: Mapping[str, str]
) -> None:
    """The files of a folder here, whose names have `+` for `/`, with texts for marks."""
    commands = json.dumps(str(Path(sys.executable).parent), ensure_ascii=False)[1:-1]
    own = {"NAME": project.name, "SCENARIO": template.scenario, "COMMANDS": commands, **marks}
    for source in sorted(resources.files(__package__).joinpath(folder).iterdir(), key=str):
        text = source.read_text(encoding="utf-8")
        for mark, value in own.items():
            text = text.replace(f"@{mark}@", value)
        path = project / source.name.removesuffix(".in").replace("+", "/")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


_HOW_TO = """
## In this folder

    make                           # image: build/{name}/ram/{name}.elf
    ravenbrick run . {scenario}
    make test                      # every scenario must meet its criteria
    ravenbrick debug . {scenario} --gdb

`make` runs the `ravenbrick` of the tree that RAVENBRICK_HOME names, otherwise the one on the PATH.
VS Code has tasks for build, run and test, and a launch configuration that debugs the virtual brick.
They find `ravenbrick` on the PATH, else in the folder that `.vscode/settings.json` names.
The dev container is the image `ravenbrick`, made from tools/Containerfile of the Ravenbrick tree.
`.github/workflows/check.yml` runs `make test` on every push; set the variable
RAVENBRICK_REPOSITORY there.
"""


def create_project(directory: Path, template_name: str) -> Workspace:
    """Make a project folder; raises `UsageError` and then has written nothing."""
    template = TEMPLATES.get(template_name)
    if template is None:
        raise UsageError(
            f"there is no template '{template_name}'; choose one of {', '.join(TEMPLATES)}"
        )
    return create_from(directory, template)


def create_from(
    directory: Path,
    template: Template,
    folder: str | None = None,
    marks: Mapping[str, str] | None = None,
) -> Workspace:
    """Make a project folder of a template; raises `UsageError` and then has written nothing.

    The files of the `folder` here, with the texts for their marks, take the place of the example's
    sources and scenarios.
    """
    project = directory.resolve()
    if not NAME.match(project.name):
        raise UsageError(
            f"'{project.name}' is not a valid robot name; use small letters, digits, '-' and '_', "
            "beginning with a letter"
        )
    if project.exists():
        raise UsageError(f"'{directory}' exists already; nothing was changed; name another folder")
    example = tree() / "examples" / template.example
    if not (example / "robot.toml").is_file():
        raise UsageError(f"'{example}' is not there; restore it with git")
    try:
        shutil.copytree(example, project, ignore=_ignored)
        shutil.copy(tree() / "tools" / "project.mk", project / "Makefile")
        _rename_main(project)
        _adapt(project, template)
        if folder:
            for name in ("src", "scenarios"):
                shutil.rmtree(project / name)
            _add_own_files(project, template, folder, marks or {})
        _add_own_files(project, template, "files", {})
        with (project / "README.md").open("a", encoding="utf-8") as readme:
            readme.write(_HOW_TO.format(name=project.name, scenario=template.scenario))
    except OSError:
        shutil.rmtree(project, ignore_errors=True)
        raise
    return Workspace.of(project)
