# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Wrong submissions are there for every rubric, and for every sheet enough of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from tools.docs.lessons import find, rubrics_of
from verification.course.wrong_submissions import wrong_submissions


@pytest.mark.parametrize("sheet", find([]), ids=lambda sheet: sheet.stem)
def test_a_sheet_has_five_wrong_submissions_and_each_rubric_one(sheet: Path) -> None:
    """Each changes something, and they differ."""
    by_rubric = {path.stem: wrong_submissions()[path.stem] for path in rubrics_of(sheet)}
    rows = [tuple(row) for rows in by_rubric.values() for row in rows]
    assert all(by_rubric.values()) and len({row[1:] for row in rows}) == len(rows) >= 5
    assert all(old != new for _, _, old, new in rows)
