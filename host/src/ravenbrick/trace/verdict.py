# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Verdicts on criteria and expectations: the value that a run gave, and whether it is expected."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from ravenbrick.errors import ScenarioError
from ravenbrick.project.criteria import Expectation
from ravenbrick.project.scenario import Criterion

__all__ = ["ALIVE", "CriterionResult", "Measured", "Verdict", "expects_fault", "judge"]

ALIVE = ("reached", "power_off")


class Measured(Protocol):
    """A measured run."""

    @property
    def native(self) -> Any:
        """The `Measured` of the compiled module, which judges."""


@dataclass(frozen=True)
class CriterionResult:
    """A criterion with the value that the run gave; `place` is its file and line.

    `label`: what was measured and what was expected; `shown`: the value for people.
    """

    criterion: Criterion
    value: float
    met: bool
    place: str
    label: str
    shown: str
    problem: str

    @property
    def sentence(self) -> str:
        """What is wrong, with file and line."""
        return f"{self.place}: {self.problem}"

    def as_json(self) -> dict[str, object]:
        """With plain types."""
        bounds = {"minimum": self.criterion.minimum, "maximum": self.criterion.maximum}
        return {"measure": self.criterion.measure, "value": self.value, **bounds, "met": self.met}


@dataclass(frozen=True)
class Verdict:
    """The value that decided (in the written unit, or a text), when it was seen (s), the judgement.

    `label`: the expectation as it was written; `shown`: the value for people.
    """

    expectation: Expectation
    value: float | str | None
    unit: str
    at: float | None
    met: bool
    label: str
    shown: str
    problem: str

    @property
    def sentence(self) -> str:
        """What is wrong, with file and line where there is one."""
        return f"{self.expectation.place}: {self.problem}"

    def as_json(self) -> dict[str, object]:
        """With plain types."""
        return {
            "expectation": self.label,
            "value": self.value,
            "unit": self.unit,
            "at": self.at,
            "met": self.met,
        }


def expects_fault(expectations: Sequence[Expectation]) -> bool:
    """Whether faults are judged by an expectation instead of ending the command."""
    return any(expectation.judges_faults for expectation in expectations)


def judge(expectation: Expectation, measures: Measured) -> Verdict:
    """Judge one expectation; raises `ScenarioError` when the run can never show it."""
    answer = measures.native.answer(json.dumps({"expectations": [expectation.text]}))
    (row,) = json.loads(answer)["expectations"]
    if "problem" in row:
        raise ScenarioError(f"{expectation.place}: '{expectation.text}': {row['problem']}")
    return Verdict(
        expectation=expectation,
        value=row["value"],
        unit=row["unit"],
        at=row["at"],
        met=row["met"],
        label=row["label"],
        shown=row["shown"],
        problem=row["sentence"],
    )
