# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Stimuli from CSV: a column of instants, and a column per input.

The first column is `time_s`, `time_ms`, `time_us` or `at_cycles`. An empty cell changes nothing;
lines that begin with '#' are comments.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from pathlib import Path

from ravenbrick.clock import Clock
from ravenbrick.errors import ProjectFileError
from ravenbrick.project.stimuli import Channels, Sequence
from ravenbrick.schemas.located_toml import utf8_text

__all__ = ["read"]

LARGEST_EXPONENT = 300


def _units(clock: Clock) -> dict[str, Fraction]:
    """Seconds per unit of each column of instants."""
    return {
        "time_s": Fraction(1),
        "time_ms": Fraction(1, 1000),
        "time_us": Fraction(1, 1_000_000),
        "at_cycles": 1 / clock.hertz,
    }


def _rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of each row that says something."""
    for line, content in enumerate(utf8_text(path).splitlines(), 1):
        if content.strip() and not content.lstrip().startswith("#"):
            yield line, [cell.strip() for cell in next(csv.reader([content]))]


def _number(path: Path, line: int, column: str, cell: str) -> Fraction:
    """An exact number; its size is limited, so that no cell takes long to read."""
    try:
        number = Decimal(cell)
    except InvalidOperation:
        raise ProjectFileError(path, line, column, f"is '{cell}'; expected a number") from None
    if not number.is_finite() or abs(number.adjusted()) > LARGEST_EXPONENT:
        if number != 0:
            raise ProjectFileError(path, line, column, f"is '{cell}'; expected a finite number")
        return Fraction(0)
    return Fraction(number)


def _head(
    sequence: Sequence, channels: Channels, clock: Clock, line: int, cells: list[str]
) -> tuple[Fraction, list[str | None]]:
    """Seconds per unit of the first column, and the input of each further one."""
    path, units = sequence.path, _units(clock)
    if cells[0] not in units:
        raise ProjectFileError(
            path, line, cells[0], f"the first column must be one of {', '.join(units)}"
        )
    doubled = [name for name in cells if cells.count(name) > 1]
    if doubled:
        raise ProjectFileError(path, line, doubled[0], "the column is defined twice; remove one")
    channels.require(path, line, set(cells[1:]))
    return units[cells[0]], [channels.input_of(path, line, name) for name in cells[1:]]


def read(sequence: Sequence, channels: Channels) -> None:
    """Fill `sequence`; raises `ProjectFileError` with the line."""
    path = sequence.path
    rows = _rows(path)
    line, head = next(rows, (1, [""]))
    unit, inputs = _head(sequence, channels, sequence.clock, line, head)
    for line, cells in rows:
        if len(cells) != len(head):
            raise ProjectFileError(
                path, line, "", f"{len(cells)} cells; the head has {len(head)} columns"
            )
        instant = _number(path, line, head[0], cells[0]) * unit
        if instant < 0:
            raise ProjectFileError(path, line, head[0], f"is {cells[0]}; expected at least 0")
        sequence.at(line, instant)
        for name, column, cell in zip(inputs, head[1:], cells[1:], strict=True):
            if name is not None and cell:
                sequence.set(line, name, float(_number(path, line, column, cell)))
