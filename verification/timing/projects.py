# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs that others wrote, analysed without a word about their timing.

RAVENBRICK_PROJECTS names a folder of projects, each with a robot.toml and without a timing.toml.
A copy of each is built; `ravenbrick analyse` bounds it and compares the bounds with a run. A
project that it asks a fact of is left out, with the question.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from ravenbrick.errors import ExitCode

from verification.built_examples import ravenbrick
from verification.commands import Counts, NoResultError, NotRunError

__all__ = ["suite"]

VARIABLE = "RAVENBRICK_PROJECTS"
# A run above a bound has the exit code of a missing bound.
ABOVE = "above its bound of"
ANSWERS = (ExitCode.OK, ExitCode.DEADLINE_CAN_BE_MISSED, ExitCode.NO_TIMING_BOUND)


def _projects() -> list[Path]:
    folder = os.environ.get(VARIABLE)
    projects = sorted(found.parent for found in Path(folder).glob("*/robot.toml")) if folder else []
    if not projects:
        raise NotRunError(f"let {VARIABLE} name a folder of projects")
    for project in projects:
        if (project / "timing.toml").exists():
            raise NotRunError(f"{project / 'timing.toml'}: take it away; the suite gives no facts")
    return projects


def _analysed(project: Path) -> dict[str, Any]:
    """The answer of `ravenbrick analyse` on a copy, built with the drivers of this tree."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / project.name
        shutil.copytree(project, copy, ignore=shutil.ignore_patterns("build", "out"))
        ravenbrick("build", str(copy))
        answer = ravenbrick("analyse", str(copy), accepted=ANSWERS)
        answer["error"] = str(answer.get("error", "")).replace(f"{copy}/", "")
        return answer


def suite() -> Counts:
    """Projects with a verdict, schedulable or not, whose run stays below all bounds."""
    projects, passed, excluded, failures = _projects(), 0, [], []
    for project in projects:
        print(project.name, file=sys.stderr, flush=True)
        try:
            answer = _analysed(project)
        except NoResultError as error:
            failures.append(f"{project.name}: {error}")
            continue
        if answer.get("exit_code") != ExitCode.NO_TIMING_BOUND:
            passed += 1
        elif ABOVE in answer["error"]:
            failures.append(f"{project.name}: {answer['error']}")
        else:
            excluded.append({"count": 1, "reason": f"{project.name}: {answer['error']}"})
    return Counts(len(projects), passed, excluded, failures)
