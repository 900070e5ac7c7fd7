# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The work on one submission: build, run, judge. The result is a function of the sources."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.errors import UsageError
from ravenbrick.grading.answers import ANSWERS_FILE, Answers, parse_wanted, read_answers
from ravenbrick.grading.rubric import Check, Rubric, read_rubric
from ravenbrick.grading.sandbox import Outcome, run_limited
from ravenbrick.grading.submission import Submission, read_sources, refusal
from ravenbrick.image.build import gprbuild_call
from ravenbrick.image.build_errors import errors_in
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.run_time import run_time_library

__all__ = ["Job", "build", "grade_one", "prepare_base"]

ELF = "image.elf"
MAP = "image.map"
# Sources that differ from the reference project's get an instant that none of those has, so that
# gprbuild, which compares instants, compiles just them and what depends on them.
CHANGED_S = 1_000_000_000


@dataclass(frozen=True)
class Job:
    """What a worker needs, as plain values: it may run in another process or on another machine."""

    rubric: str
    submission: str
    path: str
    cache: str
    design: bool = False


def _gprbuild(project: Path, build: Path, rubric: Rubric) -> Outcome:
    """Build in the sandbox; what the environment asks for is not for graders."""
    limits, settings = rubric.limits, Settings.of(rubric.robot, {})
    values = {"IMAGE": "ram", "PROJECT": "project", "ROBOT": rubric.robot.name}
    values |= {"RAVENBRICK_BUILD": str(build), "GENERATED": "generated"}
    build.mkdir(exist_ok=True)
    call, environment = gprbuild_call(settings, run_time_library(settings), values, build)
    return run_limited(
        ["gprbuild", "-q", *call, "-cargs:Ada", "-gnatef"],
        project,
        limits.build_seconds,
        limits.memory_mb,
        limits.file_mb,
        environment,
    )


def prepare_base(rubric: Rubric, cache: Path) -> Path:
    """Objects of the reference project and its drivers, built once; raises `UsageError`."""
    base = cache / "base" / rubric.digest[:24]
    if (base / "drivers").is_dir():
        return base
    with tempfile.TemporaryDirectory(dir=_made(cache)) as folder:
        project, build = Path(folder) / "project", Path(folder) / "build"
        _copy_reference(rubric, project)
        outcome = _gprbuild(project, build, rubric)
        if outcome.code != 0:
            raise UsageError(
                f"the reference project {rubric.project} does not build: "
                f"{outcome.output.strip()[-400:]}"
            )
        base.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.replace(build, base)
        except OSError:
            if not (base / "drivers").is_dir():
                raise
    return base


def _copy_reference(rubric: Rubric, project: Path) -> None:
    shutil.copytree(rubric.project, project, ignore=shutil.ignore_patterns("tests", "build"))


def _lay_out(
    rubric: Rubric, sources: dict[str, bytes], project: Path, build: Path, base: Path
) -> None:
    """The reference project with the submission's sources, and the objects that still fit."""
    _copy_reference(rubric, project)
    complete = True
    for folder in rubric.folders:
        for file in (project / folder).glob("*"):
            if file.name not in rubric.keep and f"{folder}/{file.name}" not in sources:
                file.unlink()
                complete = False
    for name, text in sources.items():
        file = project / name
        if file.name in rubric.keep or (file.is_file() and file.read_bytes() == text):
            continue
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(text)
        os.utime(file, (CHANGED_S, CHANGED_S))
    shutil.copytree(base / "drivers", build / "drivers")
    if complete:
        shutil.copytree(base / "project" / "objects", build / "project" / "objects")


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _design(project: Path, rubric: Rubric, submission: Submission) -> Outcome | None:
    """Run the submission's design.py in the sandbox; None when it has none."""
    script = submission.path / "design.py"
    if not script.is_file():
        return None
    shutil.copy(script, project / "design.py")
    limits = rubric.limits
    return run_limited(
        [sys.executable, "design.py"],
        project,
        limits.design_seconds,
        limits.memory_mb,
        limits.file_mb,
    )


def build(
    rubric: Rubric, submission: Submission, sources: dict[str, bytes], cache: Path, design: bool
) -> tuple[Path | None, str]:
    """The image's folder in the cache, or why there is none."""
    content = "".join(
        f"{name} {hashlib.sha256(text).hexdigest()}\n" for name, text in sorted(sources.items())
    )
    script = submission.path / "design.py"
    if design and script.is_file():
        content += f"design.py {hashlib.sha256(script.read_bytes()).hexdigest()}\n"
    key = hashlib.sha256(f"{rubric.digest}\n{content}".encode()).hexdigest()
    kept = cache / "images" / key
    if (kept / ELF).is_file():
        return kept, ""
    if (kept / "failure.txt").is_file():
        return None, (kept / "failure.txt").read_text("utf-8")
    base = prepare_base(rubric, cache)
    with tempfile.TemporaryDirectory(dir=cache) as folder:
        project, build = Path(folder) / "project", Path(folder) / "build"
        _lay_out(rubric, sources, project, build, base)
        if design:
            outcome = _design(project, rubric, submission)
            if outcome is not None and outcome.code != 0:
                return None, f"design.py failed: {outcome.output.strip()[-400:]}"
        outcome = _gprbuild(project, build, rubric)
        result = Path(tempfile.mkdtemp(prefix=".", dir=_made(cache / "images")))
        elf = build / "project" / "ram" / f"{rubric.robot.name}.elf"
        reason = ""
        if outcome.code == 0 and elf.is_file():
            shutil.copy(elf, result / ELF)
            shutil.copy(elf.with_suffix(".map"), result / MAP)
        else:
            reason = _why(outcome, project, rubric)
            (result / "failure.txt").write_text(reason, encoding="utf-8")
    try:
        os.replace(result, kept)
    except OSError:
        shutil.rmtree(result, ignore_errors=True)
    return (None, reason) if reason else (kept, "")


