# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The page of a league table: one HTML file for a course's web server."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from ravenbrick.report.page import counted, page

__all__ = ["league_page"]


class Entry(Protocol):
    """A submission of the table."""

    @property
    def name(self) -> str:
        """As shown."""

    @property
    def place(self) -> int | None:
        """None for a submission that did not finish."""

    @property
    def score(self) -> float | None:
        """Mean rank."""

    @property
    def races(self) -> Mapping[str, Mapping[str, float]]:
        """Measures by race."""

    @property
    def sentence(self) -> str:
        """Why it has no place."""


def _row(name: str, found: Mapping[str, float]) -> tuple[str, ...]:
    margin = f"{100 * found['deadline_margin']:.4g} %"
    values = (f"{found[key]:.4g}" for key in ("time_s", "deviation", "energy_j"))
    return (name, *values, margin)


def league_page(title: str, races: Mapping[str, str], entries: Sequence[Entry]) -> str:
    """The page; `races` maps names to what their deviation is."""
    placed = [entry for entry in entries if entry.place is not None]
    lost = [(entry.name, entry.sentence) for entry in entries if entry.place is None]
    return page(
        "league.html",
        title=title,
        lead=f"{counted(len(entries), 'submission')}, {counted(len(races), 'race')}.",
        head=("place", "submission", "score"),
        rows=[(str(e.place), e.name, f"{e.score:.3g}") for e in placed],
        races=[
            {
                "name": name,
                "text": text,
                "rows": [_row(entry.name, entry.races[name]) for entry in placed],
            }
            for name, text in races.items()
        ],
        lost=lost,
    )
