# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A class in which most submissions are hostile: what each is told, and what the host lost.

`python -m verification.course.hostile [NAME ...]` writes docs/reference/hostile-submissions.md
when all attacks were graded. A right submission before and after each group must get all points,
no report may hold what only the host knew, and nothing may be new or missing on the host.
"""

from __future__ import annotations

import ctypes
import json
import os
import re
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.grading.adapters import readable
from ravenbrick.grading.campaign import run_campaign
from ravenbrick.grading.isolation import IsolationError, find_isolation, tried
from ravenbrick.grading.isolation.landlock import Landlock
from ravenbrick.grading.rubric import Rubric, read_rubric
from ravenbrick.grading.submission import find_submissions

from verification.commands import Counts, NotRunError
from verification.course.attacks import ATTACKS, SECRET, Attack, Place
from verification.support.paths import ROOT
from verification.support.submissions import RUBRIC, write_submission

PAGE = ROOT / "docs" / "reference" / "hostile-submissions.md"
SOLUTIONS = ROOT / "docs" / "teaching" / "01-tasks.md"
WORKERS = 2
SET_CHILD_SUBREAPER = 36
SECONDS = 10
SAID_LENGTH = 110
# Sentences that stand only in files of the lecturer.
PRIVATE = (SECRET, "root:x:0", ": for the lecturer", "settles as designed")
LIMITS = f"\n[limits]\ndesign_seconds = {SECONDS}\nbuild_seconds = {SECONDS}\n" \
    "run_seconds = 60\nmemory_mb = 1024\nfile_mb = 64\n"  # fmt: skip
ANSWER = '\n[[checks]]\nname = "an answer"\npoints = 1\nanswer = "presses between 1 and 3"\n'


@dataclass(frozen=True)
class Judged:
    """An attack, what its student was told, its points, and what was wrong with that."""

    attack: Attack
    said: str
    points: float
    of: float
    lost: str

    @property
    def problem(self) -> str:
        """What is not as it must be; empty otherwise."""
        if self.lost:
            return f"the host lost {self.lost}"
        if self.points > self.attack.at_most:
            return f"got {self.points:g} points"
        if not re.search(self.attack.says, self.said, re.DOTALL):
            return f"was told '{self.said[:SAID_LENGTH]}'"
        return ""


def campaign_rubric(folder: Path) -> Rubric:
    """The first lab's rubric with short limits and an answer."""
    text = RUBRIC.read_text().replace("../../../examples", str(ROOT / "examples"))
    head, mark, checks = text.partition("\n[[checks]]")
    file = folder / "lecturer" / "lab.toml"
    file.write_text(head + LIMITS + mark + checks + ANSWER)
    return read_rubric(file)


def _fingerprint(folder: Path) -> dict[str, Any]:
    """Every file below a folder with its size and instant."""
    return {
        str(path): (path.lstat().st_size, path.lstat().st_mtime_ns)
        for path in sorted(folder.rglob("*"))
    }


def _adopt_orphans() -> None:
    """Processes whose parent has ended become children of this one, prctl(2)."""
    if ctypes.CDLL(None, use_errno=True).prctl(SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "orphans cannot be adopted")


def _processes() -> set[int]:
    """This process's children, their children and so on; none that has ended."""
    parents = {}
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            state, parent = (entry / "stat").read_text().rpartition(")")[2].split()[:2]
            if state != "Z":
                parents[int(entry.name)] = int(parent)
    found, generation = set[int](), {os.getpid()}
    while generation:
        generation = {child for child, parent in parents.items() if parent in generation}
        found |= generation
    return found


