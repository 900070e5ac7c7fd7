# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The generated tables."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tools.docs.result_pages import fuzz_page, plant_page
from tools.docs.tables import VERIFICATION, benchmark_table, merge_rows, suites_table
from verification.table import Suite

SUITE = {
    "area": "cpu",
    "suite": "single-step",
    "case_count": 10,
    "passed": 9,
    "excluded": [{"count": 1, "reason": "the manual differs"}],
    "date": "2026-11-23",
    "elapsed_s": 90.0,
    "processor_s": 120.0,
    "note": "",
}


ENTRY = Suite("cpu", "single-step", "outside", "a core", "call", "module:function", 1)


def test_a_suite_is_a_row_with_its_exclusions() -> None:
    """What it is compared with, counts and reasons stand in the row."""
    row = "| outside | a core | 10 | 9 | 1: the manual differs | 2026-11-23 | 1.5 (2.0) |"
    assert row in suites_table([SUITE], [ENTRY])


def test_what_a_suite_measured_beside_its_cases_stands_below_the_table() -> None:
    """A row without it leaves no heading."""
    page = suites_table([{**SUITE, "measured": ["a core needs 3 s"]}], [ENTRY])
    assert page.endswith("\n\n## Measured, not judged\n\n- *single-step*: a core needs 3 s.\n")
    assert "Measured" not in suites_table([SUITE], [ENTRY])


def test_a_suite_that_failed_or_did_not_run_is_marked() -> None:
    """The figures of its last run stand with their date, the reason beside them."""
    row = {**SUITE, "note": "2026-11-30: failed: no compiler"}
    assert "| 2026-11-23, kept; 2026-11-30: **failed**: no compiler |" in suites_table(
        [row], [ENTRY]
    )


def test_a_suite_without_a_result_says_so() -> None:
    """A new entry of the table is seen before it has run."""
    assert "| single-step | outside | a core |  |  |  | not run yet |  |" in suites_table(
        [], [ENTRY]
    )


def test_a_row_of_no_suite_or_with_a_wrong_key_is_refused() -> None:
    """A misspelt row does not vanish silently."""
    with pytest.raises(SystemExit, match=r"not in suites\.toml: old"):
        suites_table([{**SUITE, "suite": "old"}], [ENTRY])
    with pytest.raises(SystemExit):
        suites_table([{"area": "cpu"}], [ENTRY])


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


def test_the_plants_page_rates_each_value_of_both_models() -> None:
    """A value with a band is in or out; without one it stands alone."""
    data = json.loads((VERIFICATION / "plant" / "points.json").read_text())
    page = plant_page(data)
    assert "| 9 V, no load | speed, rpm | 170 | 164.9 to 175.1 | 167.9, in | 167.1, in |" in page
    assert "| 9 V, no load | current, A | 0.060 |  | 0.055 | 0.121 |" in page
    assert page.count("**out**") == len(data["missed"])
    rich, published = page.split("## Sets as they are published")
    outside = sum(" published" not in miss["set"] and "drop" not in miss["set"]
                  for miss in data["missed"])  # fmt: skip
    assert rich.count("**out**") == outside
    assert f"{32 - outside} of 32 values" in rich
    assert "21 of 32 values" in published


def test_the_page_of_fuzzing_adds_up_time_cases_and_findings() -> None:
    """A finding is seen in the last row."""
    row = {"target": "t", "input": "g", "corpus": 2, "seconds": 3, "case_count": 5, "findings": 1}
    page = fuzz_page([row, {**row, "target": "u", "findings": 0}])
    assert "| t | g | 2 | 3 | 5 | 1 |" in page
    assert "| **all** |  |  | 6 | 10 | 1 |" in page
