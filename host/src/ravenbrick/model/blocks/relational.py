# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Comparisons, logic, minima, signs, rounding, products, and the merging of branches.

Truth is the number 1, falsehood 0; at an input everything but 0 is true.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Block, Inputs, choose

__all__ = [
    "Abs",
    "LogicalOperator",
    "Merge",
    "MinMax",
    "Product",
    "RelationalOperator",
    "RoundingFunction",
    "Sign",
]

_OPPOSITE = {"NAND": "AND", "NOR": "OR", "NXOR": "XOR", "NOT": "OR"}


def _check_choice(block: Block, what: str, given: str, allowed: Sequence[str]) -> None:
    if given not in allowed:
        raise ValueError(
            f"block '{block.name}': {what} must be one of {' '.join(allowed)}, not '{given}'"
        )


class _ManyPorts(Block):
    """A block with `ports` inputs."""

    ports: int

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """All alike."""
        return (self.data_type,) * self.ports

    def _check_ports(self, least: int) -> None:
        if self.ports < least:
            raise ValueError(f"block '{self.name}': at least {least} input ports, not {self.ports}")


@dataclass(frozen=True)
class RelationalOperator(Block):
    """1 where input 0 `operator` input 1 holds, else 0; operators are == ~= < <= > >=."""

    operator: str = ">="

    def __post_init__(self) -> None:
        _check_choice(self, "the operator", self.operator, ("==", "~=", "<", "<=", ">", ">="))

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """Both sides."""
        return (self.data_type,) * 2

    def output(self, inputs: Inputs) -> ir.Expression:
        """One test, two for (in)equality."""
        left, right = inputs
        yes, no = self._literal(1.0), self._literal(0.0)
        if self.operator == "==":
            return choose(left, "<", right, no, choose(left, ">", right, no, yes))
        if self.operator == "~=":
            return choose(left, "<", right, yes, choose(left, ">", right, yes, no))
        return choose(left, self.operator, right, yes, no)


@dataclass(frozen=True)
class LogicalOperator(_ManyPorts):
    """AND, OR, NAND, NOR, XOR, NXOR of all inputs, or NOT of the only one."""

    operator: str = "AND"
    ports: int = 2

    def __post_init__(self) -> None:
        _check_choice(self, "the operator", self.operator, ("AND", "OR", "XOR", *_OPPOSITE))
        self._check_ports(1)
        if self.operator == "NOT" and self.ports != 1:
            raise ValueError(f"block '{self.name}': NOT has one input, not {self.ports}")

    def _is_true(
        self, value: ir.Expression, yes: ir.Expression, no: ir.Expression
    ) -> ir.Expression:
        zero = self._literal(0.0)
        return choose(value, ">", zero, yes, choose(value, "<", zero, yes, no))

    def intermediates(self, inputs: Inputs) -> Assignments:
        """Whether the inputs so far make it true, input by input."""
        kind = _OPPOSITE.get(self.operator, self.operator)
        one, zero = self._literal(1.0), self._literal(0.0)
        found: list[tuple[ir.Slot, ir.Expression]] = []
        for port, value in enumerate(inputs):
            if not found:
                held = self._is_true(value, one, zero)
            else:
                last = ir.Read(found[-1][0])
                yes, no = {
                    "AND": (last, zero),
                    "OR": (one, last),
                    "XOR": (ir.Binary("-", one, last), last),
                }[kind]
                held = self._is_true(value, yes, no)
            found.append((self._local(f"to_{port}"), held))
        return tuple(found)

    def output(self, inputs: Inputs) -> ir.Expression:
        """What is found, or its opposite."""
        last = ir.Read(self._local(f"to_{self.ports - 1}"))
        return ir.Binary("-", self._literal(1.0), last) if self.operator in _OPPOSITE else last


@dataclass(frozen=True)
class MinMax(_ManyPorts):
    """The smallest ("min") or largest ("max") of the inputs."""

    function: str = "min"
    ports: int = 2

    def __post_init__(self) -> None:
        _check_choice(self, "the function", self.function, ("min", "max"))
        self._check_ports(2)

    def _better(self, one: ir.Expression, other: ir.Expression) -> ir.Expression:
        return choose(one, "<" if self.function == "min" else ">", other, one, other)

    def intermediates(self, inputs: Inputs) -> Assignments:
        """The result for the inputs so far; the last one is the output's."""
        found: list[tuple[ir.Slot, ir.Expression]] = []
        best = inputs[0]
        for port, value in enumerate(inputs[1:-1], 1):
            found.append((self._local(f"to_{port}"), self._better(best, value)))
            best = ir.Read(found[-1][0])
        return tuple(found)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The last test."""
        before = self._local(f"to_{self.ports - 2}")
        best = inputs[0] if self.ports == 2 else ir.Read(before)
        return self._better(best, inputs[-1])


@dataclass(frozen=True)
class Abs(Block):
    """The input's size."""

    def output(self, inputs: Inputs) -> ir.Expression:
        """One test."""
        zero = self._literal(0.0)
        return choose(inputs[0], "<", zero, ir.Binary("-", zero, inputs[0]), inputs[0])


