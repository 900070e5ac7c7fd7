# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The work on one submission: build, run, judge. The result is a function of the sources."""

from __future__ import annotations

import functools
import hashlib
import json
import pickle
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.errors import UsageError, printable
from ravenbrick.grading.answers import ANSWERS_FILE, Answers, parse_wanted, read_answers
from ravenbrick.grading.build import build_image, design_files, python_parts
from ravenbrick.grading.isolation import Bounds, Isolation, isolation_named
from ravenbrick.grading.rubric import Check, Rubric, check_row, read_rubric
from ravenbrick.grading.sandbox import run_isolated
from ravenbrick.grading.submission import DESIGN, Submission, SubmissionError, read_files
from ravenbrick.project.scenario import read_scenario
from ravenbrick.project.workspace import tree

__all__ = ["Job", "failed_result", "grade_one"]

SAID = 400


@dataclass(frozen=True)
class Job:
    """What a worker needs, as plain values: it may run in another process or on another machine."""

    rubric: str
    rubric_digest: str
    submission: str
    path: str
    cache: str
    isolation: str
    secret: str
    design: bool = False
    class_key: str = ""


@functools.lru_cache(maxsize=4)
def _rubric(path: str, digest: str) -> Rubric:
    """The rubric, read once by each worker for each of its states."""
    rubric = read_rubric(Path(path))
    if rubric.digest != digest:
        raise UsageError(f"'{path}' is another rubric on this worker; give it the same files")
    return rubric


def _failed(rubric: Rubric, reason: str) -> list[dict[str, Any]]:
    return [check_row(check, 0.0, reason) for check in rubric.checks]


def grade_one(job: Job) -> dict[str, Any]:
    """Grade one submission; what is wrong with it is in the result, never an error.

    A `defect` in the result is a failure of the grader itself.
    """
    rubric = _rubric(job.rubric, job.rubric_digest)
    try:
        return _graded(job, rubric)
    except Exception as error:
        # One submission must not take the marks of the others with it.
        return failed_result(job, rubric, f"{type(error).__name__}: {error}")


def failed_result(job: Job, rubric: Rubric, defect: str) -> dict[str, Any]:
    """The result of a submission on which the grader itself failed."""
    return _result(job, rubric, "", _failed(rubric, "could not be judged"), defect)


def _graded(job: Job, rubric: Rubric) -> dict[str, Any]:
    isolation = isolation_named(job.isolation)
    if job.class_key:
        rubric = rubric.of(rubric.variant(bytes.fromhex(job.class_key), job.submission))
    submission = Submission(job.submission, Path(job.path))
    try:
        files = read_files(submission, rubric.folders, rubric.needs_image)
    except SubmissionError as error:
        return _result(job, rubric, "", _failed(rubric, f"the submission {error}"))
    answers = read_answers(files.pop(ANSWERS_FILE, None))
    if not job.design:
        files.pop(DESIGN, None)
    digests = {name: hashlib.sha256(text).hexdigest() for name, text in sorted(files.items())}
    key = hashlib.sha256(json.dumps([_asked(rubric), repr(answers), digests]).encode()).hexdigest()
    rows, defect = _failed(rubric, ""), ""
    if rubric.needs_image:
        try:
            sources = design_files(isolation, rubric, files)
            image = build_image(isolation, rubric, sources, Path(job.cache))
            rows, defect = _judged(isolation, rubric, job.secret, image)
        except SubmissionError as error:
            rows = _failed(rubric, str(error))
    rows = [
        _answer_row(check, answers) if check.kind == "answer" else row
        for check, row in zip(rubric.checks, rows, strict=True)
    ]
    if job.class_key:
        rows += _limited(rubric, rows)
    return _result(job, rubric, key, rows, defect)


def _limited(rubric: Rubric, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """A row that takes points away where an answer with own numbers does not hold."""
    assert rubric.individual is not None
    most = round(rubric.individual.share_without_own_answers * rubric.points, 4)
    points = sum(row["points"] for row in rows)
    missed = [
        check.name for check, row in zip(rubric.checks, rows, strict=True)
        if check.own and check.kind == "answer" and row["points"] < row["of"]
    ]  # fmt: skip
    if not missed or points <= most:
        return []
    found = f"'{missed[0]}' does not hold for the author's own numbers: at most {most:g} points"
    row = {"name": "own numbers", "points": round(most - points, 4), "of": 0, "hidden": False}
    return [{**row, "found": found}]


def _asked(rubric: Rubric) -> list[Any]:
    """What the result depends on besides the submission."""
    if rubric.robot_text is None:
        return [rubric.digest]
    return [rubric.digest, rubric.robot_text.decode(), [repr(c.value) for c in rubric.checks]]


def _answer_row(check: Check, answers: Answers) -> dict[str, Any]:
    met, found = parse_wanted(check.value).judge(answers)
    return check_row(check, float(met), found)


def _judged(
    isolation: Isolation, rubric: Rubric, secret: str, image: Path
) -> tuple[list[dict[str, Any]], str]:
    """Run and judge in the sandbox: rows, and what was not the submission's fault.

    The image is the submission's code, but what reads it is ours. The judge gets all that it needs
    by its input, so neither rubric nor solutions are files of the sandbox.
    """
    limits = rubric.limits
    paths = {check.scenario for check in rubric.checks if check.scenario}
    scenarios = {path: read_scenario(path, rubric.robot) for path in paths}
    outcome = run_isolated(
        isolation,
        [sys.executable, "-m", "ravenbrick.grading.judge"],
        Bounds(limits.run_seconds, limits.memory_mb, limits.file_mb),
        content=pickle.dumps((rubric, secret, scenarios, image.read_bytes())),
        readable=[*python_parts(), rubric.project],
        hidden=[tree()],
        variables={"PYTHONDONTWRITEBYTECODE": "1"},
    )
    if outcome.code == 0:
        rows: list[dict[str, Any]] = json.loads(outcome.result)
        return rows, ""
    if outcome.timed_out:
        reason = f"the runs took more than {limits.run_seconds} s of processor time"
        return _failed(rubric, reason), ""
    reason = f"the judge ended with {outcome.code}: {outcome.output.strip()[-SAID:]}"
    return _failed(rubric, "could not be judged"), reason


def _result(
    job: Job, rubric: Rubric, key: str, rows: list[dict[str, Any]], defect: str = ""
) -> dict[str, Any]:
    rows = [{**row, "found": printable(row["found"])} for row in rows]
    result = {
        "submission": job.submission,
        "rubric": rubric.name,
        "isolation": job.isolation,
        "digest": key,
        "points": round(sum(row["points"] for row in rows), 4),
        "of": rubric.points,
        "checks": rows,
    }
    return {**result, "defect": defect} if defect else result
