# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Each rubric against its solution and against wrong submissions (docs/lessons/wrong.toml).

`python -m verification.course.wrong_submissions [SHEETS] [--in FOLDER]` executes the lab sheets
with their solutions, where that has not been done in FOLDER, and grades each changed solution.
"""

from __future__ import annotations

import argparse
import re
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path

from ravenbrick.grading.campaign import run_campaign
from ravenbrick.grading.isolation import IsolationError, find_isolation
from ravenbrick.grading.rubric import read_rubric
from ravenbrick.grading.submission import Submission

from tools.docs.lessons import SHEETS, find, rubrics_of, run_sheet, run_solution
from verification.commands import Counts, NotRunError

WRONG = SHEETS / "wrong.toml"
TAKEN = ("src", "generated", "answers.toml")
WORKERS = 2


def wrong_submissions() -> dict[str, list[list[str]]]:
    """By rubric: what is wrong, file or folder, text, replacement."""
    return {name: table["wrong"] for name, table in tomllib.loads(WRONG.read_text()).items()}


def copy_of(solution: Path, folder: Path) -> Path:
    """What of a solution is handed in."""
    folder.mkdir(parents=True)
    for name in TAKEN:
        part = solution / name
        if part.is_dir():
            shutil.copytree(part, folder / name)
        elif part.is_file():
            shutil.copy(part, folder / name)
    return folder


def solution_in(solved: Path) -> Path:
    """The project that is handed in, in the folder where a sheet was executed."""
    (found,) = (path for path in solved.iterdir() if re.fullmatch(r"lab\d\d|term", path.name))
    return found


def solved_in(folder: Path, sheet: Path) -> Path:
    """Where in the folder the sheet and its solution were executed to the end, or are now."""
    solved, begun = folder / sheet.stem, folder / f"{sheet.stem}.begun"
    if not solved.is_dir():
        shutil.rmtree(begun, ignore_errors=True)
        begun.mkdir(parents=True)
        run_sheet(sheet, begun)
        run_solution(sheet, begun)
        begun.rename(solved)
    return solved


def _files_at(place: Path) -> list[Path]:
    return sorted(place.iterdir()) if place.is_dir() else [place]


def _changed(folder: Path, file: str, old: str, new: str) -> None:
    place = folder / file
    texts = {path: path.read_text("utf-8") for path in _files_at(place)}
    if not any(old in text for text in texts.values()):
        raise ValueError(f"{folder.name}: {file} has no '{old}'")
    for path, text in texts.items():
        path.write_text(text.replace(old, new), encoding="utf-8")


def judge(sheet: Path, solved: Path) -> Iterator[tuple[str, bool]]:
    """For each wrong submission of a sheet its name, and whether it lost points, and no other."""
    solution = solution_in(solved)
    wrong = wrong_submissions()
    for path in rubrics_of(sheet):
        rubric = read_rubric(path)
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            found = [Submission("right", copy_of(solution, folder / "right"))]
            for number, (_what, file, old, new) in enumerate(wrong[rubric.name]):
                made = copy_of(solution, folder / f"wrong-{number}")
                _changed(made, file, old, new)
                found.append(Submission(made.name, made))
            right, *others = run_campaign(rubric, found, folder / "out", WORKERS)
        lost = right["of"] - right["points"]
        yield f"{rubric.name}: the solution gets {right['points']:g} of {right['of']:g}", lost == 0
        for row, result in zip(wrong[rubric.name], others, strict=True):
            text = f"{rubric.name}: '{row[0]}' gets {result['points']:g} of {result['of']:g}"
            yield text, result["points"] < result["of"] and "defect" not in result


def judge_all(folder: Path, numbers: list[str]) -> list[tuple[str, bool]]:
    """The sheets of these numbers, or all; those not solved in the folder are solved first."""
    rows: list[tuple[str, bool]] = []
    for sheet in find(numbers):
        for row in judge(sheet, solved_in(folder, sheet)):
            print("ok   " if row[1] else "WRONG", row[0], file=sys.stderr, flush=True)
            rows.append(row)
    return rows


def suite(numbers: list[str] | None = None) -> Counts:
    """Solutions with all points, and wrong submissions that lost some."""
    with tempfile.TemporaryDirectory() as name:
        return _counts(Path(name), numbers or [])


def _counts(folder: Path, numbers: list[str]) -> Counts:
    try:
        find_isolation()
    except IsolationError as error:
        raise NotRunError(error.sentence) from None
    rows = judge_all(folder, numbers)
    return Counts(
        len(rows), sum(good for _, good in rows), [], [text for text, good in rows if not good]
    )


def _main() -> int:
    parser = argparse.ArgumentParser(description="Grade solutions, and wrong submissions.")
    parser.add_argument("sheets", nargs="*", help="numbers of the sheets: 01, 02, ...")
    parser.add_argument("--in", dest="folder", type=Path, help="where sheets are or get solved")
    options = parser.parse_args()
    if options.folder:
        counts = _counts(options.folder, options.sheets)
    else:
        counts = suite(options.sheets)
    return 1 if counts.failures else 0


if __name__ == "__main__":
    sys.exit(_main())
