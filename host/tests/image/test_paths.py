# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Folders with names that make and the compilers do not like: real builds in them."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from ravenbrick.image.build import build_image, current_image
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.run_time import run_time_library
from ravenbrick.project.robot import read_robot
from ravenbrick.project.templates import create_project
from ravenbrick.project.workspace import Workspace, run_time_folder

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = f'"{sys.executable}" -c "from ravenbrick.cli import main; main()"'
NAME = 'a b "c" d\'e, ü日 100% $(x) co:lon #' + "long" * 45


@pytest.fixture
def hostile(tmp_path: Path) -> Path:
    """A folder whose name has it all."""
    folder = tmp_path / NAME
    folder.mkdir()
    return folder


def test_a_project_in_a_folder_of_any_name_is_built_and_run(hostile: Path) -> None:
    """By `make`, which shows the tools; then nothing has changed, also not through a link."""
    project = create_project(hostile / "my-robot", "blank").project
    said = subprocess.run(
        ["make", "-C", project, f"RAVENBRICK={PROGRAM}"], capture_output=True, text=True, check=True
    ).stdout
    assert "gnat1     tasks.adb -> assembly" in said
    assert "gnatbind  main.ali -> b__main.adb" in said
    assert "ld        *.o by ram.ld -> my-robot.elf" in said
    link = hostile.parent / "a link"
    link.symlink_to(project, target_is_directory=True)
    assert current_image(Workspace.of(link), read_robot(link), "ram") is not None
    done = subprocess.run(
        f"{PROGRAM} run . press --json", shell=True, cwd=link, capture_output=True, check=True
    )
    assert all(criterion["met"] for criterion in json.loads(done.stdout)["criteria"])


def test_the_tree_may_lie_in_a_folder_of_any_name(
    hostile: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Read-only, too: all that is built goes elsewhere."""
    for name in ("tools", "drivers", "examples/motor-bench"):
        shutil.copytree(ROOT / name, hostile / name, ignore=shutil.ignore_patterns("tests"))
    library = run_time_library(Settings.of(read_robot(ROOT / "examples" / "blank"), {}))
    monkeypatch.setenv("RAVENBRICK_RTS", str(library))
    monkeypatch.setenv("RAVENBRICK_HOME", str(hostile))
    monkeypatch.setenv("RAVENBRICK_BUILD", str(tmp_path / "made here, not there"))
    project = hostile / "examples" / "motor-bench"
    for folder, _, _ in os.walk(hostile):
        Path(folder).chmod(0o555)
    try:
        built = build_image(Workspace.of(project), read_robot(project), "ram")
    finally:
        for folder, _, _ in os.walk(hostile):
            Path(folder).chmod(0o755)
    assert built.image.path.is_relative_to(tmp_path / "made here, not there")
    assert not (hostile / "build").exists()


def test_the_run_time_is_built_in_a_folder_of_any_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of an installed package: in the user's cache, one folder for each state of the sources."""
    tree = tmp_path / "tree"
    (tree / "tools").mkdir(parents=True)
    (tree / "tools" / "ravenbrick.cgpr").touch()
    shutil.copy(ROOT / "tools" / "toolchain.mk", tree / "tools")
    shutil.copytree(ROOT / "runtime", tree / "runtime", ignore=shutil.ignore_patterns("tests"))
    monkeypatch.setenv("RAVENBRICK_HOME", str(tree))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / NAME.replace(":", "")))
    folder = run_time_folder(lambda: "digest")
    assert folder == tmp_path / NAME.replace(":", "") / "ravenbrick" / "runtime" / "digest"
    folder.mkdir(parents=True)
    (folder / "sources").symlink_to(tree / "runtime", target_is_directory=True)
    unit = "./ravenscar/adalib/ravenbrick.o"
    subprocess.run(
        ["make", "-s", "-C", folder, "-f", "sources/Makefile", "SOURCES=sources", "BUILD=.", unit],
        check=True,
    )
    assert (folder / unit).is_file() and (folder / unit).with_suffix(".ali").is_file()
