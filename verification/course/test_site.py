# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What becomes of Vitest's report about the site."""

from __future__ import annotations

from typing import Any

from verification.course.site import counts_of_site


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
    assert (
        counts.failures == ["a brick moves"] and len(counts.excluded) == 1 and not counts.measured
    )
