# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The league table of a rubric with races: places by time, deviation, energy, deadline margin."""

from __future__ import annotations

import hashlib
import hmac
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ravenbrick.errors import UsageError
from ravenbrick.grading.race import MEASURES
from ravenbrick.grading.rubric import Rubric

__all__ = ["Entry", "League", "league_of", "pseudonym", "races_of"]

Result = dict[str, Any]


@dataclass(frozen=True)
class Entry:
    """A submission; without a place, `sentence` says why.

    `score` is the mean of its ranks, `races` has its measures by the race's name.
    """

    name: str
    place: int | None
    score: float | None
    races: dict[str, dict[str, float]]
    sentence: str = ""


@dataclass(frozen=True)
class League:
    """All submissions, those with a place first, and the names of the races."""

    races: tuple[str, ...]
    entries: tuple[Entry, ...]


def pseudonym(name: str, secret: str) -> str:
    """The same for a name whenever it is asked for; nobody finds the name without the secret."""
    return "robot " + hmac.new(secret.encode(), name.encode(), hashlib.sha256).hexdigest()[:8]


def _measures(result: Result, rubric: Rubric) -> tuple[dict[str, dict[str, float]], str]:
    """Measures of the finished races, and why the first other one was not finished."""
    found: dict[str, dict[str, float]] = {}
    lost = ""
    for check, row in zip(rubric.checks, result["checks"], strict=False):
        if check.kind == "race" and "measures" in row:
            found[check.name] = row["measures"]
        elif check.kind == "race" and not lost:
            why = row.get("lost", "it could not be read or built")
            lost = f"{check.name}: {'did not finish' if check.hidden else why}"
    return found, lost


def _rank(value: float, all_of: Sequence[float], largest_wins: bool = False) -> int:
    return 1 + sum(other > value if largest_wins else other < value for other in all_of)


def races_of(rubric: Rubric) -> tuple[str, ...]:
    """Names of the races; raises `UsageError` for a rubric without one, or with one name twice."""
    races = tuple(check.name for check in rubric.checks if check.kind == "race")
    if not races:
        raise UsageError(f"the rubric '{rubric.name}' has no check with a 'race'; add one")
    if len(set(races)) < len(races):
        raise UsageError(f"the rubric '{rubric.name}' has two races of one name; rename one")
    return races


def league_of(rubric: Rubric, results: Sequence[Result], names: Sequence[str]) -> League:
    """Places by the mean rank over all races and measures; equal means share a place."""
    races = races_of(rubric)
    measured = [_measures(result, rubric) for result in results]
    finished = [found for found, lost in measured if not lost]
    columns = [
        ([found[race][m] for found in finished], largest_wins)
        for race in races
        for m, largest_wins in MEASURES.items()
    ]
    scores = [
        math.fsum(_rank(values[place], values, wins) for values, wins in columns) / len(columns)
        for place in range(len(finished))
    ]
    entries, left = [], iter(scores)
    for name, (found, lost) in zip(names, measured, strict=True):
        score = None if lost else next(left)
        place = None if score is None else _rank(score, scores)
        entries.append(Entry(name, place, score, found, lost))
    return League(races, tuple(sorted(entries, key=lambda e: (e.place or math.inf, e.name))))
