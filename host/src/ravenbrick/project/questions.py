# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Questions that a student answers before the run: a number, or a signal over time as a sketch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ravenbrick.schemas.located_toml import LocatedToml

__all__ = ["NumberQuestion", "Question", "SketchQuestion", "read_questions"]


@dataclass(frozen=True)
class NumberQuestion:
    """The answer is a measure of the run, such as `settling_time`."""

    text: str
    measure: str


@dataclass(frozen=True)
class SketchQuestion:
    """The answer is a signal between two instants (ms), drawn between two values (SI)."""

    text: str
    signal: str
    from_ms: int
    until_ms: int
    lowest: float
    highest: float
    unit: str


Question = NumberQuestion | SketchQuestion


def _question(document: LocatedToml, index: int, table: dict[str, Any]) -> Question:
    if "measure" in table:
        return NumberQuestion(table["text"], table["measure"])
    for low, high in (("from_ms", "until_ms"), ("lowest", "highest")):
        if table[high] <= table[low]:
            problem = f"is {table[high]}; expected more than {low} = {table[low]}"
            raise document.error(("questions", index, high), problem)
    return SketchQuestion(
        table["text"],
        table["signal"],
        table["from_ms"],
        table["until_ms"],
        float(table["lowest"]),
        float(table["highest"]),
        table.get("unit", ""),
    )


def read_questions(document: LocatedToml) -> tuple[Question, ...]:
    """The [[questions]] of a scenario; raises `ProjectFileError`."""
    tables = document.values.get("questions", [])
    return tuple(_question(document, index, table) for index, table in enumerate(tables))
