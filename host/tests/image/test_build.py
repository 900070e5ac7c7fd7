# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Building with a toolchain that does what the test says: what is built when, and by whom."""

from __future__ import annotations

import fcntl
import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from verification.support.fake_tools import install_fake_tools, write_recipe

from ravenbrick.errors import (
    BuildError,
    DesignError,
    ImageFileError,
    ProjectFileError,
    ToolMissingError,
    UsageError,
)
from ravenbrick.image.build import build_image, clean_project, manifest_file
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.workspace import Workspace

FOLDERS = ("DRIVERS_CONFIGURATION", "GENERATED")
SETTING = {"CODE": "thumb", "HEAP": "4096", **dict.fromkeys(FOLDERS, "src")}


@pytest.fixture
def workspace(project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workspace:
    """A project and a toolchain that leaves an image for it."""
    install_fake_tools(tmp_path / "tool-folder", monkeypatch)
    write_recipe(project, "echo once >> calls")
    (project / "src" / "main.adb").write_text("procedure Main is null;")
    return Workspace.of(project)


def calls(workspace: Workspace) -> int:
    """How often the toolchain was called."""
    file = workspace.project / "calls"
    return len(file.read_text().splitlines()) if file.is_file() else 0


def test_a_missing_toolchain_names_tools_and_packages(
    project: Path, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sentence says which program and which package."""
    monkeypatch.setenv("PATH", str(project))
    with pytest.raises(ToolMissingError, match=r"'gprbuild' .* gcc-arm-none-eabi"):
        build_image(Workspace.of(project), robot, "ram")


def test_a_project_without_a_project_file_is_refused(workspace: Workspace, robot: Robot) -> None:
    """The missing file is named."""
    (workspace.project / "robot.gpr").unlink()
    with pytest.raises(ProjectFileError, match=r"robot\.gpr:1: is missing"):
        build_image(workspace, robot, "ram")


def test_nothing_changed_calls_no_tool(workspace: Workspace, robot: Robot) -> None:
    """The image is the same, and its memory is known."""
    first = build_image(workspace, robot, "ram")
    again = build_image(workspace, robot, "ram")
    assert calls(workspace) == 1
    assert (first.changed, again.changed) == (True, False)
    assert first.image == again.image and first.memory == again.memory
    assert '"available": 57344' in again.memory_file.read_text()


def edited(file: Path) -> None:
    """Another content of the same length, at the same time as before."""
    file.write_text(file.read_text().replace("null", "nill"))


@pytest.mark.parametrize(
    "change",
    [
        lambda p: edited(p / "src" / "main.adb"),
        lambda p: (p / "src" / "more.ads").touch(),
        lambda p: (p / "src" / "main.adb").unlink(),
        lambda p: (p / "robot.gpr").write_text("-- other"),
        lambda p: (p / "src" / "main.adb").rename(p / "src" / "other.adb"),
    ],
    ids=["edited", "added", "removed", "project file", "renamed"],
)
def test_a_changed_source_is_built(
    workspace: Workspace, robot: Robot, change: Callable[[Path], object]
) -> None:
    """Each kind of change of what an image is made from."""
    build_image(workspace, robot, "ram")
    change(workspace.project)
    build_image(workspace, robot, "ram")
    assert calls(workspace) == 2


def test_sources_that_are_edited_while_they_are_compiled_are_all_compiled_again(
    workspace: Workspace, robot: Robot
) -> None:
    """What the compiler read is not known: no object of that build is kept."""
    products = workspace.products / workspace.project.name
    recipe = f"find {products} -name kept.o >> found; "
    recipe += f"for objects in {products}/objects/*; do touch $objects/kept.o; done"
    write_recipe(workspace.project, f"{recipe}; echo '-- later' >> src/main.adb")
    build_image(workspace, robot, "ram")
    write_recipe(workspace.project, recipe)
    build_image(workspace, robot, "ram")
    assert not (workspace.project / "found").read_text()
    edited(workspace.project / "src" / "main.adb")
    build_image(workspace, robot, "ram")
    assert "kept.o" in (workspace.project / "found").read_text()


def test_other_switches_in_the_project_file_compile_the_project_again(
    workspace: Workspace, robot: Robot
) -> None:
    """gprbuild would keep its objects. Those of the drivers do not depend on that file."""
    build = workspace.products
    write_recipe(
        workspace.project, f"for f in {build}/*/objects/* {build}/drivers/*; do touch $f/o; done"
    )
    build_image(workspace, robot, "ram")
    own = sorted(build.glob("*/objects/*/o"))
    drivers = sorted(build.glob("drivers/*/o"))
    assert own and drivers
    write_recipe(workspace.project, "true")
    (workspace.project / "robot.gpr").write_text('project Robot is -- "-Os"')
    build_image(workspace, robot, "ram")
    assert not any(file.exists() for file in own)
    assert all(file.exists() for file in drivers)


def test_a_source_that_was_only_touched_is_not_built(workspace: Workspace, robot: Robot) -> None:
    """Contents count, not times."""
    build_image(workspace, robot, "ram")
    (workspace.project / "src" / "main.adb").touch()
    build_image(workspace, robot, "ram")
    assert calls(workspace) == 1


@pytest.mark.parametrize("name", sorted(SETTING))
def test_another_setting_is_another_image(
    workspace: Workspace, robot: Robot, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the environment, for the command as for make; back again, too."""
    build_image(workspace, robot, "ram")
    value = str(workspace.project / "src") if name in FOLDERS else SETTING[name]
    monkeypatch.setenv(name, value)
    build_image(workspace, robot, "ram")
    monkeypatch.delenv(name)
    build_image(workspace, robot, "ram")
    assert calls(workspace) == 3


def test_another_profile_is_another_image(workspace: Workspace, robot: Robot) -> None:
    """The profile of robot.toml reaches the tools."""
    write_recipe(workspace.project, 'echo "$@" > said')
    build_image(workspace, robot, "ram")
    build_image(workspace, replace(robot, profile="jorvik"), "ram")
    record = json.loads(manifest_file(workspace.image("ram", robot.name)).read_text())
    assert record["settings"]["PROFILE"] == "jorvik"


def test_a_setting_that_is_none_is_refused(
    workspace: Workspace, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the choices."""
    monkeypatch.setenv("CODE", "mips")
    with pytest.raises(UsageError, match="CODE=mips: must be arm or thumb"):
        build_image(workspace, robot, "ram")


def test_a_controller_that_the_project_file_does_not_take_is_refused(
    workspace: Workspace, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise the old controller would be built in."""
    monkeypatch.setenv("GENERATED", str(workspace.project / "elsewhere"))
    with pytest.raises(BuildError, match=r"robot\.gpr: .*Application\.Generated in its Source_Dir"):
        build_image(workspace, robot, "ram")


def test_a_failed_build_leaves_no_image(workspace: Workspace, robot: Robot) -> None:
    """The error is the first line, and no later command can take the old image."""
    build_image(workspace, robot, "ram")
    write_recipe(workspace.project, "echo 'src/main.adb:12:7: error: missing \";\"'; exit 4")
    edited(workspace.project / "src" / "main.adb")
    for _ in range(2):
        with pytest.raises(BuildError, match=r"src/main\.adb:12:7: missing \";\"$"):
            build_image(workspace, robot, "ram")
    assert not workspace.image("ram", robot.name).exists()


def test_an_image_that_the_linker_cannot_place_is_too_large(
    workspace: Workspace, robot: Robot
) -> None:
    """The linker's complaint becomes a sentence about the image with its own exit code."""
    write_recipe(workspace.project, 'echo "ld: region \\`CODE\' overflowed by 312 bytes"; exit 1')
    with pytest.raises(ImageFileError, match="the ram image is 312 bytes too large for the RAM"):
        build_image(workspace, robot, "ram")


def test_a_full_disk_is_named(workspace: Workspace, robot: Robot) -> None:
    """Whichever tool says it, and whatever else is said."""
    write_recipe(
        workspace.project,
        "echo 'main.adb:1:1: error: x'; echo '/tmp/cc.s: No space left on device'; exit 1",
    )
    with pytest.raises(BuildError, match="the disk is full; free some space"):
        build_image(workspace, robot, "ram")


def test_a_folder_that_cannot_be_written_is_named(
    workspace: Workspace, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sentence says what to do."""
    (workspace.project / "file").touch()
    monkeypatch.setenv("RAVENBRICK_BUILD", str(workspace.project / "file"))
    with pytest.raises(UsageError, match=r"cannot be written .*RAVENBRICK_BUILD"):
        build_image(workspace, robot, "ram")


DESIGN = "from pathlib import Path\nPath('generated').mkdir(exist_ok=True)\n"


def test_design_runs_once_and_when_it_has_changed(workspace: Workspace, robot: Robot) -> None:
    """Contents count, its own and that of what it wrote, which is not written for nothing."""
    script, made = workspace.project / "design.py", workspace.project / "generated" / "functional.c"
    script.write_text(DESIGN + "Path('generated/functional.c').write_text('one')\n")
    build_image(workspace, robot, "ram")
    assert made.read_text() == "one"
    written_ns = made.stat().st_mtime_ns
    script.touch()
    build_image(workspace, robot, "ram")
    assert made.stat().st_mtime_ns == written_ns
    made.write_text("of another design")
    build_image(workspace, robot, "ram")
    assert made.read_text() == "one"
    script.write_text(script.read_text().replace("one", "two"))
    build_image(workspace, robot, "ram")
    assert made.read_text() == "two"


def test_a_design_that_fails_names_its_line(workspace: Workspace, robot: Robot) -> None:
    """And the exception; nothing is built."""
    (workspace.project / "design.py").write_text("x = 1\n\ny = x / 0\n")
    with pytest.raises(DesignError, match=r"design\.py:3: ZeroDivisionError: division by zero"):
        build_image(workspace, robot, "ram")
    assert calls(workspace) == 0


def test_the_second_command_waits_for_the_first(workspace: Workspace, robot: Robot) -> None:
    """It says so, and builds when the first has ended; a lock file alone stops nothing."""
    workspace.products.mkdir(exist_ok=True)
    with (workspace.products / ".lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        program = "from ravenbrick.cli import main; main()"
        second = subprocess.Popen(
            [sys.executable, "-c", program, "build", str(workspace.project)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert second.stderr is not None
        said = second.stderr.readline()
        assert said == "waiting for another ravenbrick command in this project\n"
        assert calls(workspace) == 0
    assert second.wait() == 0
    assert calls(workspace) == 1


def test_cleaning_removes_only_what_was_built(workspace: Workspace) -> None:
    """For this project."""
    robot = read_robot(workspace.project)
    build_image(workspace, robot, "ram")
    other = workspace.products / "other" / "ram"
    other.mkdir(parents=True)
    clean_project(workspace)
    assert not workspace.image("ram", robot.name).exists()
    assert other.is_dir() and (workspace.project / "src").is_dir()
