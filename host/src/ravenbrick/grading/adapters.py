# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Results in the forms that course platforms read."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

__all__ = ["ADAPTERS", "canvas", "github_actions", "gradescope", "moodle", "nbgrader", "readable"]

Result = dict[str, Any]

# Columns of nbgrader's CSV exporter, in its order.
NBGRADER = (
    "assignment",
    "duedate",
    "timestamp",
    "student_id",
    "last_name",
    "first_name",
    "email",
    "raw_score",
    "late_submission_penalty",
    "score",
    "max_score",
)
# Columns of a Canvas grade book before the assignments, in its order.
CANVAS = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")
# CommonMark 2.4: a backslash before them takes away what they mean.
MARKUP = re.compile(r"[\\<\[]")
FORMULA = ("=", "+", "-", "@", "\t", "\r")


def _told(row: Result) -> str:
    return "(hidden check)" if row["hidden"] and row["points"] < row["of"] else str(row["found"])


def readable(results: list[Result]) -> str:
    """Markdown: a table of one submission, or of many."""
    lines: list[str] = []
    for result in results:
        total = f"{result['points']:g} of {result['of']:g}"
        lines += [f"## {_cell(result['submission'])}: {total}", ""]
        lines += [f"Isolation: {result['isolation']}", ""]
        lines += ["| Check | Points | Found |", "|---|---|---|"]
        for row in result["checks"]:
            name, found = _cell(row["name"]), _cell(_told(row))
            lines.append(f"| {name} | {row['points']:g} of {row['of']:g} | {found} |")
        lines.append("")
    return "\n".join(lines)


def _cell(text: str) -> str:
    """Text in which no reader of Markdown finds a tag, a link or a picture."""
    return "<br>".join(MARKUP.sub(r"\\\g<0>", text.replace("|", "/")).splitlines())


def gradescope(results: list[Result]) -> str:
    """`results.json` of an autograder; one submission (Gradescope's autograder specification)."""
    (result,) = results
    tests = [
        {
            "name": row["name"],
            "score": row["points"],
            "max_score": row["of"],
            "status": "passed" if row["points"] >= row["of"] else "failed",
            "output": _told(row),
            "visibility": "after_due_date" if row["hidden"] else "visible",
        }
        for row in result["checks"]
    ]
    report = {"score": result["points"], "output": f"Isolation: {result['isolation']}"}
    return json.dumps({**report, "tests": tests}, indent=1) + "\n"


def _cell_text(text: str) -> str:
    """Text that no spreadsheet takes for a formula (OWASP, "CSV Injection")."""
    return f"'{text}" if text.startswith(FORMULA) else text


def _table(heads: Sequence[str], rows: Iterable[Mapping[str, str]]) -> str:
    """CSV by RFC 4180, but lines end as on Unix; what a row does not have is empty."""
    text = io.StringIO()
    writer = csv.DictWriter(text, heads, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: _cell_text(value) for name, value in row.items()} for row in rows)
    return text.getvalue()


def nbgrader(results: list[Result]) -> str:
    """CSV as nbgrader exports its grade book; what a grader does not know is empty.

    nbgrader documentation, "Export plugin": columns and numbers are those of its CsvExportPlugin.
    """
    return _table(
        NBGRADER,
        (
            {
                "assignment": result["rubric"],
                "student_id": result["submission"],
                "raw_score": str(float(result["points"])),
                "late_submission_penalty": "0.0",
                "score": str(float(result["points"])),
                "max_score": str(float(result["of"])),
            }
            for result in results
        ),
    )


def moodle(results: list[Result]) -> str:
    """CSV for "Grades > Import > CSV file" of Moodle.

    MoodleDocs 4.5, "Grade import": a head, one line for each user, one column that identifies the
    user and is mapped to "ID number", "Username" or "Email address", columns of grades; grade and
    feedback of an item are imported together, since an import without one of them deletes it.
    """
    if not results:
        return ""
    grade = results[0]["rubric"]
    feedback = f"{grade} (feedback)"
    return _table(
        ("ID number", grade, feedback),
        (
            {
                "ID number": result["submission"],
                grade: f"{result['points']:g}",
                feedback: "; ".join(
                    f"{row['name']}: {row['points']:g} of {row['of']:g}" for row in result["checks"]
                ),
            }
            for result in results
        ),
    )


def canvas(results: list[Result]) -> str:
    """CSV for "Grades > Import" of Canvas.

    The importer of Canvas (`lib/gradebook_importer.rb` of its source) reads the columns of an
    export up to Section, then the assignments; a row "Points Possible" comes before the students.
    Canvas finds a student by ID, SIS User ID, SIS Login ID or name, the first that is given.
    """
    if not results:
        return ""
    grade = results[0]["rubric"]
    possible = {"Student": "    Points Possible", grade: f"{results[0]['of']:g}"}
    students = (
        {
            "Student": result["submission"],
            "SIS Login ID": result["submission"],
            grade: f"{result['points']:g}",
        }
        for result in results
    )
    return _table((*CANVAS, grade), (possible, *students))


def github_actions(results: list[Result]) -> str:
    """Workflow commands: an annotation per lost check, then a notice with the points."""
    lines = []
    for result in results:
        for row in result["checks"]:
            if row["points"] < row["of"]:
                lines.append(f"::error title={_escaped(row['name'], True)}::{_escaped(_told(row))}")
        total = f"{result['submission']}: {result['points']:g} of {result['of']:g} points"
        total += f" (isolation: {result['isolation']})"
        lines.append(f"::notice title=Points::{_escaped(total)}")
    return "\n".join(lines) + "\n"


def _escaped(text: str, in_property: bool = False) -> str:
    """As the workflow commands of GitHub Actions want it."""
    escaped = text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
    return escaped.replace(":", "%3A").replace(",", "%2C") if in_property else escaped


ADAPTERS = {
    "text": readable,
    "gradescope": gradescope,
    "nbgrader": nbgrader,
    "moodle": moodle,
    "canvas": canvas,
    "github": github_actions,
}
