# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The syllabus names sheets that exist, and its sums are right."""

from __future__ import annotations

import re

import pytest

from tools.docs.lessons import TEACHING, find, part

SYLLABUS = (TEACHING / "syllabus.md").read_text("utf-8")
VARIANTS = ["Real-time systems", "Control", "Real-time control"]


def _rows(text: str) -> list[list[str]]:
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_variant_has_fourteen_weeks_and_each_sheet_once(variant: str) -> None:
    """Weeks are counted from one, and the sheets are there under their names."""
    weeks = [row for row in _rows(part(SYLLABUS, variant)) if row[0].isdigit()]
    assert [int(row[0]) for row in weeks] == list(range(1, 15))
    sheets = re.findall(r"\[(\d+) ([^]]+)\]\((\S+)\)", part(SYLLABUS, variant))
    assert len(sheets) >= 9
    assert len({path for _, _, path in sheets}) == len(sheets)
    for number, title, path in sheets:
        first = (TEACHING / path).read_text("utf-8").splitlines()[0]
        assert first == f"# {number}. {title}"


def _needs(number: str) -> list[str]:
    """Sheets in the first sentence of a sheet's prerequisites."""
    (sheet,) = find([f"{int(number):02}"])
    sentence = re.search(r"You need:(.*?)\.\s", sheet.read_text("utf-8"), re.DOTALL)
    assert sentence is not None, sheet.name
    named = re.findall(r"sheets? (\d+)(?:\]\(\S+\))?(?: and (\d+))?", sentence[1])
    return [found for pair in named for found in pair if found]


@pytest.mark.parametrize("variant", VARIANTS)
def test_what_a_sheet_needs_comes_before_it_or_is_named_as_left_out(variant: str) -> None:
    """The table of prerequisites left out has these, and no others."""
    order = re.findall(r"\[(\d+) [^]]+\]\(\S+\)", part(SYLLABUS, variant))
    before = {sheet: order[:place] for place, sheet in enumerate(order)}
    missing = [[one, need] for one in order for need in _needs(one) if need not in before[one]]
    rows = _rows(part(SYLLABUS, "Prerequisites that a variant leaves out"))
    assert [row[1:3] for row in rows if row[0] == variant] == missing


@pytest.mark.parametrize("variant", VARIANTS)
def test_minutes_of_a_student_add_up(variant: str) -> None:
    """Each row is a product, the last one the sum; there is a session for each sheet."""
    rows = [row for row in _rows(part(SYLLABUS, variant)) if len(row) == 4][1:]
    work = {row[0]: [int(cell) for cell in row[1:]] for row in rows if row[1].isdigit()}
    assert all(times * each == minutes for times, each, minutes in work.values())
    assert sum(minutes for *_, minutes in work.values()) == int(rows[-1][3])
    project = part(SYLLABUS, variant).count("(../lessons/16-")
    assert work["session"][0] == part(SYLLABUS, variant).count("](../lessons/") - project


def test_shares_of_the_assessment_add_up() -> None:
    """Each scheme has 100 per cent."""
    rows = [row for row in _rows(part(SYLLABUS, "Assessment")) if row[1].isdigit()]
    for column in (1, 2, 3):
        assert sum(int(row[column]) for row in rows[:-1]) == int(rows[-1][column]) == 100
