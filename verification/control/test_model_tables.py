# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of public models: what is not at hand keeps its row and its date."""

from __future__ import annotations

from pathlib import Path

from verification.control.public_models import REFERENCE, TOTALS, simulink_page

EFERU = "EFeru/bldc-motor-control-FOC"


def test_rows_and_totals_of_absent_models_stay(tmp_path: Path) -> None:
    """The row of a repository that is there is counted again, here from one broken model."""
    last = (REFERENCE / "simulink-models.md").read_text(encoding="utf-8")
    here = tmp_path / EFERU
    here.mkdir(parents=True)
    (here / "broken.slx").write_bytes(b"no archive")
    page, count, read = simulink_page(tmp_path, last)
    assert (count, read) == (1, 0)
    rows = [line for line in page.splitlines() if line.startswith("| EFeru/")]
    assert len(rows) == 1 and rows[0].startswith(f"| {EFERU} | 1 | 0 |")
    for kept in ("| osudrl/atrias |", "| ahmdnbil/MBD |"):
        assert 0 < page.count(kept) == last.count(kept)
    totals = [text.partition(TOTALS)[2].partition("## Repositories")[0] for text in (page, last)]
    assert totals[0] == totals[1] and "looked at" in totals[0]
