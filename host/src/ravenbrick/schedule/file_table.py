# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One table of a task-set file, whose errors name file, line and field."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from ravenbrick.errors import ProjectFileError
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml

__all__ = ["FileTable"]

Choice = TypeVar("Choice", bound=str)


@dataclass(frozen=True)
class FileTable:
    """One table of the file; errors name file, line and field."""

    document: LocatedToml
    path: KeyPath
    values: dict[str, Any]

    def error(self, name: str, problem: str) -> ProjectFileError:
        return self.document.error((*self.path, name), problem)

    def only(self, known: Iterable[str]) -> None:
        """Refuse fields that do not exist."""
        names = list(known)
        for name in self.values:
            if name not in names:
                close = difflib.get_close_matches(name, names, 1)
                advice = f"did you mean '{close[0]}'?" if close else f"known: {', '.join(names)}"
                raise self.error(name, f"unknown field; {advice}")

    def required(self, name: str) -> Any:
        if name not in self.values:
            raise self.error(name, "is missing; add it")
        return self.values[name]

    def text(self, name: str, default: str | None = None) -> str:
        value = self.required(name) if default is None else self.values.get(name, default)
        if not isinstance(value, str) or not (value or default == ""):
            raise self.error(name, f"is {value!r}; expected a text in quotes")
        return value

    def choice(self, name: str, allowed: Sequence[Choice], default: Choice) -> Choice:
        value = self.text(name, default)
        for each in allowed:
            if each == value:
                return each
        raise self.error(name, f"is '{value}'; expected one of {', '.join(allowed)}")

    def time(self, name: str, default: Time | None = None) -> Time:
        value = self.required(name) if default is None else self.values.get(name, default)
        try:
            return exact(value)
        except ValueError as error:
            advice = "expected a number, or a text such as '1/3'"
            raise self.error(name, f"{error}; {advice}") from None

    def positive_time(self, name: str) -> Time:
        """A time above 0."""
        value = self.time(name)
        if value <= 0:
            raise self.error(name, f"is {value}; expected more than 0")
        return value

    def names(self, name: str) -> tuple[str, ...]:
        """A list of names."""
        value = self.values.get(name, [])
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self.error(name, f"is {value!r}; expected a list of names")
        return tuple(value)

    def whole(self, name: str, limit: int) -> int:
        value = self.required(name)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= limit:
            raise self.error(name, f"is {value!r}; expected a whole number from 0 to {limit}")
        return value

    def table(self, name: str) -> FileTable:
        value = self.values.get(name, {})
        if not isinstance(value, dict):
            raise self.error(name, "expected a table")
        return FileTable(self.document, (*self.path, name), value)

    def tables(self, name: str) -> list[FileTable]:
        value = self.values.get(name, [])
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            raise self.error(name, "expected a list of tables")
        return [
            FileTable(self.document, (*self.path, name, index), item)
            for index, item in enumerate(value)
        ]
