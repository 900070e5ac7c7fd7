# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Wrong submissions are there for every rubric, and for every sheet enough of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from tools.docs.lessons import SheetError, find, rubrics_of
from verification.course import wrong_submissions as campaign
from verification.course.wrong_submissions import solved_in, wrong_submissions


@pytest.mark.parametrize("sheet", find([]), ids=lambda sheet: sheet.stem)
def test_a_sheet_has_five_wrong_submissions_and_each_rubric_one(sheet: Path) -> None:
    """Each changes something, and they differ."""
    by_rubric = {path.stem: wrong_submissions()[path.stem] for path in rubrics_of(sheet)}
    rows = [tuple(row) for rows in by_rubric.values() for row in rows]
    assert all(by_rubric.values()) and len({row[1:] for row in rows}) == len(rows) >= 5
    assert all(old != new for _, _, old, new in rows)


def test_a_sheet_whose_solution_failed_is_solved_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the beginning; one that was solved is not."""
    begun: list[Path] = []

    def sheet_done(_: Path, folder: Path) -> None:
        assert not any(folder.iterdir())
        (folder / "lab01").mkdir()
        begun.append(folder)

    def solution_done(_: Path, __: Path) -> None:
        if len(begun) == 1:
            raise SheetError("line 3: the machine was switched off")

    monkeypatch.setattr(campaign, "run_sheet", sheet_done)
    monkeypatch.setattr(campaign, "run_solution", solution_done)
    sheet = Path("01-tasks.md")
    with pytest.raises(SheetError):
        solved_in(tmp_path, sheet)
    assert [solved_in(tmp_path, sheet) / "lab01" for _ in range(2)] == [
        tmp_path / "01-tasks/lab01"
    ] * 2
    assert len(begun) == 2
