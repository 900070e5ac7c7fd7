# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A sample of the campaign of 300 students."""

from __future__ import annotations

import pytest

from verification.course.class_variants import SHEETS, measure


# The recordings of sheet 3 take a minute.
@pytest.mark.parametrize("sheet", [sheet for sheet in SHEETS if sheet != "lab-03"])
def test_own_hand_ins_pass_and_copied_ones_do_not(sheet: str) -> None:
    """Eight students, each under every other name."""
    measured = measure(sheet, 8)
    assert measured.own == 8 and measured.copied == 0
