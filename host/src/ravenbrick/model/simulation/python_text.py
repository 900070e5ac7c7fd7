# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program as the source of a Python function, which runs many times faster than a tree walk."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from ravenbrick.model import program as ir
from ravenbrick.model.number_format import FixedFormat

__all__ = ["Memory", "PythonText", "look_up", "place_of", "whole"]

Key = tuple[ir.Kind, str]
Memory = list[Any]
"""Values that outlive a step, in the order of `PythonText.kept`."""

_DEEPEST = 40  # nested expressions in one line; Python's parser ends at 200 parentheses
_INDENT = "    "


class PythonText:
    """Statements of a program as lines of Python, and the constants that they refer to.

    Each operation rounds as IEEE 754 says in the format of the program. `real64` makes numbers in
    double precision: NumPy's, or Python's own floats, which are quicker and have the same bits.
    """

    def __init__(self, kept: Iterable[ir.Slot], real64: Callable[[float], Any]) -> None:
        self.kept = {_key(slot): place for place, slot in enumerate(kept)}
        self._real64 = real64
        self._names: dict[Key, str] = {}
        self._constants: dict[tuple[str, str], str] = {}
        self._namespace: dict[str, Any] = {
            "checked": _checked, "clamp": _clamp, "whole": whole, "table": _table,
            "bounded": _bounded,
        }  # fmt: skip
        self._lines: list[str] = []
        self._level = 1
        self._assigned: set[Key] = set()

    def scalar(self, data_type: ir.NumberFormat) -> Callable[[float], Any]:
        """What makes a number of a format."""
        return self._real64 if data_type is ir.DataType.REAL64 else data_type.scalar

    def instructions(self, instructions: Iterable[ir.Instruction]) -> None:
        """Lines that do the same."""
        for one in instructions:
            match one:
                case ir.Statement(target=target, expression=expression):
                    text = self.expression(expression)
                    if isinstance(target, ir.DelayLine):
                        place = self.kept[_key(target)]
                        self.line(f"lines[{place}].append({text})")
                        text = f"lines[{place}].popleft()"
                    self._assigned.add(_key(target))
                    self.line(f"{self.name(target)} = {text}")
                case ir.If(conditions=conditions, body=body, otherwise=otherwise):
                    tests = [self._test(test) for test in conditions]
                    self._branch(f"if {' and '.join(tests)}:", body)
                    if otherwise:
                        self._branch("else:", otherwise)
                case ir.Case(selector=selector, branches=branches):
                    chosen = self.name(selector)
                    for place, branch in enumerate(branches):
                        self._branch(f"{'el' if place else ''}if {chosen} == {place}:", branch)
                case ir.Restart(states=states):
                    for slot in states:
                        self._restart(slot)

    def _branch(self, head: str, body: Sequence[ir.Instruction]) -> None:
        self.line(head)
        self._level += 1
        self.instructions(body)
        self.line("pass")
        self._level -= 1

    def _restart(self, slot: ir.Slot) -> None:
        first = self.constant(slot.initial, slot.data_type)
        self._assigned.add(_key(slot))
        self.line(f"{self.name(slot)} = {first}")
        if isinstance(slot, ir.DelayLine):
            place = self.kept[_key(slot)]
            self.line(f"lines[{place}].extend([{first}] * {slot.length - 1})")
            self.line(f"for _ in range({slot.length - 1}): lines[{place}].popleft()")

    def function(
        self,
        inputs: Sequence[ir.Slot],
        results: Sequence[str],
        *,
        keeps: bool = True,
        repeats: bool = False,
    ) -> Callable[..., Any]:
        """A function of (memory, input values, delay lines by place) that gives the results.

        Unless it `keeps`, the memory stays as it is. If it `repeats`, it also takes a number of
        steps, in which the inputs stay, and gives a list of the results of each.
        """
        head = [f"{self._names[_key(s)]} = given[{n}]" for n, s in enumerate(inputs)
                if _key(s) in self._names]  # fmt: skip
        head += [f"{self._names[key]} = memory[{place}]" for key, place in self.kept.items()
                 if key in self._names]  # fmt: skip
        body, answer = self._lines, f"({''.join(f'{one}, ' for one in results)})"
        if repeats:
            head += ["found = []", "for _ in range(steps):"]
            body = [*(_INDENT + one for one in body), f"{2 * _INDENT}found.append({answer})"]
            answer = "found"
        tail = [f"memory[{place}] = {self._names[key]}" for key, place in self.kept.items()
                if keeps and key in self._assigned]  # fmt: skip
        lines = [*(_INDENT + one for one in head), *body,
                 *(_INDENT + one for one in (*tail, f"return {answer}"))]  # fmt: skip
        source = "\n".join(["def run(memory, given, lines, steps=1):", *lines])
        exec(compile(source, "<diagram>", "exec"), self._namespace)  # own text
        found: Callable[..., Any] = self._namespace["run"]
        return found

    def bind(self, name: str, value: Any) -> None:
        """Give the text something by name."""
        self._namespace[name] = value

    def line(self, text: str) -> None:
        """Add a line."""
        self._lines.append(_INDENT * self._level + text)

    def name(self, slot: ir.Slot) -> str:
        """The local variable of a slot."""
        return self._names.setdefault(_key(slot), f"v{len(self._names)}")

    def constant(self, value: float, data_type: ir.NumberFormat) -> str:
        """The name of a number of a format."""
        known = (repr(value), repr(data_type))
        if known not in self._constants:
            self._constants[known] = f"k{len(self._constants)}"
            self._namespace[self._constants[known]] = self.scalar(data_type)(value)
        return self._constants[known]

    def shared(self, value: Any) -> str:
        """The name of an object."""
        name = f"o{len(self._namespace)}"
        self._namespace[name] = value
        return name

    def expression(self, node: ir.Expression, depth: int = 0) -> str:
        """Text of an expression; of a deep one the inner part stands in lines before."""
        if depth > _DEEPEST:
            name = f"d{len(self._lines)}"
            self.line(f"{name} = {self.expression(node)}")
            return name
        below = depth + 1
        match node:
            case ir.Read(slot=slot):
                return self.name(slot)
            case ir.Literal(value=value, data_type=data_type):
                return self.constant(value, data_type)
            case ir.Binary():
                return self._binary(node, below)
            case ir.Select(condition=condition, chosen=chosen, otherwise=otherwise):
                sides = self.expression(chosen, below), self.expression(otherwise, below)
                return f"({sides[0]} if {self._test(condition, below)} else {sides[1]})"
            case ir.Clamp(value=value, limit=limit):
                return self.clamp(self.expression(value, below), self.expression(limit, below))
            case ir.Cast(value=value, data_type=data_type):
                made = self.shared(self.scalar(data_type))
                return f"{made}({self.expression(value, below)})"
            case ir.Call(arguments=arguments, data_type=data_type, function=function):
                given = ", ".join(self.expression(one, below) for one in arguments)
                made = self.shared(self.scalar(data_type))
                return f"{made}({self.shared(function)}({given}))"
            case ir.Rounded(value=value):
                return self.rounded(self.expression(value, below))
            case ir.Table(value=value):
                return self._look_up(node, self.expression(value, below))
            case ir.Rescale(value=value, bits=bits, rounding=rounding):
                divide = self.shared(rounding.divide)
                return f"{divide}({self.expression(value, below)}, {bits})"
            case ir.Bounded(value=value, low=low, high=high):
                return f"bounded({self.expression(value, below)}, {low}, {high})"

    def _binary(self, node: ir.Binary, depth: int) -> str:
        left, right = self.expression(node.left, depth), self.expression(node.right, depth)
        text = f"({left} {node.operator} {right})"
        if isinstance(ir.expression_type(node), FixedFormat):
            return f"checked{text[:-1]}, {64 if ir.is_wide(node) else 32})"
        return text

    def _test(self, test: ir.Comparison, depth: int = 0) -> str:
        left, right = self.expression(test.left, depth), self.expression(test.right, depth)
        return self.comparison(left, test.operator, right)

    def _look_up(self, node: ir.Table, value: str) -> str:
        made = self.scalar(ir.expression_type(node))
        parts = (node.breakpoints, node.values, node.slopes)
        numbers = tuple(tuple(map(made, part)) for part in parts)
        return self.table(self.shared(numbers), value, len(node.breakpoints))

    def comparison(self, left: str, operator: str, right: str) -> str:
        """Text of a condition."""
        return f"{left} {operator} {right}"

    def clamp(self, value: str, limit: str) -> str:
        """Text of a value within [-limit, limit]."""
        return f"clamp({value}, {limit})"

    def rounded(self, value: str) -> str:
        """Text of the nearest whole number."""
        return f"whole({value})"

    def table(self, numbers: str, value: str, count: int) -> str:
        """Text of a look-up in the table called `numbers`."""
        return f"table({numbers}, {value})"


