# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Submissions for the first lab, good and bad, made from the example."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from verification.support.paths import ROOT

BLANK = ROOT / "examples" / "blank"
RUBRIC = ROOT / "docs" / "lessons" / "rubrics" / "lab-01.toml"
SOLUTION = ROOT / "docs" / "teaching" / "01-tasks.md"


def _solved(sources: dict[str, str]) -> dict[str, str]:
    """The first lab's solution: the template with the changes of the lecturer's page."""
    text = SOLUTION.read_text()
    changes = re.search(r"^for old, new in (\(\n.*?^\)):$", text, re.MULTILINE | re.DOTALL)
    assert changes is not None
    tasks = sources["tasks.adb"]
    for old, new in ast.literal_eval(changes[1]):
        assert old in tasks
        tasks = tasks.replace(old, new)
    return {**sources, "tasks.adb": tasks}


SOURCES = _solved({file.name: file.read_text() for file in (BLANK / "src").iterdir()})


def write_submission(folder: Path, tasks: str | None = None, **others: str) -> Path:
    """A folder with the example's sources, but this body of the tasks and these other files."""
    (folder / "src").mkdir(parents=True)
    for name, text in (SOURCES | others).items():
        (folder / "src" / name).write_text(text)
    if tasks is not None:
        (folder / "src" / "tasks.adb").write_text(tasks)
    return folder


def variant(number: int) -> str:
    """A body of the tasks with a duty cycle of its own, between too slow and good."""
    duty = 20 + number % 60
    comment = f"   --  Submission {number}\n"
    text = SOURCES["tasks.adb"].replace("then 50 else", f"then {duty} else")
    return re.sub(r"^package body Tasks is\n", rf"\g<0>\n{comment}", text, flags=re.M)
