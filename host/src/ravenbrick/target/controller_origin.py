# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the controller in a folder comes from, when it is not the project's design.py."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ravenbrick.whole_file import write_whole

__all__ = ["ORIGIN_FILE", "Origin", "read_origin", "replace_controller"]

ORIGIN_FILE = "controller.json"


@dataclass(frozen=True)
class Origin:
    """The command and the model that a controller is from, and the files that it wrote."""

    file: Path
    command: str
    model: str
    files: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """For the user: "bound from 'pid_ert_rtw' by 'ravenbrick bind'"."""
        done = {"bind": "bound", "import": "imported"}.get(self.command, "made")
        return f"{done} from '{self.model}' by 'ravenbrick {self.command}'"


def read_origin(folder: Path) -> Origin | None:
    """The record in a folder of generated files; None when there is none."""
    file = folder / ORIGIN_FILE
    if not file.is_file():
        return None
    try:
        content = json.loads(file.read_text("utf-8"))
        names = tuple(str(name) for name in content["files"])
        return Origin(file, str(content["command"]), str(content["model"]), names)
    except (OSError, ValueError, KeyError, TypeError):
        return Origin(file, "bind", "an unreadable record", ())


def replace_controller(folder: Path, command: str, model: Path, files: Mapping[str, str]) -> None:
    """Put a controller into a folder in place of the one that is there, and record its origin.

    C of the one before is removed, as two controllers would be linked together; Ada that the new
    one does not write stays, such as the constants that an application reads. The record is written
    first: from then on design.py writes nothing there. Raises `OSError`.
    """
    before = read_origin(folder)
    content = {"command": command, "model": model.resolve().name, "files": sorted(files)}
    write_whole(folder / ORIGIN_FILE, json.dumps(content, indent=1) + "\n")
    old = {file.name for file in folder.glob("*.[ch]")} | set(before.files if before else ())
    for name in old - set(files):
        (folder / name).unlink(missing_ok=True)
    for name, text in sorted(files.items()):
        write_whole(folder / name, text)