def _key(slot: ir.Slot) -> Key:
    return slot.kind, slot.name


def _checked(result: int, bits: int) -> int:
    if not -(2 ** (bits - 1)) <= result < 2 ** (bits - 1):
        raise OverflowError(f"{result} does not fit into {bits} bits")
    return result


def _clamp(value: Any, limit: Any) -> Any:
    if value > limit:
        return limit
    return -limit if value < -limit else value


def _bounded(value: int, low: int, high: int) -> int:
    return min(max(value, low), high)


def whole(value: Any) -> Any:
    """Nearest whole number, halves away from zero; as the C does it, by a cut and a test."""
    kind = type(value)
    if not abs(value) < 2 ** (23 if kind is np.float32 else 52):
        return value
    cut = kind(int(value))
    rest = value - cut
    if rest >= 0.5:
        return cut + kind(1.0)
    return cut - kind(1.0) if rest <= -0.5 else cut


def place_of(points: Sequence[Any], value: Any) -> int:
    """The last of the breakpoints that the value reaches, at least the first."""
    index = 0
    while index + 1 < len(points) and value >= points[index + 1]:
        index += 1
    return index


def look_up(numbers: tuple[Sequence[Any], ...], index: int, value: Any) -> Any:
    """The line that begins at a breakpoint."""
    points, values, slopes = numbers
    return values[index] + slopes[index] * (value - points[index])


def _table(numbers: tuple[Sequence[Any], ...], value: Any) -> Any:
    return look_up(numbers, place_of(numbers[0], value), value)
