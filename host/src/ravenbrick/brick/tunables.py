# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The tunable parameters of a project's generated controllers: name, unit, range, value.

The generated C says all of it: the structure `<model>_P` in the header, the values in the C file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Tunable", "read_tunables"]

STRUCTURE = re.compile(r"typedef struct \{([^}]*)\} Parameters_(\w+);")
FIELD = re.compile(r"^\s*(\w+) (\w+); /\* (.*?); referenced by .*\*/$", re.MULTILINE)
VALUE = re.compile(r"^\s*(-?[\d.]+(?:[eE][-+]?\d+)?)[FU]?,? /\* (\w+): ", re.MULTILINE)
RANGE_FACTOR = 4.0


@dataclass(frozen=True)
class Tunable:
    """A variable of the program that may change during a run, by its path in the image.

    `value` is the one that the program begins with. A `whole` number is one of fixed-point code,
    in units of its last digit.
    """

    path: str
    unit: str
    description: str
    value: float
    whole: bool = False

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest value that is offered: from 0 to four times the designed one."""
        if self.value == 0.0:
            return -1.0, 1.0
        end = RANGE_FACTOR * self.value
        return min(0.0, end), max(0.0, end)


def _tunables(header: str, code: str) -> list[Tunable]:
    found = []
    values = {name: float(value) for value, name in VALUE.findall(code)}
    for fields, model in STRUCTURE.findall(header):
        for kind, name, comment in FIELD.findall(fields):
            description, _, unit = comment.rpartition(", ")
            if name in values:
                path = f"{model}_P.{name}"
                whole = "int" in kind
                found.append(Tunable(path, unit, description or comment, values[name], whole))
    return found


def read_tunables(generated: Path) -> tuple[Tunable, ...]:
    """Tunable parameters of all controllers in a folder of generated C; none where there is no C
    of ours."""
    found: list[Tunable] = []
    for header in sorted(generated.glob("*.h")):
        code = header.with_suffix(".c")
        if code.is_file():
            found += _tunables(header.read_text("utf-8"), code.read_text("utf-8"))
    return tuple(found)
