# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Statements whose choices are held, so that a solver sees a smooth function between two events."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from ravenbrick.model import program as ir
from ravenbrick.model.simulation.python_text import Memory, PythonText, look_up, place_of, whole

__all__ = ["Decisions", "read_by"]

_TOLERANCE = 1e-10  # of a difference, relative to the greater side and at least absolute


class _DecidedText(PythonText):
    """Text in which each choice is numbered; `verb` says what is done with it.

    "find" makes the choices, "hold" repeats those that were found, "measure" also takes the
    distance to the change of each.
    """

    def __init__(self, kept: Iterable[ir.Slot], verb: str, decisions: _Found) -> None:
        super().__init__(kept, float)
        self._verb, self._decisions = verb, decisions
        self.blocks: list[str] = []
        self.deciding: list[bool] = []
        self._block = ""
        for kind in ("test", "clamp", "whole", "table"):
            name = f"{verb}_{kind}"
            self.bind(name, getattr(decisions, name))
        self.bind("held", decisions.held)

    def instructions(self, instructions: Iterable[ir.Instruction]) -> None:
        """Lines that do the same; each choice belongs to the block of its statement."""
        for one in instructions:
            self.begin(one)
            super().instructions((one,))

    def begin(self, one: ir.Instruction) -> None:
        """What follows belongs to a statement; `deciding` tells of each whether it has a choice."""
        self._block = one.block
        self.deciding.append(False)

    def skip(self, one: ir.Statement) -> None:
        """Only number its choices."""
        lines = len(self._lines)
        self.instructions((one,))
        del self._lines[lines:]

    def _number(self) -> int:
        self.blocks.append(self._block)
        self.deciding[-1] = True
        return len(self.blocks) - 1

    def comparison(self, left: str, operator: str, right: str) -> str:
        """A test with a number."""
        number = self._number()
        if self._verb == "find":
            return f"find_test({number}, {left} {operator} {right})"
        if self._verb == "hold":
            return f"held[{number}]"
        return f"measure_test({number}, {operator in ('>', '>=')}, {left}, {right})"

    def clamp(self, value: str, limit: str) -> str:
        """A limit with a number."""
        return f"{self._verb}_clamp({self._number()}, {value}, {limit})"

    def rounded(self, value: str) -> str:
        """A whole number that is kept."""
        return f"{self._verb}_whole({self._number()}, {value})"

    def table(self, numbers: str, value: str, count: int) -> str:
        """A line of the table that is kept."""
        return f"{self._verb}_table({self._number()}, {numbers}, {value})"


class _Found:
    """What was decided, by number, and the smallest distance to a change."""

    def __init__(self) -> None:
        self.held: list[Any] = []
        self.least = 1.0
        self.nearest = -1

    def _gap(self, number: int, distance: float, *sides: float) -> None:
        tolerance = _TOLERANCE * max(1.0, *map(abs, sides))
        if distance + tolerance < self.least:
            self.least, self.nearest = distance + tolerance, number

    def find_test(self, number: int, yes: bool) -> bool:
        self.held[number] = yes
        return yes

    def hold_test(self, number: int) -> Any:
        return self.held[number]

    def measure_test(self, number: int, above: bool, left: float, right: float) -> Any:
        found = self.held[number]
        sign = 1.0 if found == above else -1.0
        self._gap(number, sign * (left - right), left, right)
        return found

    def find_clamp(self, number: int, value: float, limit: float) -> float:
        self.held[number] = (value > limit) - (value < -limit)
        return self.hold_clamp(number, value, limit)

    def hold_clamp(self, number: int, value: float, limit: float) -> float:
        side = self.held[number]
        return side * limit if side else value

    def measure_clamp(self, number: int, value: float, limit: float) -> float:
        side = self.held[number]
        inside = limit - abs(value)
        self._gap(number, side * value - limit if side else inside, value, limit)
        return self.hold_clamp(number, value, limit)

    def find_whole(self, number: int, value: float) -> float:
        self.held[number] = whole(value)
        return float(self.held[number])

    def hold_whole(self, number: int, value: float) -> Any:
        return self.held[number]

    def measure_whole(self, number: int, value: float) -> Any:
        self._gap(number, 0.5 - abs(value - self.held[number]), value)
        return self.held[number]

    def find_table(self, number: int, numbers: tuple[Sequence[float], ...], value: float) -> Any:
        self.held[number] = place_of(numbers[0], value)
        return self.hold_table(number, numbers, value)

    def hold_table(self, number: int, numbers: tuple[Sequence[float], ...], value: float) -> Any:
        return look_up(numbers, self.held[number], value)

    def measure_table(self, number: int, numbers: tuple[Sequence[float], ...], value: float) -> Any:
        points, index = numbers[0], self.held[number]
        if index:
            self._gap(number, value - points[index], value, points[index])
        if index + 1 < len(points):
            self._gap(number, points[index + 1] - value, value, points[index + 1])
        return self.hold_table(number, numbers, value)


