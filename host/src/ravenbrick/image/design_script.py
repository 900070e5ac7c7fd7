# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A project's design.py: when it is run, and what its failure says."""

from __future__ import annotations

import json
import os
import re
from contextlib import suppress
from pathlib import Path

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import DesignError, shown_path
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.controller_origin import read_origin
from ravenbrick.image.manifest import file_digest
from ravenbrick.json_values import json_values
from ravenbrick.project.robot import ROBOT_FILE
from ravenbrick.project.workspace import Workspace
from ravenbrick.subprocesses import run_script

__all__ = ["DESIGN_SCRIPT", "adopt_design", "design_is_due", "run_design"]

DESIGN_SCRIPT = "design.py"
# Files that were copied together are no older than one another.
COPIED_TOGETHER_NS = 2_000_000_000
_FRAME = re.compile(r'^ *File "(.+)", line (\d+)', re.MULTILINE)
_DETAIL_LINES = 14


def _inputs(script: Path) -> list[Path]:
    """The script, and robot.toml, models and diagrams beside it where the script reads them."""
    robot, text = script.with_name(ROBOT_FILE), script.read_text("utf-8", errors="replace")
    inputs = [script, robot] if "read_robot" in text and robot.is_file() else [script]
    if "import_simulink" in text:
        inputs += sorted(script.parent.glob("models/*.slx"))
    if "load_diagram" in text:
        inputs += sorted(script.parent.glob("diagrams/*.toml"))
    return inputs


def _digest(script: Path) -> str:
    return "".join(file_digest(file) for file in _inputs(script))


def _made(workspace: Workspace) -> dict[str, str]:
    """The controller in generated/: the digest of each file by its name."""
    folder = workspace.project / "generated"
    files = (file for pattern in ("*.[ch]", "*.ad[bs]") for file in folder.glob(pattern))
    return {file.name: file_digest(file) for file in sorted(files)}


def design_is_due(workspace: Workspace, settings: Settings) -> bool:
    """Whether the controller in generated/ is one of design.py, but not of what that reads now.

    The record holds contents, so that it is also right where projects of one name share it.
    """
    script, folder = workspace.project / DESIGN_SCRIPT, workspace.project / "generated"
    if not script.is_file() or settings.generated != folder or read_origin(folder) is not None:
        return False
    made = _made(workspace)
    if not made:
        return True
    if workspace.design_record.is_file():
        try:
            record = json_values(workspace.design_record.read_text("utf-8"))
        except (OSError, ValueError):
            return True
        return bool(record != {"script": _digest(script), "made": made})
    newest = max((folder / name).stat().st_mtime_ns for name in made)
    changed = max(file.stat().st_mtime_ns for file in _inputs(script))
    if changed > newest + COPIED_TOGETHER_NS:
        return True
    adopt_design(workspace)
    return False


def remember_design(workspace: Workspace, digest: str, made: dict[str, str]) -> None:
    """Record that the controller in generated/, its digests `made`, is of the inputs with this
    digest."""
    record = {"script": digest, "made": made}
    with suppress(OSError):
        atomic_write(workspace.design_record, json.dumps(record) + "\n")


def adopt_design(workspace: Workspace) -> None:
    """Record that the controller of a project just copied is of its design.py: the times of files
    would not tell a change in the next two seconds. Figures of a design here are of another one."""
    script = workspace.project / DESIGN_SCRIPT
    if script.is_file():
        remember_design(workspace, _digest(script), _made(workspace))
        with suppress(OSError):
            workspace.design_file.unlink()


def run_design(workspace: Workspace) -> None:
    """Run design.py, which writes generated/ and the design's figures; raises `DesignError`."""
    script = workspace.project / DESIGN_SCRIPT
    if not script.is_file():
        raise DesignError(f"{shown_path(script)}: there is no design script; write one")
    folder = workspace.project / "generated"
    origin = read_origin(folder)
    if origin is not None:
        raise DesignError(
            f"{shown_path(script)}: would overwrite the controller in generated/, which is "
            f"{origin.sentence}; remove {shown_path(origin.file)} to have design.py write it"
        )
    digest, before = _digest(script), _made(workspace)
    times = {name: (folder / name).stat().st_mtime_ns for name in before}
    workspace.design_file.parent.mkdir(parents=True, exist_ok=True)
    words = [DESIGN_SCRIPT, "--results", str(workspace.design_file)]
    done = run_script(words, workspace.project)
    if done.returncode != 0:
        raise _failure(script, done.stdout)
    made = _made(workspace)
    unchanged = [name for name in before if made.get(name) == before[name]]
    # gprbuild goes by times. One file at least keeps its own: that the design was run.
    if len(unchanged) < len(made):
        for name in unchanged:
            os.utime(folder / name, ns=(times[name], times[name]))
    remember_design(workspace, digest, made)


def _failure(script: Path, output: str) -> DesignError:
    """The exception, and the last line of the project's own Python on the way to it."""
    lines = output.strip().splitlines() or ["it printed nothing"]
    place = shown_path(script)
    for file, number in _FRAME.findall(output):
        path = script.parent / file
        if path.is_relative_to(script.parent) and path.is_file():
            place = f"{shown_path(path)}:{number}"
    return DesignError(
        f"{place}: {lines[-1].strip()}; correct the design and run it again",
        detail="\n".join(lines[-_DETAIL_LINES:-1]),
    )
