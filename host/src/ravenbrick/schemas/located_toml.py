# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""TOML with the line of each key.

`toml_values` reads the values; a second, tolerant pass finds where each key stands. The second pass
relies on the first having accepted the text, so it never has to report an error of its own.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.errors import ProjectFileError, ScenarioError
from ravenbrick.toml_values import toml_values

__all__ = ["KeyPath", "LocatedToml", "dotted", "read_toml", "utf8_text"]

KeyPath = tuple[str | int, ...]
LIMIT = 2**63
FIELD_SHOWN = 100
_BARE_OR_QUOTED = re.compile(r'"((?:[^"\\]|\\.)*)"|\'([^\']*)\'|([A-Za-z0-9_-]+)')
_STRING = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'', re.DOTALL
)


def dotted(path: KeyPath) -> str:
    """The way a reader would name the field: `tasks[2].period_us`."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += f".{part}" if text else part
    return text


@dataclass(frozen=True)
class LocatedToml:
    """The values of a TOML file and the line of each key path (list items by index)."""

    path: Path
    values: dict[str, Any]
    lines: dict[KeyPath, int]

    def line_of(self, key_path: KeyPath) -> int:
        """Line of the key, of the first that it holds, or of the closest table around it that is
        written down."""
        while key_path:
            if key_path in self.lines:
                return self.lines[key_path]
            inside = [at for key, at in self.lines.items() if key[: len(key_path)] == key_path]
            if inside:
                return min(inside)
            key_path = key_path[:-1]
        return 1

    def error(self, key_path: KeyPath, problem: str) -> ProjectFileError:
        """An error that names file, line and field."""
        return ProjectFileError(self.path, self.line_of(key_path), dotted(key_path), problem)


class _Locator:
    """One pass over valid TOML text that notes the line of each key."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0
        self.lines: dict[KeyPath, int] = {}
        self.counts: dict[KeyPath, int] = {}

    def locate(self) -> dict[KeyPath, int]:
        """Visit each statement; `table` is where plain keys go."""
        table: KeyPath = ()
        while self._skip_blanks("\n"):
            if self.text.startswith("[[", self.position):
                table = self._header(2)
            elif self.text[self.position] == "[":
                table = self._header(1)
            else:
                self._pair(table)
        return self.lines

    def _line(self) -> int:
        return self.text.count("\n", 0, self.position) + 1

    def _note(self, path: KeyPath) -> None:
        self.lines.setdefault(path, self._line())

    def _skip_blanks(self, extra: str = "") -> bool:
        while self.position < len(self.text):
            if self.text[self.position] == "#":
                end = self.text.find("\n", self.position)
                self.position = len(self.text) if end < 0 else end
            elif self.text[self.position] in " \t\r" + extra:
                self.position += 1
            else:
                return True
        return False

    def _key(self) -> list[str]:
        parts: list[str] = []
        while True:
            self._skip_blanks()
            match = _BARE_OR_QUOTED.match(self.text, self.position)
            if match is None:
                return parts
            parts.append(next(group for group in match.groups() if group is not None))
            self.position = match.end()
            self._skip_blanks()
            if not self.text.startswith(".", self.position):
                return parts
            self.position += 1

    def _resolve(self, base: KeyPath, parts: list[str]) -> KeyPath:
        path = base
        for part in parts:
            path = (*path, part)
            if path in self.counts:
                path = (*path, self.counts[path])
        return path

    def _header(self, brackets: int) -> KeyPath:
        self.position += brackets
        parts = self._key()
        path = (*self._resolve((), parts[:-1]), parts[-1])
        if brackets == 2:
            self.counts[path] = self.counts.get(path, -1) + 1
            path = (*path, self.counts[path])
        self._note(path)
        self.position += brackets
        return path

    def _pair(self, table: KeyPath) -> None:
        start = self.position
        parts = self._key()
        path = table
        end, self.position = self.position, start
        for part in parts:
            path = (*path, part)
            self._note(path)
        self.position = self.text.index("=", end) + 1
        self._value(path)

    def _value(self, path: KeyPath) -> None:
        self._skip_blanks()
        string = _STRING.match(self.text, self.position)
        if string:
            self.position = string.end()
        elif self.text[self.position] == "[":
            self._array(path)
        elif self.text[self.position] == "{":
            self._inline_table(path)
        else:
            while self.position < len(self.text) and self.text[self.position] not in ",]}#\n":
                self.position += 1

    def _array(self, path: KeyPath) -> None:
        self.position += 1
        index = 0
        while self._skip_blanks("\n,") and self.text[self.position] != "]":
            self._note((*path, index))
            self._value((*path, index))
            index += 1
        self.position += 1

    def _inline_table(self, path: KeyPath) -> None:
        self.position += 1
        while self._skip_blanks("\n,") and self.text[self.position] != "}":
            self._pair(path)
        self.position += 1


def utf8_text(path: Path) -> str:
    """The text of a file, without the byte-order mark that some editors put before it.

    Raises `ProjectFileError` with the line of what is not UTF-8, and `OSError`.
    """
    content = path.read_bytes()
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise ProjectFileError(path, line, "", "not UTF-8 text; save the file as UTF-8") from None


def read_toml(path: Path, *, missing: str) -> LocatedToml:
    """Read a TOML file.

    `missing` is what to do when there is no such file. Raises `ScenarioError` for a missing file
    below `scenarios/`, otherwise `ProjectFileError`, which names the line of a syntax error.
    """
    try:
        text = utf8_text(path)
    except OSError as error:
        problem = f"cannot be read ({error.strerror}); {missing}"
        if "scenarios" in path.parts:
            raise ScenarioError(f"{path}: {problem}") from None
        raise ProjectFileError(path, 1, "", problem) from None
    try:
        values = toml_values(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(path, text, str(error)) from None
    except ValueError as error:
        raise ProjectFileError(path, 1, "", f"cannot be read: {error}") from None
    except RecursionError:
        problem = "nested too deeply; write plain tables and arrays"
        raise ProjectFileError(path, 1, "", problem) from None
    document = LocatedToml(path, values, _Locator(text.replace("\r\n", "\n")).locate())
    for key_path in _beyond_64_bits(values, ()):
        raise document.error(key_path, f"is too large; expected a whole number below {LIMIT}")
    return document


def _beyond_64_bits(value: Any, path: KeyPath) -> Iterator[KeyPath]:
    """Whole numbers that TOML does not have (TOML 1.0, Integer)."""
    if isinstance(value, int) and not -LIMIT <= value < LIMIT:
        yield path
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from _beyond_64_bits(inner, (*path, key))
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _beyond_64_bits(inner, (*path, index))


def _syntax_error(path: Path, text: str, message: str) -> ProjectFileError:
    place = re.search(r" \(at line (\d+), column \d+\)$", message)
    last_line = max(text.rstrip().count("\n") + 1, 1)
    line = int(place.group(1)) if place else last_line
    problem = re.sub(r" \(at [^)]*\)$", "", message)
    key = re.match(r"\s*([A-Za-z0-9_.\"'-]+)\s*=", text.split("\n")[line - 1])
    field = key.group(1)[:FIELD_SHOWN] if key else ""
    return ProjectFileError(path, line, field, f"not valid TOML: {problem}; correct this line")