def read_by(whole: Sequence[ir.Statement], wanted: Sequence[bool]) -> list[bool]:
    """Which statements are wanted, or compute what wanted ones behind them read."""
    read: set[tuple[ir.Kind, str]] = set()
    found = []
    for one, own in zip(reversed(whole), reversed(wanted), strict=True):
        needed = own or (one.target.kind, one.target.name) in read
        found.append(needed)
        if needed:
            nodes = ir.nodes(one.expression)
            read |= {(n.slot.kind, n.slot.name) for n in nodes if isinstance(n, ir.Read)}
    return found[::-1]


class Decisions:
    """Statements and derivatives as functions of (memory, input values).

    `find` decides and gives the values of `shown`; until the next `find` the others keep to these
    decisions: `values` gives those of `shown`, `slopes` the derivatives. `kept` are the variables
    in the memory.
    """

    def __init__(
        self, kept: Sequence[ir.Slot], inputs: Sequence[ir.Slot],
        statements: Sequence[ir.Statement], derivatives: Sequence[ir.Statement],
        shown: Sequence[ir.Slot],
    ) -> None:  # fmt: skip
        self._found = _Found()

        def made(
            verb: str, needed: Sequence[bool], results: Sequence[ir.Slot] | None
        ) -> tuple[_DecidedText, Callable[..., tuple[Any, ...]]]:
            text = _DecidedText(kept, verb, self._found)
            for one, wanted in zip(statements, needed, strict=False):
                if wanted:
                    text.instructions((one,))
                else:
                    text.skip(one)
            slopes = []
            for one, wanted in zip(derivatives, needed[len(statements) :], strict=True):
                text.begin(one)
                slope = text.expression(one.expression)
                slopes += [slope] if wanted else []
            if results is None:
                return text, text.function(inputs, slopes, keeps=False)
            text.line(f"({''.join(f'{one}, ' for one in slopes)})")
            return text, text.function(inputs, [*map(text.name, results)], keeps=False)

        whole = [*statements, *derivatives]
        every = [True] * len(whole)
        text, self._find = made("find", every, shown)
        self._blocks = text.blocks
        self._found.held += [None] * len(self._blocks)
        self._values = made("hold", every, shown)[1]
        moving = [place >= len(statements) for place in range(len(whole))]
        self._slopes = made("hold", read_by(whole, moving), None)[1]
        self._measure = made("measure", read_by(whole, text.deciding), ())[1]

    def find(self, memory: Memory, given: Sequence[float]) -> tuple[Any, ...]:
        """Decide anew."""
        return self._find(memory, given, None)

    def values(self, memory: Memory, given: Sequence[float]) -> tuple[Any, ...]:
        """The values of `shown` with the decisions as they are."""
        return self._values(memory, given, None)

    def slopes(self, memory: Memory, given: Sequence[float]) -> tuple[Any, ...]:
        """The derivatives with the decisions as they are."""
        return self._slopes(memory, given, None)

    def distance(self, memory: Memory, given: Sequence[float]) -> float:
        """To the nearest change of a decision; negative beyond it."""
        self._found.least, self._found.nearest = 1.0, -1
        self._measure(memory, given, None)
        return self._found.least

    @property
    def any(self) -> bool:
        """Whether there is anything to decide."""
        return bool(self._blocks)

    @property
    def nearest(self) -> str:
        """The block of the decision that the last `distance` was taken to."""
        return self._blocks[self._found.nearest] if self._found.nearest >= 0 else ""
