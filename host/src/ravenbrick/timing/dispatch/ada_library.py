# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Library files of GNAT (.ali): what a unit was compiled with and what its sources refer to.

The lines are described in the specifications of the compiler's packages Lib.Writ and Lib.Xref.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

__all__ = ["AdaLibrary", "Place", "Reference", "read_library"]

Place = tuple[str, int, int]  # name of the file, line, column

ENTITY = re.compile(r"(\d+)(\S)(\d+)[* ](\S+)(.*)")
REFERENCE = re.compile(r"(?:(\d+)\|)?(\d+)([A-Za-z<>=^])(?:<[^>]*>)?(\d+)(?:\[.*\])?")
NAME = re.compile(r'"[^"]*"|\w+')
PRIMITIVE = "pP"
ACCESS_RESULT = re.compile(r"\{[^}]*P\d+\}")


@dataclass(frozen=True)
class Reference:
    """A reference to an entity in a file: 'R' is a dispatching call, 's' a static one.

    `kind` is 'V' or 'y' for a function, 'P' or 'p' for what is an access value or returns one.
    """

    entity: Place
    kind: str
    letter: str
    file: str


@dataclass(frozen=True)
class AdaLibrary:
    """A library file.

    `compiler` is the version of the library, `violated` are restrictions that the unit violates,
    `needed` the units on which it depends with their files, `files` all its source files; `types`
    are the names of the types that have the operation at a place. A generic unit has no code: its
    instances are parts of other units.
    """

    path: Path
    compiler: str
    switches: frozenset[str]
    violated: frozenset[str]
    needed: dict[str, str]
    files: tuple[str, ...]
    types: dict[Place, frozenset[str]]
    references: tuple[Reference, ...]
    is_generic: bool = False

    @property
    def run_time(self) -> Path | None:
        """The folder with the run-time's library files."""
        named = (s.removeprefix("--RTS=") for s in self.switches if s.startswith("--RTS="))
        return next((Path(folder) / "adalib" for folder in named), None)


def _references(
    lines: Iterable[str], files: Sequence[str]
) -> Iterator[tuple[Place, str, str, str, Place]]:
    """Place, kind and name of an entity, letter and place of a reference to it."""
    section = current = ""
    entity: tuple[Place, str, str] | None = None
    for line in lines:
        entities = ENTITY.fullmatch(line)
        if line.startswith("X "):
            section, entity = files[int(line.split()[1]) - 1], None
            continue
        if entities is not None:
            row, kind, column, name, rest = entities.groups()
            word = NAME.match(name)
            kind = "P" if ACCESS_RESULT.search(name) else kind
            entity = (section, int(row), int(column)), kind, (word[0] if word else name).lower()
            current = section
        elif line.startswith(". ") and entity is not None:
            rest = line[2:]
        else:
            raise ValueError(f"'{line}' is no line about an entity")
        for text in rest.split():
            found = REFERENCE.fullmatch(text)
            if found is None:
                raise ValueError(f"'{text}' is no reference")
            number, row, letter, column = found.groups()
            current = files[int(number) - 1] if number else current
            yield *entity, letter, (current, int(row), int(column))


def read_library(path: Path) -> AdaLibrary:
    """Read a library file. Raises `ValueError` or `IndexError` for one that is damaged."""
    lines = path.read_text("utf-8", errors="replace").splitlines()
    rows = [row for row in map(str.split, lines) if len(row) > 1]
    depends = [row for row in rows if row[0] == "D"]
    files = tuple(row[1] for row in depends)
    types: dict[Place, frozenset[str]] = {}
    references = []
    begin = next((n for n, line in enumerate(lines) if line.startswith("X ")), len(lines))
    told = (line for line in lines[begin:] if line)
    for place, kind, name, letter, where in _references(told, files):
        if letter in PRIMITIVE:
            types[where] = types.get(where, frozenset()) | {name}
        else:
            references.append(Reference(place, kind, letter, where[0]))
    return AdaLibrary(
        path,
        next((line.partition('"')[2].rstrip('"') for line in lines[:1]), ""),
        frozenset(row[1] for row in rows if row[0] == "A"),
        frozenset(row[1] for row in rows if row[0] == "RV"),
        # The last word of a subunit is a name without its kind: it is a part of another unit.
        {row[-1].partition("%")[0]: row[1] for row in depends if "%" in row[-1]},
        files,
        types,
        tuple(references),
        all("GE" in row[4:] for row in rows if row[0] == "U"),
    )
