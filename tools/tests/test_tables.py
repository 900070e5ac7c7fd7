# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The generated tables."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tools.docs.result_pages import fuzz_page, plant_page
from tools.docs.tables import VERIFICATION, benchmark_table, conformance_table, merge_rows

SUITE = {
    "area": "cpu",
    "suite": "single-step",
    "case_count": 10,
    "passed": 9,
    "excluded": [{"count": 1, "reason": "the manual differs"}],
}


def test_a_suite_is_a_row_with_its_exclusions() -> None:
    """Counts and reasons stand in the row."""
    assert "| cpu | single-step | 10 | 9 | 1: the manual differs |" in conformance_table([SUITE])


def test_suites_are_ordered_by_area_then_name() -> None:
    """The order of the file does not matter."""
    other = {**SUITE, "area": "runtime", "suite": "a"}
    assert conformance_table([other, SUITE]) == conformance_table([SUITE, other])


def test_an_unknown_area_or_key_is_refused() -> None:
    """A misspelt row does not vanish silently."""
    with pytest.raises(ValueError):
        conformance_table([{**SUITE, "area": "weather"}])
    with pytest.raises(SystemExit):
        conformance_table([{"area": "cpu"}])


def test_a_figure_without_peer_has_empty_cells() -> None:
    """A figure may stand alone."""
    row = {
        "figure": "switch",
        "value": 90,
        "unit": "cycles",
        "peer": None,
        "peer_value": None,
        "ratio": None,
    }
    assert "| switch | 90 | cycles |  |  |  |" in benchmark_table([row])


def test_merging_replaces_rows_with_the_same_key(tmp_path: Path) -> None:
    """A suite that ran again has one row, with the new counts."""
    path = tmp_path / "results.json"
    merge_rows(path, [SUITE], ("area", "suite"))
    merge_rows(path, [{**SUITE, "passed": 10}], ("area", "suite"))
    assert [row["passed"] for row in json.loads(path.read_text())] == [10]


def test_the_plants_page_judges_each_value_and_names_the_contradiction() -> None:
    """A value with a band is in or out; without one it stands alone."""
    data = json.loads((VERIFICATION / "plant" / "points.json").read_text())
    page = plant_page(data)
    assert "| 9 V, no load | speed, rpm | 170 | 164.9 to 175.1 | 167.9, in |" in page
    assert "| 9 V, no load | current, A | 0.060 |  | 0.055 |" in page
    assert page.count("**out**") == len(data["missed"])
    assert "contradict each other" in page


def test_the_page_of_fuzzing_adds_up_time_cases_and_findings() -> None:
    """A finding is seen in the last row."""
    row = {"target": "t", "given": "g", "corpus": 2, "seconds": 3, "case_count": 5, "findings": 1}
    page = fuzz_page([row, {**row, "target": "u", "findings": 0}])
    assert "| t | g | 2 | 3 | 5 | 1 |" in page
    assert "| **all** |  |  | 6 | 10 | 1 |" in page
