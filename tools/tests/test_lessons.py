# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The lab sheets do what they say, and the tool that executes them sees when they do not."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from ravenbrick.grading.answers import Answers, parse_wanted
from ravenbrick.grading.rubric import read_rubric

from tools.docs.lessons import (
    SHEETS,
    SheetError,
    find,
    rubrics_of,
    run_sheet,
    run_solution,
    solution_of,
    steps,
)

QUICK = ("03-identification.md", "06-inversion.md", "08-fixed-point.md", "12-ravenscar.md")
ALL = find([])


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_a_sheet_has_all_its_parts(sheet: Path) -> None:
    """Length, aims, theory with a source, steps with commands, questions, a solution."""
    text = sheet.read_text()
    assert re.search(r"^\*\*(90 minutes|One term)\.\*\* Aims: ", text, re.MULTILINE)
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert [h for h in headings if h != "Milestones"][:2] == ["Theory", "Steps"]
    assert headings[-1] == "Questions"
    assert re.search(r"\([^()]*(?:\d{4}|\*|ed\.|[Aa]ny text)", text.split("## Steps")[0])
    assert any(step.kind == "console" for step in steps(text))
    number = int(sheet.name[:2])
    assert f"## {number}. " in (SHEETS / "solutions.md").read_text()


def test_there_are_ten_and_more_in_order() -> None:
    """Numbered without a gap."""
    assert [int(sheet.name[:2]) for sheet in ALL] == list(range(1, len(ALL) + 1))
    assert len(ALL) >= 10


@pytest.mark.parametrize(
    "sheet",
    [
        pytest.param(
            sheet,
            marks=() if sheet.name in QUICK else pytest.mark.long("builds programs"),
        )
        for sheet in ALL
    ],
    ids=lambda sheet: sheet.stem,
)
def test_the_commands_of_a_sheet_do_what_it_says(sheet: Path, tmp_path: Path) -> None:
    """Every command, in order, in an empty folder; quoted output must appear. Then the solution,
    which the rubric gives all points."""
    run_sheet(sheet, tmp_path)
    run_solution(sheet, tmp_path)


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_a_rubric_asks_for_what_the_sheet_names(sheet: Path) -> None:
    """It can be read, gives ten points, and each number that it wants is in the sheet's table."""
    rubrics = [read_rubric(path) for path in rubrics_of(sheet)]
    assert rubrics and all(rubric.points == 10 for rubric in rubrics)
    checks = [check for rubric in rubrics for check in rubric.checks]
    wanted = {parse_wanted(c.value).name for c in checks if c.kind == "answer"}
    assert wanted == set(re.findall(r"^\| `(\w+)` \|", sheet.read_text(), re.MULTILINE))
    solution = solution_of(sheet)
    assert all(f"{name} = " in solution for name in wanted)


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_a_wrong_solution_gets_fewer_points(sheet: Path) -> None:
    """The rubric refuses the folder before its solution, and each number that is a third off."""
    grades = [step for step in steps(solution_of(sheet)) if "ravenbrick grade" in step.content]
    assert [step.argument for step in grades] == ["8", "0"]
    values = dict(re.findall(r"^(\w+) = ([-\d.]+)$", solution_of(sheet), re.MULTILINE))
    for check in (check for path in rubrics_of(sheet) for check in read_rubric(path).checks):
        if check.kind == "answer":
            wanted = parse_wanted(check.value)
            right = float(values[wanted.name])
            for value, met in ((right, True), (0.67 * right - 0.1, False)):
                assert wanted.judge(Answers({wanted.name: value}))[0] is met, wanted.name


WRONG = [
    ("```console\nfalse\n```\n", "ended with 1, not 0"),
    ("```console exit=3\ntrue\n```\n", "ended with 0, not 3"),
    ("```console\necho 42\n```\n```text seen\n43\n```\n", "'43' is not in the output"),
]


@pytest.mark.parametrize(("text", "problem"), WRONG)
def test_what_is_not_as_written_is_told(text: str, problem: str, tmp_path: Path) -> None:
    """Sheet and line are named."""
    sheet = tmp_path / "99-wrong.md"
    sheet.write_text("# 99\n\n" + text)
    with pytest.raises(SheetError, match=rf"99-wrong.md:\d+: (.|\n)*{problem}"):
        run_sheet(sheet, tmp_path)


def test_a_file_of_a_sheet_is_there_for_its_commands(tmp_path: Path) -> None:
    """Below folders, too."""
    sheet = tmp_path / "98-right.md"
    sheet.write_text(
        "```python file=a/b.py\nprint(6 * 7)\n```\n\n```console\npython3 a/b.py\n```\n"
    )
    assert run_sheet(sheet, tmp_path) == "42\n"
