# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Project folders of tests: the vehicle, a copy of it, images put in the place of built ones."""

from __future__ import annotations

import shutil
from pathlib import Path

from ravenbrick.image.build import choices_of, manifest_file
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.elf import ImageKind
from ravenbrick.image.manifest import BuildManifest
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace

from verification.support.elf_files import make_elf

__all__ = ["VEHICLE", "make_project", "put_image"]

VEHICLE = Path(__file__).resolve().parents[2] / "examples" / "vehicle"


def put_image(project: Path, content: bytes, kind: ImageKind = "ram") -> Path:
    """The project's image has this content, as if built from what is in the folder; its file."""
    workspace, robot = Workspace.of(project), read_robot(project)
    elf = workspace.image(kind, robot.name)
    elf.parent.mkdir(parents=True, exist_ok=True)
    elf.write_bytes(content)
    manifest = BuildManifest.now(choices_of(workspace, robot, Settings.of(robot)), [], [elf])
    manifest.write(manifest_file(elf))
    return elf


def make_project(root: Path) -> Path:
    """Folder `vehicle` with robot.toml, the scenarios and a small image already built."""
    (root / "tools").mkdir()
    (root / "tools" / "ravenbrick.cgpr").touch()
    folder = root / "examples" / "vehicle"
    folder.mkdir(parents=True)
    shutil.copy(VEHICLE / "robot.toml", folder)
    shutil.copytree(VEHICLE / "scenarios", folder / "scenarios")
    put_image(folder, make_elf())
    return folder
