# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The name of an exception that nothing handled, from the source line that raised it.

The compiler of a program without exception handlers hands over file and line, but no name.
"""

from __future__ import annotations

import re
from pathlib import Path

__all__ = ["source_place", "with_name", "with_source"]

UNNAMED = "unhandled exception"
_RAISE = re.compile(r"raise\s+([A-Za-z][\w.]*)", re.IGNORECASE)
# A function that ends without a return statement.
_END = re.compile(r"end\b", re.IGNORECASE)

Place = tuple[str, int, int]


def source_place(place: Place | None, project: Path) -> Place | None:
    """The place with the path of its file, which may be only a name of a file in the project."""
    if place is None or "/" in place[0]:
        return place
    found = next(iter(sorted((project / "src").rglob(place[0]))), None)
    return None if found is None else (str(found), place[1], place[2])


def _source_line(place: Place) -> str | None:
    file, number, _column = place
    try:
        lines = Path(file).read_text("utf-8", "replace").splitlines()
    except OSError:
        return None
    return lines[number - 1] if 0 < number <= len(lines) else None


def with_name(message: str, place: Place | None) -> str:
    """The message with the exception's name, where the source can be read.

    `place`: file, line and column of the raise. All checks of the language but a missing return
    raise Constraint_Error.
    """
    if place is None or not message.startswith(UNNAMED):
        return message
    line = _source_line(place)
    if line is None or not place[0].endswith((".adb", ".ads")):
        return message
    text = line[max(place[2] - 1, 0) :].lstrip()
    raised = _RAISE.match(text) if place[2] else _RAISE.search(text)
    if raised:
        name = raised.group(1)
    elif message.startswith(f'{UNNAMED} ("'):
        found = _RAISE.search(line)
        name = found.group(1) if found else UNNAMED
    else:
        name = "Program_Error" if _END.match(text) else "Constraint_Error"
    return name + message.removeprefix(UNNAMED)


def with_source(place: Place | None) -> str:
    """The source line with a mark below the column; empty where it cannot be read."""
    line = None if place is None else _source_line(place)
    if place is None or line is None:
        return ""
    shown = f"{place[1]:>5} | {line.rstrip()}"
    return shown if not place[2] else f"{shown}\n      | {' ' * (place[2] - 1)}^"
