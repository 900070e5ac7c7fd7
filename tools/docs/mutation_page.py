# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The reference page with the scores of the mutation campaign and its survivors."""

from __future__ import annotations

from typing import Any

__all__ = ["mutation_page"]

Row = dict[str, Any]
HEAD = """\
<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->
<!-- SPDX-License-Identifier: Apache-2.0 -->
# Mutants

Generated from `verification/mutation/results.json` by
`python -m verification.mutation.campaign`; do not edit.

A mutant is one small change of a source file: another operator, a constant that is one more, a
negated condition, a statement left out. It is *killed* when the tests of its own room fail, and
*equivalent* when a person found that no behaviour can differ. Mutants are drawn by the seed among
all of a room's; those that the compiler refuses are not counted. The score is the share of killed
mutants among those that are not equivalent; 85 % in each room and 90 % in all are expected. A
sample below 60 is a first look, with a margin of error of up to 20 points. The date is that of the
measurement: sources and tests may have changed since.
[Verification](../internals/verification.md) explains how to run the campaign.

| Room | Date | Seed | Sampled | Killed | Equivalent | Score |
|---|---|---:|---:|---:|---:|---:|
"""
SURVIVORS = """
## Survivors

| Room | Mutant | Verdict |
|---|---|---|
"""


def _score(rows: list[Row]) -> str:
    sampled, killed, equivalent = (
        sum(row[key] for row in rows) for key in ("sampled", "killed", "equivalent")
    )
    return f"{sampled} | {killed} | {equivalent} | {killed / max(sampled - equivalent, 1):.0%} |"


def _code(mutant: str) -> str:
    text = mutant.replace("|", "\\|").replace("`", "'")
    return f"`{text}`"


def mutation_page(rows: list[Row]) -> str:
    """Rooms with their scores; every survivor with its verdict."""
    scores = [
        f"| {row['room']} | {row['date']} | {row['seed']} | {_score([row])}\n" for row in rows
    ]
    scores.append(f"| **all** | | | {_score(rows)}\n")
    survivors = [
        f"| {row['room']} | {_code(one['mutant'])} "
        f"| {one['verdict']}: {one['reason'] or 'not reviewed yet'} |\n"
        for row in rows
        for one in row["survivors"]
    ]
    return HEAD + "".join(scores) + SURVIVORS + "".join(survivors)
