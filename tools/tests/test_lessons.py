# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The lab sheets do what they say, and the tool that executes them sees when they do not."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from ravenbrick.grading.answers import Answers, parse_wanted
from ravenbrick.grading.rubric import read_rubric

from tools.docs.lessons import (
    ROOT,
    TEACHING,
    SheetError,
    captioned,
    edited,
    find,
    part,
    rubrics_of,
    run_sheet,
    run_teaching_page,
    solution_of,
    steps,
    teaching_page,
)
from tools.docs.site.bricks import EXAMPLES, shown_on

QUICK = ("03-identification.md",)
ALL = find([])
PARTS = ["Goals", "Background", "Pre-lab", "Steps", "Experiment", "Results", "Discussion"]
PARTS += ["Submission", "Going further", "On a real brick", "Sources"]
FOR_LECTURERS = ["Solution", "Answers", "Marking", "Timing plan", "Common mistakes", "Slides"]
PICTURE = re.compile(r"!\[([^\]]*)\]\(\.\./pictures/generated/sheet-(\d\d)-([\w-]+)\.svg\)")


def _headings(text: str) -> list[str]:
    outside = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.findall(r"^## (.*)$", outside, re.MULTILINE)


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_a_sheet_has_all_its_parts(sheet: Path) -> None:
    """The headings, prerequisites and time, a question with a number, commands, sources."""
    text = sheet.read_text()
    assert _headings(text) == PARTS
    assert re.search(r"\*\*(90 minutes|One term)\.\*\* You need:", part(text, "Goals"))
    assert re.search(r"^1\. .*\d", part(text, "Pre-lab"), re.MULTILINE)
    assert any(step.kind == "console" for step in steps(part(text, "Steps")))
    assert re.search(r"^1\. ", part(text, "Discussion"), re.MULTILINE)
    assert re.search(r"\b(19|20)\d\d\b", part(text, "Sources"))
    assert "../teaching" not in text


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_the_brick_of_a_sheet_asks_before_it_runs(sheet: Path) -> None:
    """In its scenario, which a step writes or the example has."""
    for shown in shown_on(sheet):
        name = f"{shown.project}/scenarios/{shown.scenario}.toml"
        written = [step.content for step in steps(shown.steps) if step.argument == name]
        file = EXAMPLES / shown.example / "scenarios" / f"{shown.scenario}.toml"
        scenario = tomllib.loads(written[0] if written else file.read_text("utf-8"))
        assert scenario["questions"], name
    assert shown_on(sheet)


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_a_lecturers_page_has_all_its_parts(sheet: Path) -> None:
    """The headings, minutes that add up, enough slides."""
    text = teaching_page(sheet).read_text()
    assert _headings(text) == FOR_LECTURERS
    assert re.findall(r"^### (.*)$", part(text, "Answers"), re.MULTILINE) == [
        "Pre-lab",
        "Discussion",
        "Going further",
    ]
    minutes = re.findall(r"^\| *(\d+) *\|", part(text, "Timing plan"), re.MULTILINE)
    assert sum(map(int, minutes)) == 90 or sheet.stem == "16-project"
    assert part(text, "Slides").count("\n### ") >= 8


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_each_question_of_going_further_has_an_answer(sheet: Path) -> None:
    """In the order of the sheet."""
    asked = re.findall(r"^- ", part(sheet.read_text(), "Going further"), re.MULTILINE)
    answers = part(teaching_page(sheet).read_text(), "Answers").partition("### Going further\n")[2]
    numbers = re.findall(r"^(\d+)\. ", answers, re.MULTILINE)
    assert list(map(int, numbers)) == list(range(1, len(asked) + 1))


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_pictures_of_a_sheet_are_functions_and_have_alternative_text(sheet: Path) -> None:
    """Each generated picture names a public function of the sheet's module, and says something."""
    found = PICTURE.findall(part(sheet.read_text(), "Background"))
    assert found
    found += PICTURE.findall(sheet.read_text()) + PICTURE.findall(teaching_page(sheet).read_text())
    for words, number, name in found:
        module = ROOT / "tools" / "docs" / "figures" / f"sheet_{number}.py"
        assert f"\ndef {name.replace('-', '_')}() -> str:" in module.read_text()
        assert len(words) >= 20, name


def test_a_lecturers_page_belongs_to_each_sheet() -> None:
    """Apart from the syllabus there are no others."""
    assert {path.name for path in TEACHING.glob("[0-9]*.md")} == {sheet.name for sheet in ALL}


def test_there_are_ten_and_more_in_order() -> None:
    """Each number once, and a lecturer's page for each."""
    numbers = [sheet.name[:2] for sheet in ALL]
    assert len(set(numbers)) == len(numbers)
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
    """Every command, in order, in an empty folder; quoted output must appear. Then the lecturer's
    page: the rubric gives the solution all points, results and mistakes look as it says."""
    run_sheet(sheet, tmp_path)
    run_teaching_page(sheet, tmp_path)


@pytest.mark.parametrize("sheet", ALL, ids=lambda sheet: sheet.stem)
def test_a_rubric_asks_for_what_the_sheet_names(sheet: Path) -> None:
    """It can be read, gives ten points, and each number that it wants is in the sheet's table."""
    rubrics, text = [read_rubric(path) for path in rubrics_of(sheet)], sheet.read_text()
    assert rubrics and all(rubric.points == 10 for rubric in rubrics)
    checks = [check for rubric in rubrics for check in rubric.checks]
    wanted = {parse_wanted(c.value).name for c in checks if c.kind == "answer"}
    assert wanted == set(re.findall(r"^\| `(\w+)` \|", part(text, "Submission"), re.MULTILINE))
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


def test_an_edit_replaces_lines_that_are_there_once() -> None:
    """At several places; otherwise it says how often they are there."""
    assert edited("a\n  b\nc\n", "-a\n+x\n...\n   b\n-c\n") == "x\n  b\n"
    for text in ("b\n", "a\na\n", "aa\nba\n"):
        with pytest.raises(SheetError, match=r"are there [02] times, not once:\na\n"):
            edited(text, "-a\n+x\n")


def test_the_reader_sees_the_file_of_a_fence() -> None:
    """An edit is shown as a difference."""
    shown = captioned("A\n\n```edit file=a/b.py\n-x\n```\n", "```{language}\n{file}")
    assert shown == "A\n```diff\na/b.py\n-x\n```\n"


WRONG = [
    ("```edit file=none\n-a\n```\n", "these lines are there 0 times"),
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
