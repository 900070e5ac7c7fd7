# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Places of errors, from the answers of commands."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

__all__ = ["problems_of"]

# The form of every error of the command line that has a place (ravenbrick.errors).
_PLACED = re.compile(r"^(?P<file>[^:\n]+):(?P<line>\d+)(?::(?P<column>\d+))?: (?P<message>.+)$")


def problems_of(
    answer: Mapping[str, Any], name_of: Callable[[Path], str | None]
) -> list[dict[str, Any]]:
    """The errors of a command that failed: file, line and column from 1, message.

    `name_of` gives the name of a file below the project. An error elsewhere has no file, a message
    with its whole sentence, and line 0; column 0 is the whole line.
    """
    lines = answer.get("errors") or [answer["error"], *answer.get("detail", "").splitlines()]
    found = []
    for number, text in enumerate(lines):
        placed = _PLACED.match(text)
        name = name_of(Path(placed["file"])) if placed else None
        if placed and name:
            line, column = int(placed["line"]), int(placed["column"] or 0)
            row = {"file": name, "line": line, "column": column, "message": placed["message"]}
            found.append(row)
        elif number == 0 or "errors" in answer:
            found.append({"file": None, "line": 0, "column": 0, "message": text})
    return found