def _why(outcome: Outcome, project: Path, rubric: Rubric) -> str:
    if outcome.timed_out:
        return f"the build took more than {rubric.limits.build_seconds} s of processor time"
    text = "\n".join(errors_in(outcome.output, project)[:8]) or outcome.output.strip()[-400:]
    return text.replace(str(project), ".")


def _failed(rubric: Rubric, reason: str) -> list[dict[str, Any]]:
    return [check_row(check, 0.0, reason) for check in rubric.checks]


def check_row(check: Check, share: float, found: str) -> dict[str, Any]:
    return {
        "name": check.name,
        "points": round(share * check.points, 4),
        "of": check.points,
        "hidden": check.hidden,
        "found": found,
    }


def grade_one(job: Job) -> dict[str, Any]:
    """Grade one submission; what is wrong with it is in the result, never an error."""
    rubric = read_rubric(Path(job.rubric))
    submission = Submission(job.submission, Path(job.path))
    cache = Path(job.cache)
    try:
        sources = read_sources(submission, rubric.folders, rubric.needs_image)
    except UsageError as error:
        return _result(rubric, submission, "", _failed(rubric, error.sentence))
    answers = read_answers(sources.get(ANSWERS_FILE))
    key = hashlib.sha256(
        json.dumps(
            [rubric.digest, job.design, {k: v.hex() for k, v in sorted(sources.items())}]
        ).encode()
    ).hexdigest()
    rows, defect = _program_rows(rubric, submission, sources, cache, job.design)
    rows = [
        _answer_row(check, answers) if check.kind == "answer" else row
        for check, row in zip(rubric.checks, rows, strict=True)
    ]
    result = _result(rubric, submission, key, rows)
    return {**result, "defect": defect} if defect else result


def _answer_row(check: Check, answers: Answers) -> dict[str, Any]:
    met, found = parse_wanted(check.value).judge(answers)
    return check_row(check, float(met), found)


def _program_rows(
    rubric: Rubric, submission: Submission, sources: dict[str, bytes], cache: Path, design: bool
) -> tuple[list[dict[str, Any]], str]:
    """Build, run, judge: rows of all checks, those of answers without points, and a defect."""
    if not rubric.needs_image:
        return _failed(rubric, ""), ""
    program = {name: text for name, text in sources.items() if name != ANSWERS_FILE}
    refused = refusal(program)
    if refused:
        return _failed(rubric, refused), ""
    image, reason = build(rubric, submission, program, cache, design)
    if image is None:
        return _failed(rubric, reason), ""
    return _judged(rubric, image)


def _judged(rubric: Rubric, image: Path) -> tuple[list[dict[str, Any]], str]:
    """Run and judge in a limited process of its own: rows, and what was not the submission's fault.

    The image is the submission's code, but what reads it is ours.
    """
    limits = rubric.limits
    with tempfile.TemporaryDirectory(dir=image.parent.parent) as folder:
        answer = Path(folder) / "answer.json"
        command = [sys.executable, "-m", "ravenbrick.grading.judge", str(rubric.path.resolve())]
        outcome = run_limited(
            [*command, str(image.resolve()), str(answer.resolve())],
            Path(folder),
            limits.run_seconds,
            limits.memory_mb,
            limits.file_mb,
            {"MPLCONFIGDIR": folder},
        )
        if outcome.code == 0 and answer.is_file():
            rows: list[dict[str, Any]] = json.loads(answer.read_text("utf-8"))
            return rows, ""
    if outcome.timed_out:
        reason = f"the runs took more than {limits.run_seconds} s of processor time"
        return _failed(rubric, reason), ""
    reason = f"the judge ended with {outcome.code}: {outcome.output.strip()[-400:]}"
    return _failed(rubric, "could not be judged"), reason


def _result(
    rubric: Rubric, submission: Submission, key: str, rows: list[dict[str, Any]]
) -> dict[str, Any]:
    return {
        "submission": submission.name,
        "rubric": rubric.name,
        "digest": key,
        "points": round(sum(row["points"] for row in rows), 4),
        "of": rubric.points,
        "checks": rows,
    }