def grade(
    attacks: tuple[Attack, ...], folder: Path, border: str | None
) -> tuple[list[Judged], list[str]]:
    """All in one campaign with right submissions between; and what concerns all of them."""
    lecturer, students = folder / "lecturer", folder / "students"
    lecturer.mkdir()
    (lecturer / "marks.csv").write_text(f"anna;{SECRET}\n")
    place = Place(lecturer / "marks.csv", RUBRIC, SOLUTIONS)
    os.environ["RAVENBRICK_CANARY"] = SECRET
    rubric = campaign_rubric(folder)
    made: dict[str, Attack] = {}
    for number, attack in enumerate(attacks):
        name = f"s{number:03}-{attack.name}"
        attack.make(_made(students) / name, place)
        made[name] = attack
    for number in range(0, len(attacks) + 1, 10):
        write_submission(students / f"s{number:03}-a-right-one")
        (students / f"s{number:03}-a-right-one" / "answers.toml").write_text("presses = 2\n")
    _adopt_orphans()
    before, running = _fingerprint(lecturer), _processes()
    results = run_campaign(
        rubric,
        find_submissions([students]),
        folder / "out",
        WORKERS,
        design=True,
        border=border,
    )
    wrong = []
    if _fingerprint(lecturer) != before:
        wrong.append("the lecturer's folder changed")
    time.sleep(1)
    if left := _processes() - running:
        wrong.append(f"{len(left)} processes are left")
    if parts := list((folder / "out").rglob("*.part")):
        wrong.append(f"{len(parts)} unfinished files are left")
    for result in results:
        if "right-one" in result["submission"] and result["points"] != result["of"]:
            wrong.append(f"{result['submission']} got {result['points']:g}")
        if "defect" in result:
            wrong.append(f"{result['submission']}: the grader failed: {result['defect']}")
    return [judged for r in results for judged in _judged(made, r)], wrong


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _judged(made: dict[str, Attack], result: dict[str, Any]) -> list[Judged]:
    attack = next((a for n, a in made.items() if result["submission"].startswith(n)), None)
    if attack is None:
        return []
    whole = json.dumps(result) + readable([result])
    lost = ", ".join(f"'{text}'" for text in PRIVATE if text in whole)
    if not readable([result]).replace("\n", "").isprintable():
        lost = "its terminal"
    missed = [row["found"] for row in result["checks"] if row["points"] < row["of"]]
    said = missed[0] if attack.at_most == 0 and missed else " / ".join(missed)
    return [Judged(attack, said, result["points"], result["of"], lost)]


def _cell(text: str) -> str:
    line = " ".join(re.sub(r"[/\w.-]*/(?=[\w.-]+)", "", text).replace("|", "/").split())
    return line if len(line) <= SAID_LENGTH else f"{line[: SAID_LENGTH - 2]} …"


def page(judged: list[Judged]) -> str:
    """The reference page."""
    lines = [
        "# Hostile submissions",
        "",
        "Generated by `python -m verification.course.hostile`; do not edit. The submissions below",
        "are graded in one campaign with `--run-design`, between right ones that must get all",
        "points. Each tries to read what only the host has (a file and a variable with a secret,",
        "the rubric, the solutions), to write there, to take more than its share, or to get marks",
        "that it has not earned. Nothing lost means: no secret in the report, nothing new or",
        "changed on the host, no process left, the other marks as before. The guide of",
        "[grading](../guides/grading.md) explains the border.",
        "",
        "| Submission | Attack | Points | The student is told | Host lost |",
        "|---|---|---:|---|---|",
    ]
    for one in judged:
        said = _cell(one.said) or "(all points)"
        lines.append(
            f"| {one.attack.name} | {one.attack.tries} | {one.points:g} of {one.of:g} "
            f"| {said} | {one.lost or 'nothing'} |"
        )
    return "\n".join([*lines, ""])


def measure(
    names: tuple[str, ...] = (), border: str | None = None
) -> tuple[list[Judged], list[str]]:
    """Grade the attacks, all without names.

    Behind the border that is found first, the page is written when all were as they must be.
    """
    attacks = tuple(a for a in ATTACKS if not names or a.name in names)
    with tempfile.TemporaryDirectory(prefix="ravenbrick-hostile-") as name:
        judged, wrong = grade(attacks, Path(name), border)
    wrong += [f"{j.attack.name}: {j.problem}" for j in judged if j.problem]
    if not names and not border and not wrong:
        PAGE.write_text(page(judged), encoding="utf-8")
    return judged, wrong


def suite() -> Counts:
    """Attacks whose report is right and that cost the host nothing, behind both borders."""
    try:
        find_isolation()
    except IsolationError as error:
        raise NotRunError(error.sentence) from None
    judged, wrong = measure()
    if not tried(Landlock()):
        others, more = measure(border=Landlock.name)
        judged, wrong = judged + others, wrong + [f"{Landlock.name}: {text}" for text in more]
    return Counts(len(judged), len(judged) - min(len(wrong), len(judged)), [], wrong)


if __name__ == "__main__":
    found, problems = measure(tuple(sys.argv[1:]))
    for one in found:
        print(f"{one.attack.name:<20} {one.points:>4g} {_cell(one.said)}")
    print("\n".join(problems), file=sys.stderr)
    sys.exit(1 if problems else 0)
