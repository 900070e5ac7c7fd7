# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""JSON with the line of each key, in the form that TOML files are read in."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

from ravenbrick.errors import ProjectFileError
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml, utf8_text

__all__ = ["read_json"]

_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
_SCALAR = re.compile(r"[^\s,\]}]+")
_BETWEEN = re.compile(r"[\s,:]*")


class _Locator:
    """One pass over valid JSON text that notes the line of each key and list item."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0
        self.lines: dict[KeyPath, int] = {}
        self._line = 1
        self._counted = 0

    def _skip(self) -> str:
        between = _BETWEEN.match(self.text, self.position)
        self.position = between.end() if between else self.position
        return self.text[self.position]

    def _note(self, path: KeyPath) -> None:
        self._line += self.text.count("\n", self._counted, self.position)
        self._counted = self.position
        self.lines[path] = self._line

    def _take(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self.text, self.position)
        if match is None:
            return ""
        self.position = match.end()
        return match.group()

    def value(self, path: KeyPath) -> None:
        """Pass over one value."""
        first = self._skip()
        if first == "{":
            self.position += 1
            while self._skip() != "}":
                start = self.position
                key = (*path, json.loads(self._take(_STRING)))
                end, self.position = self.position, start
                self._note(key)
                self.position = end
                self.value(key)
            self.position += 1
        elif first == "[":
            self.position += 1
            index = 0
            while self._skip() != "]":
                self._note((*path, index))
                self.value((*path, index))
                index += 1
            self.position += 1
        else:
            self._take(_STRING if first == '"' else _SCALAR)


def _no_number(name: str) -> float:
    raise ValueError(f"'{name}' is not JSON; leave it out")


def _too_deep(path: Path, what: str) -> ProjectFileError:
    return ProjectFileError(path, 1, "", f"nested too deeply; write {what}")


def read_json(path: Path, what: str, parse_float: Callable[[str], Any] = Decimal) -> LocatedToml:
    """Read a JSON file whose root is an object; decimals stay as written, unless asked for floats.

    `what` the file should be, with its article, for the advice of errors.

    Raises `ProjectFileError`, which names the line of a syntax error.
    """
    try:
        text = utf8_text(path)
    except OSError as error:
        problem = f"cannot be read ({error.strerror}); name {what}"
        raise ProjectFileError(path, 1, "", problem) from None
    try:
        values = json.loads(text, parse_float=parse_float, parse_constant=_no_number)
    except json.JSONDecodeError as error:
        problem = f"not valid JSON: {error.msg}; correct this line"
        raise ProjectFileError(path, error.lineno, "", problem) from None
    except ValueError as error:
        raise ProjectFileError(path, 1, "", f"cannot be read: {error}") from None
    except RecursionError:
        raise _too_deep(path, what) from None
    if not isinstance(values, dict):
        raise ProjectFileError(path, 1, "", "expected an object '{...}' at the root")
    locator = _Locator(text)
    try:
        locator.value(())
    except RecursionError:
        raise _too_deep(path, what) from None
    return LocatedToml(path, values, locator.lines)