@dataclass(frozen=True)
class Sign(Block):
    """1, 0 or -1."""

    def output(self, inputs: Inputs) -> ir.Expression:
        """Two tests."""
        zero, one = self._literal(0.0), self._literal(1.0)
        below = choose(inputs[0], "<", zero, self._literal(-1.0), zero)
        return choose(inputs[0], ">", zero, one, below)


@dataclass(frozen=True)
class RoundingFunction(Block):
    """A whole number near the input: "floor", "ceil", "round" (halves away from 0) or "fix"."""

    function: str = "floor"

    def __post_init__(self) -> None:
        _check_choice(self, "the function", self.function, ("floor", "ceil", "round", "fix"))

    def intermediates(self, inputs: Inputs) -> Assignments:
        """The nearest whole number."""
        return ((self._local("nearest"), ir.Rounded(inputs[0])),)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The nearest whole number or its neighbour."""
        value, near = inputs[0], ir.Read(self._local("nearest"))
        one, zero = self._literal(1.0), self._literal(0.0)
        floor = choose(near, ">", value, ir.Binary("-", near, one), near)
        ceil = choose(near, "<", value, ir.Binary("+", near, one), near)
        fix = choose(value, "<", zero, ceil, floor)
        found: dict[str, ir.Expression] = {"floor": floor, "ceil": ceil, "round": near, "fix": fix}
        return found[self.function]


@dataclass(frozen=True)
class Product(Block):
    """Inputs multiplied or divided from left to right; `operators` such as '**/', first a '*'."""

    operators: str = "**"

    def __post_init__(self) -> None:
        if len(self.operators) < 2 or set(self.operators) - set("*/") or self.operators[0] == "/":
            raise ValueError(
                f"block '{self.name}': the operators must be two or more of * and /, the first "
                f"a *, not '{self.operators}'; divide a Constant for a reciprocal"
            )

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """One per operator."""
        return (self.data_type,) * len(self.operators)

    def output(self, inputs: Inputs) -> ir.Expression:
        """Each operation rounded."""
        total = inputs[0]
        for operator, value in zip(self.operators[1:], inputs[1:], strict=True):
            if operator == "*":
                total = ir.Binary("*", total, value)
            else:
                name = f"quotient_{self.data_type.value.removesuffix('_T')}"
                total = ir.Call(name, ("a", "b"), (total, value), self.data_type,
                             "return a / b;", "return A / B;", _quotient)  # fmt: skip
        return total


def _quotient(a: Any, b: Any) -> Any:
    """As IEEE 754 has it, also of Python's own floats, which refuse a division by 0."""
    if b == 0.0 and isinstance(a, float):
        with np.errstate(all="ignore"):
            return float(np.float64(a) / np.float64(b))
    return a / b


@dataclass(frozen=True)
class Merge(_ManyPorts):
    """The value whose condition is true, else the last output; inputs are pairs.

    Inputs 0, 2, 4, ... are conditions (1 or 0), 1, 3, 5, ... their values; the first true one
    counts. With one pair it is the output of a subsystem that holds it while it rests.
    """

    ports: int = 2
    initial: float = 0.0

    def __post_init__(self) -> None:
        self._check_ports(2)
        if self.ports % 2:
            raise ValueError(f"block '{self.name}': inputs are pairs of condition and value")

    def states(self) -> tuple[ir.Slot, ...]:
        """The last output."""
        return (self._state("DSTATE", self.initial),)

    def intermediates(self, inputs: Inputs) -> Assignments:
        """From the last pair to the second."""
        found: list[tuple[ir.Slot, ir.Expression]] = []
        for port in range(self.ports - 2, 0, -2):
            found.append((self._local(f"from_{port}"), self._pair(inputs, port)))
        return tuple(found)

    def _pair(self, inputs: Inputs, port: int) -> ir.Expression:
        last = port + 2 == self.ports
        rest = self.states()[0] if last else self._local(f"from_{port + 2}")
        half = self._literal(0.5)
        return choose(inputs[port], ">=", half, inputs[port + 1], ir.Read(rest))

    def output(self, inputs: Inputs) -> ir.Expression:
        """The first pair."""
        return self._pair(inputs, 0)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """Store the output."""
        return ((self.states()[0], output),)
