# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reports by what the platforms publish about the files that they read."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from verification.support.paths import ROOT

from ravenbrick.grading.adapters import (
    ADAPTERS,
    canvas,
    github_actions,
    gradescope,
    moodle,
    nbgrader,
    readable,
)

# A name with everything that has a meaning in one of the formats.
NASTY = 'speed: slow, 50% | "fast"\r\n::error::x'
RESULT: dict[str, Any] = {
    "submission": 'Lovelace, "Ada"',
    "rubric": "lab-01",
    "isolation": "bubblewrap 0.8.0",
    "points": 2.5,
    "of": 6.0,
    "checks": [
        {"name": "speed", "points": 2.0, "of": 2.0, "hidden": False, "found": "8 rad/s"},
        {"name": NASTY, "points": 0.5, "of": 1.0, "hidden": False, "found": NASTY},
        {"name": "secret", "points": 0.0, "of": 3.0, "hidden": True, "found": "7 rad/s"},
    ],
}

TEXT, NUMBER = {"type": "string"}, {"type": "number"}
VISIBILITY = {"enum": ["hidden", "after_due_date", "after_published", "visible"]}
FORM = {"enum": ["text", "html", "simple_format", "md", "ansi"]}
# gradescope-autograders.readthedocs.io, "Autograder Specifications", output format: all fields that
# results.json may have.
GRADESCOPE = {
    "type": "object",
    "additionalProperties": False,
    "required": ["tests"],
    "properties": {
        "score": NUMBER,
        "execution_time": NUMBER,
        "output": TEXT,
        "output_format": FORM,
        "test_output_format": FORM,
        "test_name_format": FORM,
        "visibility": VISIBILITY,
        "stdout_visibility": VISIBILITY,
        "extra_data": {"type": "object"},
        "leaderboard": {"type": "array"},
        "tests": {
            "type": "array",
            "items": {
                "type": "object",
                "additionalProperties": False,
                "properties": {
                    "score": NUMBER,
                    "max_score": NUMBER,
                    "status": {"enum": ["passed", "failed"]},
                    "name": TEXT,
                    "name_format": FORM,
                    "number": TEXT,
                    "output": TEXT,
                    "output_format": FORM,
                    "tags": {"type": "array", "items": TEXT},
                    "visibility": VISIBILITY,
                    "extra_data": {"type": "object"},
                },
            },
        },
    },
}
# nbgrader 0.9.6, nbgrader/plugins/export.py: the columns of its grade book as CSV, in order.
NBGRADER = (
    "assignment,duedate,timestamp,student_id,last_name,first_name,email,raw_score,"
    "late_submission_penalty,score,max_score"
)


def test_gradescope_gets_its_results_file() -> None:
    """Only published fields; the points of the tests are those of the whole."""
    answer = json.loads(gradescope([RESULT]))
    judge = jsonschema.Draft202012Validator(GRADESCOPE)
    assert [error.message for error in judge.iter_errors(answer)] == []
    assert not judge.is_valid({"tests": [{**answer["tests"][0], "visibility": "later"}]})
    assert answer["score"] == sum(test["score"] for test in answer["tests"]) == 2.5
    assert [test["max_score"] for test in answer["tests"]] == [2.0, 1.0, 3.0]
    assert [test["status"] for test in answer["tests"]] == ["passed", "failed", "failed"]
    hidden = answer["tests"][2]
    assert hidden["visibility"] == "after_due_date" and "7 rad/s" not in hidden["output"]


def test_nbgrader_gets_its_columns() -> None:
    """All of them in their order; what is not known is empty, the score is as nbgrader counts."""
    text = nbgrader([RESULT])
    assert text.splitlines()[0] == NBGRADER
    (row,) = csv.DictReader(io.StringIO(text))
    assert None not in row and None not in row.values()
    assert (row["assignment"], row["student_id"]) == ("lab-01", 'Lovelace, "Ada"')
    penalty = float(row["late_submission_penalty"])
    assert float(row["score"]) == max(0.0, float(row["raw_score"]) - penalty) == 2.5
    assert float(row["max_score"]) == 6.0


def test_nbgrader_itself_exports_what_was_entered_by_the_guides_program(tmp_path: Path) -> None:
    """Entered twice; the export is the same file, byte for byte."""
    program_file = Path(sys.executable).with_name("nbgrader")
    if not program_file.is_file():
        pytest.skip("nbgrader is not installed beside this Python")
    text = (ROOT / "docs" / "guides" / "grading.md").read_text("utf-8")
    (program,) = (p for p in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S) if "nbg" in p)
    others = [{**RESULT, "submission": name, "points": 6.0} for name in ("s01", "s02")]
    entered = nbgrader([{**RESULT, "submission": "s00"}, *others])
    (tmp_path / "grades.csv").write_text(entered)
    (tmp_path / "enter.py").write_text(program)
    path = f"{program_file.parent}{os.pathsep}{os.environ['PATH']}"
    for command in (
        [sys.executable, "enter.py"],
        [sys.executable, "enter.py"],
        [str(program_file), "export", "--to", "out.csv"],
    ):
        subprocess.run(command, cwd=tmp_path, check=True, env={**os.environ, "PATH": path})
    assert (tmp_path / "out.csv").read_text() == entered


