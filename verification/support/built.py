# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Images that tests put in the place of built ones."""

from __future__ import annotations

from pathlib import Path

from ravenbrick.image.build import choices_of, manifest_file
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.elf import ImageKind
from ravenbrick.image.manifest import BuildManifest
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace

__all__ = ["put_image"]


def put_image(project: Path, content: bytes, kind: ImageKind = "ram") -> Path:
    """The project's image has this content, as if built from what is in the folder; its file."""
    workspace, robot = Workspace.of(project), read_robot(project)
    elf = workspace.image(kind, robot.name)
    elf.parent.mkdir(parents=True, exist_ok=True)
    elf.write_bytes(content)
    made = BuildManifest.now(choices_of(workspace, robot, Settings.of(robot)), [], [elf])
    made.write(manifest_file(elf))
    return elf
