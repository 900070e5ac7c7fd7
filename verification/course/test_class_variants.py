# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A sample of the campaign of 300 students."""

from __future__ import annotations

import pytest

from verification.course.class_variants import measure


@pytest.mark.parametrize("sheet", ["lab-04", "lab-06", "lab-10", "lab-14", "lab-20"])
def test_own_hand_ins_pass_and_copied_ones_do_not(sheet: str) -> None:
    """Eight students, each under every other name."""
    measured = measure(sheet, 8)
    assert measured.own == 8 and measured.copied == 0
