# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from ravenbrick.errors import BuildError, ImageFileError, ProjectFileError, ToolMissingError
from ravenbrick.target import build
from ravenbrick.target.robot import Robot
from ravenbrick.target.workspace import Workspace


@pytest.fixture
def no_toolchain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only make is needed for these Makefiles."""
    monkeypatch.setattr(build, "TOOLS", build.TOOLS[:1])


def _makefile(project: Path, recipe: str) -> Workspace:
    (project / "Makefile").write_text(f"ram:\n\t{recipe}\n")
    return Workspace.of(project)


def test_a_missing_toolchain_names_tools_and_packages(
    project: Path, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sentence says which program and which package."""
    monkeypatch.setenv("PATH", str(project))
    with pytest.raises(ToolMissingError, match=r"'gprbuild' .*'make setup'.* gcc-arm-none-eabi"):
        build.build_image(Workspace.of(project), robot, "ram")


@pytest.mark.usefixtures("no_toolchain")
def test_a_project_without_a_makefile_is_refused(project: Path, robot: Robot) -> None:
    """The missing file is named."""
    with pytest.raises(ProjectFileError, match="Makefile:1: is missing"):
        build.build_image(Workspace.of(project), robot, "ram")


@pytest.mark.usefixtures("no_toolchain")
def test_the_compilers_first_error_is_in_the_sentence(project: Path, robot: Robot) -> None:
    """The user sees file and line without searching."""
    workspace = _makefile(project, "@echo 'tasks.adb:12:7: error: missing \";\"'; exit 1")
    with pytest.raises(BuildError, match=r"tasks\.adb:12:7: error: missing"):
        build.build_image(workspace, robot, "ram")


@pytest.mark.usefixtures("no_toolchain")
def test_the_profile_of_the_robot_reaches_every_tool(project: Path, robot: Robot) -> None:
    """Make hands it to gprbuild and to the run-time's Makefile by the environment."""
    workspace = _makefile(project, '@echo "main.adb:1:1: error: $$PROFILE"; exit 1')
    with pytest.raises(BuildError, match="error: jorvik"):
        build.build_image(workspace, replace(robot, profile="jorvik"), "ram")


@pytest.mark.usefixtures("no_toolchain")
def test_a_project_finds_the_program_that_builds_it(
    project: Path, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It asks 'ravenbrick home', also when the program was called by its path."""
    folder = Path(sys.executable).parent
    path = os.environ["PATH"].split(os.pathsep)
    monkeypatch.setenv("PATH", os.pathsep.join(p for p in path if Path(p) != folder))
    workspace = _makefile(project, '@echo "main.adb:1:1: error: $$PATH"; exit 1')
    with pytest.raises(BuildError, match=rf"error: .*:{folder}; correct"):
        build.build_image(workspace, robot, "ram")


@pytest.mark.usefixtures("no_toolchain")
def test_an_image_that_the_linker_cannot_place_is_too_large(project: Path, robot: Robot) -> None:
    """The linker's complaint becomes a sentence about the image with its own exit code."""
    workspace = _makefile(project, '@echo "ld: region \\`RAM\' overflowed by 312 bytes"; exit 1')
    with pytest.raises(ImageFileError, match="the ram image is 312 bytes too large for the RAM"):
        build.build_image(workspace, robot, "ram")


@pytest.mark.usefixtures("no_toolchain")
def test_a_build_leaves_a_memory_report_beside_the_image(project: Path, robot: Robot) -> None:
    """memory.json is written after each build."""
    built = build.build_image(_makefile(project, "@echo nothing to do"), robot, "ram")
    assert built.memory_file == built.image.path.parent / "memory.json"
    assert '"available": 57344' in built.memory_file.read_text()
