# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The page of timing parameters says what the virtual brick has."""

from __future__ import annotations

from tools.docs.timing_table import PAGE, with_table


def test_the_table_of_timing_parameters_is_the_virtual_bricks_own() -> None:
    """Otherwise run `python -m tools.docs.timing_table`."""
    page = PAGE.read_text()
    assert with_table(page) == page and "coprocessor_stretch_cycles" in page