def workflow_command(line: str) -> tuple[str, dict[str, str], str]:
    """Name, properties and message as the runner reads them (GitHub Docs, "Workflow commands").

    Between the first and the second pair of colons stand the name and, after a blank, properties
    parted by commas; the percent codes of line ends, colon and comma are read back last `%25`.
    """
    found = re.fullmatch(r"::(\w[\w-]*)(?: (.*?))?::(.*)", line)
    assert found is not None, line
    name, pairs, message = found.groups()

    def read_back(text: str, *codes: tuple[str, str]) -> str:
        for code, letter in (*codes, ("%0D", "\r"), ("%0A", "\n"), ("%25", "%")):
            text = text.replace(code, letter)
        return text

    properties = {}
    for pair in pairs.split(",") if pairs else ():
        key, equals, value = pair.partition("=")
        assert equals, pair
        properties[key] = read_back(value, ("%3A", ":"), ("%2C", ","))
    return name, properties, read_back(message)


def test_github_reads_back_what_was_found() -> None:
    """One command a line, whatever is in the names; hidden findings stay hidden."""
    lines = github_actions([RESULT]).splitlines()
    commands = [workflow_command(line) for line in lines]
    assert commands[0] == ("error", {"title": NASTY}, NASTY)
    assert commands[1] == ("error", {"title": "secret"}, "(hidden check)")
    assert commands[2][0] == "notice"
    assert commands[2][2].endswith("2.5 of 6 points (isolation: bubblewrap 0.8.0)")
    assert len(commands) == 3
    with pytest.raises(AssertionError):
        workflow_command(f"::error title={NASTY}::x".splitlines()[0])


def test_the_text_is_one_row_a_check() -> None:
    """A bar or a line end in a name does not break the table."""
    rows = [line for line in readable([RESULT]).splitlines() if line.startswith("|")][2:]
    assert len(rows) == 3
    assert all(len(re.findall(r"(?<!\\)\|", row)) == 4 for row in rows)
    assert "7 rad/s" not in rows[2]


def test_no_tag_link_or_picture_of_a_submission_gets_into_the_text() -> None:
    """As CommonMark takes it: after a backslash, which itself has none before it."""
    text = "<script>\\\\<img src=x> ![a](//b) [c]: //d <//e>"
    for result in (RESULT | {"submission": text}, *with_found(text)):
        shown = readable([result]).replace("<br>", "")
        assert "script" in shown
        assert not re.search(r"(?<!\\)(?:\\\\)*[<\[]", shown)


def with_found(text: str) -> list[dict[str, Any]]:
    """The result with a row whose name, or finding, is a text."""
    row = RESULT["checks"][0]
    return [RESULT | {"checks": [row | {key: text}]} for key in ("name", "found")]


def test_moodle_gets_an_id_a_grade_and_its_feedback_in_each_line() -> None:
    """MoodleDocs, "Grade import": grade and feedback of an item are imported together."""
    (row,) = csv.DictReader(io.StringIO(moodle([RESULT])))
    assert row["ID number"] == RESULT["submission"] and row["lab-01"] == "2.5"
    assert "secret: 0 of 3" in row["lab-01 (feedback)"] and "7 rad/s" not in str(row)


def test_canvas_gets_the_columns_of_an_export_and_the_points_possible() -> None:
    """Student and ID come first, SIS Login ID fourth, Section before the grade."""
    head, possible, student = csv.reader(io.StringIO(canvas([RESULT])))
    assert head == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "lab-01"]
    assert possible[0].strip() == "Points Possible" and possible[5] == "6"
    assert student[3] == RESULT["submission"] and student[5] == "2.5"


@pytest.mark.parametrize("form", ["moodle", "canvas", "nbgrader"])
@pytest.mark.parametrize("name", ["=cmd|' /C calc'!A0", "+1", "-1", "@SUM(A1)", "\t=1"])
def test_no_cell_of_a_grade_book_is_a_formula(form: str, name: str) -> None:
    """A spreadsheet executes what begins with = + - @; such text is marked as text."""
    for row in csv.reader(io.StringIO(ADAPTERS[form]([{**RESULT, "submission": name}]))):
        assert not any(cell.startswith(("=", "+", "-", "@", "\t", "\r")) for cell in row)
