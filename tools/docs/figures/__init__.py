# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the lab sheets: each public function of `sheet_NN.py` gives an SVG.

`write_figures` writes them, and skips a sheet whose module and inputs are as they were. Curves
come from the design code, from the schedule's analysis and from runs on the virtual brick.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
import io
import os
import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.pipeline import read_run, run_scenario
from ravenbrick.errors import RunFaultError
from ravenbrick.image.build import build_image, manifest_file
from ravenbrick.image.design_script import adopt_design
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.templates import create_project
from ravenbrick.project.workspace import Workspace
from ravenbrick.report.chart import COLOURS, SERIES
from ravenbrick.report.plots.style import legend, new_figure
from ravenbrick.trace.recording import Recording

__all__ = ["COLOURS", "SERIES", "legend", "new_figure", "picture", "project", "run"]

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
PICTURES = ROOT / "docs" / "pictures" / "generated"
# Outside the tree, where a project has its own folders for what is built and recorded.
KEPT = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ravenbrick" / "figures"
# Of every figure: the package, the programs, the emulator, and this module.
COMMON: tuple[str, ...] = ("host/src/ravenbrick", "catalogue", "runtime", "drivers/src", "examples")
COMMON += ("virtual-brick/bindings/python", "tools/docs/figures/__init__.py")
COMMON += ("tools/docs/figures/three_tasks.py",)
READ = {".py", ".ads", ".adb", ".S", ".gpr", ".toml", ".json", ".so", ".h", ".c", ".png"}
Edits = Mapping[str, str | Sequence[tuple[str, str]]]


def picture(figure: Any) -> str:
    """A figure of matplotlib as SVG with a white ground, the same text each time."""
    import matplotlib

    buffer = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": "ravenbrick"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def _files(place: Path) -> Iterator[Path]:
    if place.is_file():
        yield place
    for path in sorted(place.rglob("*")):
        if path.suffix in READ and path.is_file() and not {"build", "out"} & set(path.parts):
            yield path


@cache
def _common() -> str:
    digest = hashlib.sha256()
    for place in COMMON:
        for file in _files(ROOT / place):
            digest.update(str(file.relative_to(ROOT)).encode() + file.read_bytes())
    return digest.hexdigest()


def _key(*parts: object) -> str:
    return hashlib.sha256(repr((_common(), *parts)).encode()).hexdigest()


def _edited(made: Path, changes: Edits) -> None:
    for name, change in changes.items():
        file = made / name
        text = change if isinstance(change, str) else file.read_text("utf-8")
        for old, new in () if isinstance(change, str) else change:
            if old not in text:
                raise ValueError(f"{name} of the template has no '{old}'")
            text = text.replace(old, new)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")


def project(template: str, edits: Edits | None = None) -> Path:
    """A project of `ravenbrick new` with changed files, designed and built.

    `edits`: for a file below the project its new text, or pairs of a text and its replacement.
    Raises `ValueError` when a text is not in the file.
    """
    changes = edits or {}
    folder = KEPT / _key(template, sorted(changes.items()))[:16] / "robot"
    if not folder.is_dir():
        made = folder.parent.with_name(f"{folder.parent.name}-{os.getpid()}")
        made.mkdir(parents=True)
        adopt_design(create_project(made / "robot", template))
        _edited(made / "robot", changes)
        try:
            made.rename(folder.parent)
        except OSError:  # another process was first
            shutil.rmtree(made)
    workspace, robot = Workspace.of(folder), read_robot(folder)
    if not manifest_file(workspace.image("ram", robot.name)).is_file():
        build_image(workspace, robot, "ram")
    return folder


def run(template: str, scenario: str, edits: Edits | None = None) -> Recording:
    """A run of such a project on the virtual brick; criteria may fail, and programs may end."""
    folder = project(template, edits)
    workspace, robot = Workspace.of(folder), read_robot(folder)
    record = workspace.recording(scenario)
    if not record.is_file():
        chosen = read_scenario(scenario_path(folder, scenario), robot)
        image = read_image(workspace.image("ram", robot.name))
        recording = run_scenario(workspace, robot, chosen, image, VirtualTarget())
        with suppress(RunFaultError):
            read_run(robot, chosen, recording)
    return Recording.load(record)


def _figures(module: Any) -> dict[str, Callable[[], str]]:
    found = inspect.getmembers(module, inspect.isfunction)
    own = [(n, f) for n, f in found if f.__module__ == module.__name__ and n[0] != "_"]
    return {name.replace("_", "-"): function for name, function in own}


def write_sheet(number: str, folder: Path) -> None:
    """Write one sheet's figures, unless they are there for the same inputs."""
    source = HERE / f"sheet_{number}.py"
    key, mark = _key(source.read_text("utf-8")), folder / f".sheet-{number}"
    if mark.is_file() and mark.read_text("utf-8") == key:
        return
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob(f"sheet-{number}-*.svg"):
        old.unlink()
    module = importlib.import_module(f"tools.docs.figures.sheet_{number}")
    for name, function in _figures(module).items():
        (folder / f"sheet-{number}-{name}.svg").write_text(function(), encoding="utf-8")
    mark.write_text(key, encoding="utf-8")


def write_figures(folder: Path = PICTURES, wanted: Sequence[str] = ()) -> None:
    """Write the figures of these sheets, of all without numbers; the last ones take longest."""
    numbers = [re.sub(r"\D", "", path.stem) for path in sorted(HERE.glob("sheet_*.py"))]
    chosen = [number for number in numbers if not wanted or number in wanted]
    _common()  # once for all processes
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for done in [pool.submit(write_sheet, number, folder) for number in reversed(chosen)]:
            done.result()
