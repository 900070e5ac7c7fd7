# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The page with the processor time of each sheet."""

from __future__ import annotations

from verification.course.sheet_times import Row, page


def test_a_class_takes_what_the_mean_of_the_sheets_makes_of_it() -> None:
    """300 students, 15 sheets, two processors: a second each is 37.5 minutes."""
    text = page([Row("lab-01", 10, 2, 0.5), Row("lab-02", 10, 4, 1.5)])
    assert "| lab-02 | 10 | 4 | 1.50 |" in text
    assert "The mean is 1.00 s (goal: 1.07)." in text
    assert "sheets, take 38 minutes on 2 processors" in text and "\n(goal: 40).\n" in text
