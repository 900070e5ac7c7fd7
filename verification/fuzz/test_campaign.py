# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What campaigns count together."""

from __future__ import annotations

from typing import Any

import pytest

from verification.fuzz.campaign import added


def row(target: str, seconds: int, cases: int, findings: int) -> dict[str, Any]:
    """What a campaign says of a target."""
    return {"target": target, "seconds": seconds, "case_count": cases, "findings": findings}


@pytest.mark.parametrize(
    ("earlier_findings", "together"), [(0, row("a", 25, 1100, 2)), (1, row("a", 10, 100, 2))]
)
def test_campaigns_are_counted_together_until_something_is_found(
    earlier_findings: int, together: dict[str, Any]
) -> None:
    """What was found was corrected since, so that earlier cases say nothing."""
    held = [row("a", 15, 1000, 0), row("b", 15, 7, earlier_findings)]
    new = row("c", 10, 5, 0)
    assert added([row("a", 10, 100, 2), new], held) == [together, new]
