# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A sample of the campaign of 300 students."""

from __future__ import annotations

import pytest

from verification.course.class_variants import PAGE, Measured, measure, own_numbers, page
from verification.course.own_answers import RUBRICS, SHEETS, rubric_of


# The recordings of sheet 3 take a minute.
@pytest.mark.parametrize("sheet", [sheet for sheet in SHEETS if sheet != "lab-03"])
def test_own_hand_ins_pass_and_copied_ones_do_not(sheet: str) -> None:
    """Four students, each under every other name."""
    measured = measure(sheet, 4)
    assert measured.own == 4 and measured.copied == 0


def test_each_rubric_with_own_answers_is_measured() -> None:
    """None is forgotten when a rubric gets some."""
    rubrics = (rubric_of(path.stem) for path in RUBRICS.glob("lab-*.toml"))
    own = {r.name for r in rubrics if any(c.own and c.kind == "answer" for c in r.checks)}
    assert own == set(SHEETS)


def test_the_page_says_what_is_own_and_keeps_what_was_measured() -> None:
    """A rubric that changed is seen here; a figure stays until it is measured again."""
    committed = PAGE.read_text("utf-8")
    assert own_numbers() in committed and page([], committed) == committed
    again = page([Measured("lab-03", 300, 300, 9, 0.5)], committed)
    assert "| lab-03 | 300 of 300 | 9 of 89700 | 0.010% | 50.0% |" in again
    assert "| lab-04 | 300 of 300 | 776 of 89700" in again
