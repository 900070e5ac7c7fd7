# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Files that `ravenbrick new` writes for other programs, by those programs' own schemas."""

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
import yaml

from ravenbrick.project.templates import TEMPLATES, create_project

SCHEMAS = os.environ.get("RAVENBRICK_VSCODE_SCHEMAS")
WORKFLOW, CONTAINER = ".github/workflows/check.yml", ".devcontainer/devcontainer.json"
VALID = [
    (".vscode/tasks.json", "tasks.json"),
    (".vscode/extensions.json", "extensions.json"),
    (CONTAINER, "devContainer.base.schema.json"),
    (WORKFLOW, "github-workflow.json"),
]


def read(project: Path, name: str) -> Any:
    """A file of JSON or YAML, whose key `on` is text for GitHub and true for PyYAML (YAML 1.1)."""
    content = yaml.safe_load((project / name).read_text())
    return {"on" if key is True else key: value for key, value in content.items()}


def judge(name: str) -> Any:
    """The validator of a schema that we did not write."""
    schema = json.loads((Path(SCHEMAS or "") / name).read_text(encoding="utf-8"))
    return jsonschema.validators.validator_for(schema)(schema)


@pytest.mark.skipif(
    not SCHEMAS,
    reason="RAVENBRICK_VSCODE_SCHEMAS is not set: the folder of test_ide.py, with github-workflow."
    "json of SchemaStore and devContainer.base.schema.json of devcontainers/spec besides",
)
@pytest.mark.parametrize("template", sorted(TEMPLATES))
def test_every_file_is_valid_by_its_schema(template: str, tmp_path: Path) -> None:
    """Tasks, extensions, container and workflow; the debugger's launch by its extension."""
    project = create_project(tmp_path / "my-robot", template).project
    for name, schema in VALID:
        found = [error.message for error in judge(schema).iter_errors(read(project, name))]
        assert found == [], name
    (launch,) = read(project, ".vscode/launch.json")["configurations"]
    extension = json.loads((Path(SCHEMAS or "") / "cpptools-package.json").read_text())
    (own,) = (
        debugger["configurationAttributes"]["launch"]
        for debugger in extension["contributes"]["debuggers"]
        if debugger["type"] == launch["type"]
    )
    assert [e.message for e in jsonschema.Draft7Validator(own).iter_errors(launch)] == []


@pytest.mark.skipif(not SCHEMAS, reason="RAVENBRICK_VSCODE_SCHEMAS is not set: as above")
def test_the_schemas_refuse_what_is_wrong(tmp_path: Path) -> None:
    """The test above can fail."""
    project = create_project(tmp_path / "my-robot", "blank").project
    workflow = read(project, WORKFLOW)
    del workflow["jobs"]["check"]["runs-on"]
    assert not judge("github-workflow.json").is_valid(workflow)
    wrong = {**read(project, CONTAINER), "mounts": 5}
    assert not judge("devContainer.base.schema.json").is_valid(wrong)


def test_the_workflow_runs_what_the_folder_has(tmp_path: Path) -> None:
    """Every command of a step is one for the shell; the last one is a target of the Makefile."""
    project = create_project(tmp_path / "my-robot", "blank").project
    steps = read(project, WORKFLOW)["jobs"]["check"]["steps"]
    commands = [step["run"] for step in steps if "run" in step]
    for command in commands:
        subprocess.run(["bash", "-n", "-c", command], check=True)
    assert commands[-1].endswith("make -C project test")
    assert all(("uses" in step) != ("run" in step) for step in steps)
    packages = commands[0].partition("install -y ")[2].split()
    assert "make" in packages and all(shutil.which(package) for package in packages)


def test_an_error_of_the_compiler_is_found_in_the_source(tmp_path: Path) -> None:
    """By the pattern of the task that builds, in the words of GNAT."""
    project = create_project(tmp_path / "my-robot", "blank").project
    tasks = {task["label"]: task for task in read(project, ".vscode/tasks.json")["tasks"]}
    (matcher,) = tasks["build"]["problemMatcher"]
    found = re.search(matcher["pattern"]["regexp"], 'tasks.adb:12:05: error: missing ";"')
    assert found is not None and found.group(1, 2, 4) == ("tasks.adb", "12", "error")
