# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What becomes of Vitest's report about site and studio."""

from __future__ import annotations

from typing import Any

from verification.course.site import NO_FIREFOX, counts_of_site, counts_of_studio


def case(status: str = "passed", **meta: Any) -> dict[str, Any]:
    """A case of the report."""
    return {"fullName": "a brick moves", "status": status, "meta": meta}


def test_loads_of_the_first_page_stand_in_the_row_and_leave_no_case_out() -> None:
    """In the order of the processors, whatever the order of the cases."""
    slow = case(firstRobot={"rate": 4, "seconds": 3.94, "bytes": 1_745_000})
    quick = case(firstRobot={"rate": 1, "seconds": 1.2, "bytes": 1_745_000})
    counts = counts_of_site([case(), slow, quick])
    assert counts.case_count == counts.passed == counts.judged == 3
    assert not counts.excluded and counts.measured == [
        "the first page's robot moves after 1.2 s with this processor, after 3.9 s with one 4 "
        "times slower, as a phone's; 1.75 MB are loaded until then, packed"
    ]


def test_failed_and_skipped_cases_of_the_site_are_not_passed() -> None:
    """A load is not judged: a failed case has none."""
    counts = counts_of_site([case(), case("failed"), case("skipped")])
    assert (counts.case_count, counts.passed, counts.judged) == (3, 1, 2)
    assert counts.failures == ["a brick moves"] and not counts.measured
    assert counts.excluded == [{"count": 1, "reason": NO_FIREFOX}]


def test_the_row_of_the_studio_says_how_long_an_edit_takes_to_move() -> None:
    """As the page says it."""
    counts = counts_of_studio([case(edit="built in 2.3 s, runs 0.6 s later"), case()])
    assert counts.passed == 2
    assert counts.measured == ["after Ctrl+S: built in 2.3 s, runs 0.6 s later"]
