# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Results in the forms that course platforms read."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

__all__ = ["ADAPTERS", "github_actions", "gradescope", "nbgrader", "readable"]

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


def _told(row: Result) -> str:
    return "(hidden check)" if row["hidden"] and row["points"] < row["of"] else str(row["found"])


def readable(results: list[Result]) -> str:
    """Markdown: a table of one submission, or of many."""
    lines: list[str] = []
    for result in results:
        total = f"{result['points']:g} of {result['of']:g}"
        lines += [f"## {result['submission']}: {total}", ""]
        lines += [f"Isolation: {result['isolation']}", ""]
        lines += ["| Check | Points | Found |", "|---|---|---|"]
        for row in result["checks"]:
            name, found = _cell(row["name"]), _cell(_told(row))
            lines.append(f"| {name} | {row['points']:g} of {row['of']:g} | {found} |")
        lines.append("")
    return "\n".join(lines)


def _cell(text: str) -> str:
    return "<br>".join(text.replace("|", "/").splitlines())


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


def nbgrader(results: list[Result]) -> str:
    """CSV as nbgrader exports its grade book; what a grader does not know is empty."""
    text = io.StringIO()
    writer = csv.DictWriter(text, NBGRADER, restval="", lineterminator="\n")
    writer.writeheader()
    for result in results:
        points = f"{result['points']:g}"
        writer.writerow(
            {
                "assignment": result["rubric"],
                "student_id": result["submission"],
                "raw_score": points,
                "late_submission_penalty": "0",
                "score": points,
                "max_score": f"{result['of']:g}",
            }
        )
    return text.getvalue()


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
    "github": github_actions,
}
