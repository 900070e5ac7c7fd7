# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick class`: an assignment of their own for each student of a class."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import project_image
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.grading.rubric import Rubric, read_rubric
from ravenbrick.grading.student_folder import (
    check_id,
    read_class,
    recorded_scenarios,
    sheet_template,
    write_folder,
)
from ravenbrick.grading.variants import new_key, read_key, student_id
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace

__all__ = ["class_command"]


def _truths(rubric: Rubric, key: bytes, students: list[str]) -> str:
    """CSV for the lecturer: every value that the rubric may refer to, by student."""
    rows = [{"id": s, **rubric.variant(key, s).facts} for s in students]
    text = io.StringIO()
    writer = csv.DictWriter(text, rows[0], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _students(listed: Path | None, single: list[str] | None) -> list[str]:
    for name in single or []:
        check_id(name, "--student")
    students = [*(read_class(listed) if listed else []), *(single or [])]
    if not students:
        raise UsageError("name students: --students FILE.csv, or --student ID")
    if len({student_id(student) for student in students}) < len(students):
        raise UsageError("a student is named twice; remove one")
    return students


@command("ravenbrick class handouts --rubric docs/lessons/rubrics/lab-04.toml --students ids.csv")
def class_command(
    output: Annotated[Path, typer.Argument(help="Folder for one folder for each student.")],
    rubric: Annotated[Path, typer.Option(help="Rubric with a table [individual].")],
    students: Annotated[
        Path | None, typer.Option(help="List of the class: CSV with a column 'id'.")
    ] = None,
    student: Annotated[
        list[str] | None, typer.Option(help="Id of a single student; repeatable.")
    ] = None,
    class_key: Annotated[Path, typer.Option(help="Class key, the lecturer's secret.")] = Path(
        "class.key"
    ),
    fresh: Annotated[bool, typer.Option("--new-key", help="New class key, written first.")] = False,
    truths: Annotated[
        Path | None, typer.Option(help="File for the true values of all students (CSV).")
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    chosen = read_rubric(rubric)
    named = _students(students, student)
    template = sheet_template(chosen)
    folders = {name: output / name / chosen.name for name in named}
    there = [folder for folder in folders.values() if folder.exists()]
    if there:
        raise UsageError(f"{shown_path(there[0])} exists already; nothing was changed")
    if chosen.individual is None:
        raise UsageError(f"the rubric '{chosen.name}' has no table [individual]")
    if fresh:
        new_key(class_key)
    key = read_key(class_key)
    reporter = Reporter(json_output)
    images = {
        project: project_image(Workspace.of(project), read_robot(project), "ram", reporter)
        for project in set(recorded_scenarios(chosen).values())
    }
    with reporter.step(f"make {len(named)} folders for '{chosen.name}'") as step:
        for done, (name, folder) in enumerate(folders.items(), 1):
            write_folder(folder, chosen, key, name, images)
            step.progress(done / len(named))
        step.note = f"template '{template}', in {shown_path(output)}"
    if truths:
        atomic_write(truths, _truths(chosen, key, named), mode=0o600)
        reporter.print(f"true values: {shown_path(truths)}")
    return {"rubric": chosen.name, "folders": {name: str(f) for name, f in folders.items()}}
