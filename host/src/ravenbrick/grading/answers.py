# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that a student hands in beside the program: `answers.toml`, one name and value a line."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ravenbrick.toml_values import toml_values

__all__ = ["ANSWERS_FILE", "Answers", "Wanted", "parse_wanted", "read_answers"]

ANSWERS_FILE = "answers.toml"
BYTES_MAX = 64_000
_NUMBER = r"([-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)"
_NAME = r"([a-z][a-z0-9_]*)"
_FORMS = (
    re.compile(rf"{_NAME} between {_NUMBER} and {_NUMBER}"),
    re.compile(rf"{_NAME} at least {_NUMBER}()"),
    re.compile(rf"{_NAME} at most (){_NUMBER}"),
)


@dataclass(frozen=True)
class Answers:
    """What was handed in; `problem` says why nothing of it can be read."""

    values: dict[str, object]
    problem: str = ""


@dataclass(frozen=True)
class Wanted:
    """A named number and its bounds."""

    name: str
    minimum: float | None
    maximum: float | None

    def judge(self, answers: Answers) -> tuple[bool, str]:
        """Whether it is met, and what was found."""
        if answers.problem:
            return False, answers.problem
        value = answers.values.get(self.name)
        if value is None:
            return False, f"{ANSWERS_FILE} has no '{self.name}'"
        if isinstance(value, bool) or not isinstance(value, int | float):
            return False, f"{self.name}: expected a number"
        try:
            value = float(value)
        except OverflowError:
            return False, f"{self.name}: the number is too large"
        low, high = self.minimum, self.maximum
        met = (low is None or value >= low) and (high is None or value <= high)
        return met, f"{self.name} = {value:g}"


def parse_wanted(text: str) -> Wanted:
    """`NAME between A and B`, `NAME at least A`, `NAME at most B`; raises `ValueError`."""
    for form in _FORMS:
        match = form.fullmatch(text.strip())
        if match:
            name, low, high = match.groups()
            return Wanted(name, float(low) if low else None, float(high) if high else None)
    raise ValueError(
        f"'{text}': expected NAME between A and B, NAME at least A or NAME at most B, the name of "
        "small letters, digits and '_'"
    )


def read_answers(content: bytes | None) -> Answers:
    """The file's content; None when it was not handed in."""
    if content is None:
        return Answers({}, f"there is no {ANSWERS_FILE}")
    if len(content) > BYTES_MAX:
        return Answers({}, f"{ANSWERS_FILE} is larger than {BYTES_MAX // 1000} KB")
    try:
        return Answers(toml_values(content.decode("utf-8")))
    except (ValueError, RecursionError) as error:
        return Answers({}, f"{ANSWERS_FILE}: {error}")
