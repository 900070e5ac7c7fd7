# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick class`: folders with each student's own numbers."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

from typer.testing import CliRunner
from verification.support.projects import VEHICLE

from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode

RUBRICS = VEHICLE.parents[1] / "docs" / "lessons" / "rubrics"
RUBRIC = RUBRICS / "lab-04.toml"


def make(folder: Path, *words: object, rubric: Path = RUBRIC) -> tuple[int, dict[str, Any]]:
    """Exit code and JSON answer."""
    line = ["class", folder / "out", "--rubric", rubric, "--class-key", folder / "key", *words]
    result = CliRunner().invoke(app, [str(word) for word in [*line, "--json"]])
    return result.exit_code, json.loads(result.stdout)


def truths(folder: Path, key: Path, student: str) -> dict[str, str]:
    """The true values of a student in a new class folder."""
    folder.mkdir()
    (folder / "key").write_bytes(key.read_bytes())
    assert make(folder, "--student", student, "--truths", folder / "t.csv")[0] == ExitCode.OK
    (row,) = csv.DictReader((folder / "t.csv").read_text().splitlines())
    return row


def test_each_student_has_own_numbers_that_the_key_gives_again(tmp_path: Path) -> None:
    students = tmp_path / "ids.csv"
    students.write_text("id\nanna\nbert\n")
    code, answer = make(
        tmp_path, "--new-key", "--students", students, "--truths", tmp_path / "truths.csv"
    )
    assert code == ExitCode.OK
    robots = [Path(answer["folders"][name], "robot.toml").read_text() for name in ("anna", "bert")]
    assert robots[0] != robots[1]
    rows = list(csv.DictReader((tmp_path / "truths.csv").read_text().splitlines()))
    assert [row["id"] for row in rows] == ["anna", "bert"]
    assert (tmp_path / "truths.csv").stat().st_mode & 0o077 == 0
    assert truths(tmp_path / "again", tmp_path / "key", "bert") == rows[1]


def test_an_existing_folder_is_kept(tmp_path: Path) -> None:
    assert make(tmp_path, "--new-key", "--student", "anna")[0] == ExitCode.OK
    code, answer = make(tmp_path, "--student", "bert", "--student", "anna")
    assert code != ExitCode.OK and "exists already; nothing was changed" in answer["error"]
    assert not (tmp_path / "out" / "bert").exists()


def test_an_id_that_is_a_path_is_refused(tmp_path: Path) -> None:
    code, answer = make(tmp_path, "--new-key", "--student", "../anna")
    assert code != ExitCode.OK and "../anna" in answer["error"]
    assert not (tmp_path / "anna").exists()


def test_a_sheet_without_own_numbers_is_refused(tmp_path: Path) -> None:
    code, answer = make(tmp_path, "--new-key", "--student", "anna", rubric=RUBRICS / "lab-01.toml")
    assert code != ExitCode.OK and "[individual]" in answer["error"]
