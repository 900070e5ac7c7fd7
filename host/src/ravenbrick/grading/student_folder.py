# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Folders with an assignment of each student's own, and the list of a class."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from ravenbrick.atomic_write import atomic_write
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.grading.rubric import Rubric
from ravenbrick.grading.variants import Variant, own_motor, student_id
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import ROBOT_FILE, read_robot
from ravenbrick.project.scenario import read_scenario
from ravenbrick.project.templates import create_project, template_of
from ravenbrick.project.workspace import tree
from ravenbrick.trace.recording import Recording

__all__ = [
    "OWN_FILE",
    "check_id",
    "own_recording",
    "read_class",
    "recorded_scenarios",
    "sheet_template",
    "write_folder",
]

OWN_FILE = "own.toml"
RECORDS = "records"
# Signals that a brick itself can measure; the others would give the constants away.
_MEASURABLE = re.compile(r"motor\.\w\.(encoder|duty|voltage)|battery\.voltage|probe\..*|sensor\..*")
_ID = re.compile(r"[^\W_][\w.@+-]*\Z")


def check_id(name: str, where: str) -> None:
    """Raise `UsageError`, which begins with the place, for an id that is no plain folder name."""
    if not _ID.fullmatch(name):
        raise UsageError(
            f"{where}: '{name}': expected an id of letters, digits and . @ + - _, beginning with a "
            "letter or digit"
        )


def read_class(path: Path) -> list[str]:
    """Ids of a class: the column 'id' of a CSV file, or its first one; raises `UsageError`."""
    try:
        rows = list(csv.reader(path.read_text("utf-8-sig").splitlines()))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"{shown_path(path)}: cannot be read as CSV in UTF-8 ({error})") from None
    heads = [name.strip().lower() for name in rows[0]] if rows else []
    column, begin = (heads.index("id"), 1) if "id" in heads else (0, 0)
    found: dict[str, int] = {}
    ids = []
    for line, row in enumerate(rows[begin:], begin + 1):
        if not any(cell.strip() for cell in row):
            continue
        name = row[column].strip() if len(row) > column else ""
        check_id(name, f"{shown_path(path)}:{line}")
        if student_id(name) in found:
            raise UsageError(
                f"{shown_path(path)}:{line}: '{name}' is also in line {found[student_id(name)]}"
            )
        found[student_id(name)] = line
        ids.append(name)
    if not ids:
        raise UsageError(f"{shown_path(path)}: there is no student in it")
    return ids


def sheet_template(rubric: Rubric) -> str:
    """The template of `ravenbrick new` with the rubric's project; raises `UsageError`."""
    examples = (tree() / "examples").resolve()
    project = rubric.project
    name = template_of(project.name) if project.parent == examples else None
    if name is None:
        raise UsageError(f"'{shown_path(project)}' is not the project of a template")
    return name


def _handed_out(recording: Recording) -> Recording:
    """What a student could have measured on a brick of their own."""
    signals = {n: s for n, s in recording.signals.items() if _MEASURABLE.fullmatch(n)}
    return replace(recording, signals=signals, events=recording.events[:0], pictures=())


def _own_numbers(rubric: Rubric, student: str, variant: Variant) -> str:
    individual = rubric.individual
    assert individual is not None
    said = "robot.toml has the constants of your own robot."
    if individual.hidden:
        said = f"{RECORDS}/ was recorded with your own robot; robot.toml has typical constants."
    elif not (individual.motors or individual.battery or individual.sensors):
        said = "Use them in place of the numbers of the sheet."
    lines = [
        f"# Your own numbers for {rubric.name}. {said}",
        "",
        f"student = {json.dumps(student, ensure_ascii=False)}",
        f'sheet = "{rubric.name}"',
    ]
    if variant.numbers:
        lines += ["", "[numbers]"]
        lines += [f"{name} = {value:g}" for name, value in variant.numbers.items()]
    return "\n".join([*lines, ""])


def recorded_scenarios(rubric: Rubric) -> dict[Path, Path]:
    """The scenarios whose recordings are handed out, and the project of each."""
    names = rubric.individual.records if rubric.individual else ()
    found = {}
    for name in names:
        path = (rubric.path.parent / name).resolve()
        project = next((p for p in path.parents if (p / ROBOT_FILE).is_file()), None)
        if project is None:
            raise UsageError(f"{shown_path(path)}: is in no project; name a scenario of one")
        found[path] = project
    return found


def own_recording(variant: Variant, scenario: Path, image: ElfImage) -> Recording:
    """The scenario's project with the variant's motors in their ports, as a brick could see it."""
    robot = read_robot(next(p for p in scenario.parents if (p / ROBOT_FILE).is_file()))
    ports = dict(robot.motor_ports)
    for port in ports:
        if own_motor(port) in variant.robot.motors:
            ports[port] = replace(ports[port], motor=own_motor(port))
    motors = {**robot.motors, **variant.robot.motors}
    own = replace(robot, motors=motors, motor_ports=ports)
    return _handed_out(VirtualTarget().run(own, read_scenario(scenario, robot), image))


def write_folder(
    folder: Path,
    rubric: Rubric,
    key: bytes,
    student: str,
    images: Mapping[Path, ElfImage] = MappingProxyType({}),
) -> Variant:
    """The student's project of the sheet, new; `images` of the projects that are recorded.

    Raises `UsageError`, also when the folder is there already.
    """
    variant = rubric.variant(key, student)
    own, individual = rubric.of(variant), rubric.individual
    assert individual is not None and own.robot_text is not None
    folder.parent.mkdir(parents=True, exist_ok=True)
    create_project(folder, sheet_template(rubric))
    if not individual.hidden:
        # The template's file has the folder's name in it; the own constants go into that one.
        atomic_write(folder / ROBOT_FILE, _named(own.robot_text.decode(), folder.name))
    atomic_write(folder / OWN_FILE, _own_numbers(rubric, student, variant))
    for scenario, project in recorded_scenarios(rubric).items():
        recording = own_recording(variant, scenario, images[project])
        recording.save(folder / RECORDS / f"{scenario.stem}.npz")
    return variant


def _named(text: str, name: str) -> str:
    return re.sub(r'^name = ".*"$', f'name = "{name}"', text, count=1, flags=re.M)
