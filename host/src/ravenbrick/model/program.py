# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs without loops: what a block diagram means, operation by operation.

A diagram is lowered once to a `Program`. The simulation executes it, the code generator prints it,
`linearise` propagates affine forms through it: one order of operations, one rounding after each.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np

from ravenbrick.model.number_format import Enumeration, FixedFormat, Rounding

__all__ = [
    "Binary",
    "Bounded",
    "Call",
    "Case",
    "Cast",
    "Clamp",
    "Comparison",
    "DataType",
    "DelayLine",
    "Expression",
    "If",
    "Instruction",
    "Kind",
    "Literal",
    "NumberFormat",
    "Program",
    "Read",
    "Rescale",
    "Restart",
    "Rounded",
    "Select",
    "Slot",
    "Statement",
    "Table",
    "as_choices",
    "children",
    "expression_type",
    "expressions",
    "is_fixed_point",
    "is_wide",
    "limits_as_choices",
    "mapped",
    "nodes",
    "read_elsewhere",
    "rebuilt",
    "statements",
    "with_constants",
]


class DataType(Enum):
    """Number formats of signals; the value is the C type name."""

    REAL32 = "real32_T"
    REAL64 = "real64_T"

    @property
    def scalar(self) -> type[np.floating]:
        """The numpy scalar type with the same IEEE 754 format."""
        return np.float32 if self is DataType.REAL32 else np.float64

    @property
    def size_bytes(self) -> int:
        """Size of one value in memory."""
        return 4 if self is DataType.REAL32 else 8


NumberFormat = DataType | FixedFormat | Enumeration


class Kind(Enum):
    """Where a value lives."""

    INPUT = "input"
    OUTPUT = "output"
    SIGNAL = "signal"
    STATE = "state"
    PARAMETER = "parameter"


@dataclass(frozen=True)
class Slot:
    """A named variable of the program; `initial` is used by states and parameters only."""

    kind: Kind
    name: str
    data_type: NumberFormat
    block: str
    initial: float = 0.0
    unit: str = ""
    description: str = ""


@dataclass(frozen=True)
class DelayLine(Slot):
    """A state that holds the last `length` samples.

    Reading it gives the oldest sample; assigning to it drops that one and adds the newest.
    """

    length: int = 1


@dataclass(frozen=True)
class Literal:
    """A constant, rounded to `data_type`; of a fixed-point format it is the raw value."""

    value: float
    data_type: NumberFormat


@dataclass(frozen=True)
class Read:
    """The present value of a variable."""

    slot: Slot


@dataclass(frozen=True)
class Binary:
    """`left operator right` with one rounding; operator is one of + - *."""

    operator: str
    left: Expression
    right: Expression


@dataclass(frozen=True)
class Clamp:
    """`value` limited to [-limit, limit]; a NaN passes.

    Stands at the top of a statement, and in fixed point also where it gets another format.
    """

    value: Expression
    limit: Expression


@dataclass(frozen=True)
class Cast:
    """Conversion to another format, rounded to nearest even; of integers to 64 bits."""

    value: Expression
    data_type: NumberFormat


@dataclass(frozen=True)
class Comparison:
    """`left operator right`; operator is one of < <= > >=. A condition, not a number."""

    operator: str
    left: Expression
    right: Expression


@dataclass(frozen=True)
class Select:
    """`chosen` if the condition holds, else `otherwise`."""

    condition: Comparison
    chosen: Expression
    otherwise: Expression


@dataclass(frozen=True)
class Rounded:
    """The nearest whole number, halves away from zero, exactly; NaN and large values pass."""

    value: Expression


@dataclass(frozen=True)
class Table:
    """`values[i] + slopes[i] * (value - breakpoints[i])`, i the last with breakpoint <= value.

    Before the first breakpoint i is 0. `name` is that of the arrays in the C.
    """

    value: Expression
    name: str
    breakpoints: tuple[float, ...]
    values: tuple[float, ...]
    slopes: tuple[float, ...]


@dataclass(frozen=True)
class Rescale:
    """A fixed-point value divided by 2**bits and rounded."""

    value: Expression
    bits: int
    rounding: Rounding


@dataclass(frozen=True)
class Bounded:
    """A fixed-point value limited to [low, high], raw. Stands only at the top of a statement."""

    value: Expression
    low: int
    high: int


@dataclass(frozen=True)
class Call:
    """A function written by the user: `function` in Python, `c` and `ada` the same as bodies.

    `name` is that of the function in the generated text, `parameters` those of its arguments.
    """

    name: str
    parameters: tuple[str, ...]
    arguments: tuple[Expression, ...]
    data_type: DataType
    c: str
    ada: str
    function: Callable[..., float] = field(repr=False, compare=False)


Expression = (
    Literal | Read | Binary | Clamp | Cast | Select | Rounded | Table | Rescale | Bounded | Call
)


@dataclass(frozen=True)
class Statement:
    """`target := expression`; `block` and `block_type` say where it comes from."""

    target: Slot
    expression: Expression
    block: str
    block_type: str


@dataclass(frozen=True)
class Restart:
    """The states get their initial values."""

    states: tuple[Slot, ...]
    block: str
    block_type: str


@dataclass(frozen=True)
class If:
    """`body` if all conditions hold, else `otherwise`.

    A signal that is assigned in one of both only is read there only.
    """

    conditions: tuple[Comparison, ...]
    body: tuple[Instruction, ...]
    otherwise: tuple[Instruction, ...]
    block: str
    block_type: str


@dataclass(frozen=True)
class Case:
    """The branch of the selector's value, one per member of its enumeration."""

    selector: Slot
    branches: tuple[tuple[Instruction, ...], ...]
    block: str
    block_type: str


Instruction = Statement | Restart | If | Case


@dataclass(frozen=True)
class Program:
    """One step of a diagram: `statements` in order, outputs first, then the states' updates."""

    name: str
    sample_time: float
    inputs: tuple[Slot, ...]
    outputs: tuple[Slot, ...]
    parameters: tuple[Slot, ...]
    states: tuple[Slot, ...]
    signals: tuple[Slot, ...]
    statements: tuple[Instruction, ...]


def is_fixed_point(program: Program) -> bool:
    """Whether the program computes with integers."""
    return any(isinstance(slot.data_type, FixedFormat) for slot in program.inputs + program.outputs)


def with_constants(program: Program) -> Program:
    """The same program with its parameters' present values as literals."""
    return replace(program, parameters=(), statements=mapped(program.statements, _constant))


def statements(instructions: Iterable[Instruction]) -> Iterator[Statement]:
    """All assignments, with those inside of conditions, in order."""
    for one in instructions:
        match one:
            case Statement():
                yield one
            case If(body=body, otherwise=otherwise):
                yield from statements((*body, *otherwise))
            case Case(branches=branches):
                for branch in branches:
                    yield from statements(branch)


def expressions(program: Program) -> Iterator[Expression]:
    """All expressions of a program with those inside them, in order."""
    for outermost in _outermost(program.statements):
        yield from nodes(outermost)


def nodes(expression: Expression) -> Iterator[Expression]:
    """An expression and all inside it, in order."""
    waiting = [expression]
    while waiting:
        node = waiting.pop()
        yield node
        waiting.extend(reversed(children(node)))


def _outermost(instructions: Iterable[Instruction]) -> Iterator[Expression]:
    for one in instructions:
        match one:
            case Statement(expression=expression):
                yield expression
            case If(conditions=conditions, body=body, otherwise=otherwise):
                yield from (side for test in conditions for side in (test.left, test.right))
                yield from _outermost((*body, *otherwise))
            case Case(branches=branches):
                for branch in branches:
                    yield from _outermost(branch)


def read_elsewhere(program: Program) -> set[Slot]:
    """Signals that are assigned under one condition and read under another."""
    assigned: dict[Slot, int] = {}
    found: set[Slot] = set()
    for place, one in enumerate(program.statements):
        own = replace(program, statements=(one,))
        read = {node.slot for node in expressions(own) if isinstance(node, Read)}
        found |= {slot for slot in read if assigned.get(slot, place) != place}
        if isinstance(one, If):
            assigned |= {statement.target: place for statement in statements((one,))}
    return {slot for slot in found if slot.kind is Kind.SIGNAL}


def mapped(
    instructions: Iterable[Instruction], change: Callable[[Expression], Expression]
) -> tuple[Instruction, ...]:
    """The same instructions with other expressions, those of conditions included."""
    found: list[Instruction] = []
    for one in instructions:
        match one:
            case Statement(expression=expression):
                found.append(replace(one, expression=change(expression)))
            case Restart():
                found.append(one)
            case If(conditions=conditions, body=body, otherwise=otherwise):
                tests = tuple(
                    Comparison(test.operator, change(test.left), change(test.right))
                    for test in conditions
                )
                inner = mapped(body, change), mapped(otherwise, change)
                found.append(replace(one, conditions=tests, body=inner[0], otherwise=inner[1]))
            case Case(branches=branches):
                found.append(replace(one, branches=tuple(mapped(b, change) for b in branches)))
    return tuple(found)


def _constant(expression: Expression) -> Expression:
    match expression:
        case Read(slot=slot) if slot.kind is Kind.PARAMETER:
            return Literal(slot.initial, slot.data_type)
        case _:
            return rebuilt(expression, _constant)


def rebuilt(expression: Expression, change: Callable[[Expression], Expression]) -> Expression:
    """The same expression with each of those directly inside it changed."""
    match expression:
        case Literal() | Read():
            return expression
        case Binary(left=left, right=right):
            return replace(expression, left=change(left), right=change(right))
        case Clamp(value=value, limit=limit):
            return Clamp(change(value), change(limit))
        case Select(condition=condition, chosen=chosen, otherwise=otherwise):
            test = Comparison(condition.operator, change(condition.left), change(condition.right))
            return Select(test, change(chosen), change(otherwise))
        case Call(arguments=arguments):
            return replace(expression, arguments=tuple(map(change, arguments)))
        case _:
            return replace(expression, value=change(expression.value))


def is_wide(expression: Expression) -> bool:
    """Whether a fixed-point expression is computed in 64 bits."""
    form = expression_type(expression)
    return isinstance(form, FixedFormat) and form.width == 64


def expression_type(expression: Expression) -> NumberFormat:
    """The format of an expression's result."""
    match expression:
        case Literal(data_type=data_type) | Cast(data_type=data_type) | Call(data_type=data_type):
            return data_type
        case Read(slot=slot):
            return slot.data_type
        case Binary(left=left):
            return expression_type(left)
        case Select(chosen=chosen):
            return expression_type(chosen)
        case _:
            return expression_type(expression.value)


def limits_as_choices(clamp: Clamp) -> Expression:
    """The same limits, chosen by comparisons."""
    value, high = clamp.value, clamp.limit
    low: Expression = Binary("-", Literal(0, expression_type(clamp)), high)
    if isinstance(high, Literal):
        low = Literal(-high.value, high.data_type)
    below = Select(Comparison("<", value, low), low, value)
    return Select(Comparison(">", value, high), high, below)


def as_choices(table: Table) -> Expression:
    """The same lines as a table, chosen by comparisons; the last goes on."""
    form = expression_type(table)

    def line(index: int) -> Expression:
        point, level = table.breakpoints[index], Literal(table.values[index], form)
        if not table.slopes[index]:
            return level
        run = Binary("-", table.value, Literal(point, form)) if point else table.value
        return Binary("+", Binary("*", Literal(table.slopes[index], form), run), level)

    chosen = line(0)
    for index in range(1, len(table.breakpoints) - 1):
        reached = Comparison(">=", table.value, Literal(table.breakpoints[index], form))
        chosen = Select(reached, line(index), chosen)
    return chosen


def children(expression: Expression) -> tuple[Expression, ...]:
    """The expressions directly inside an expression."""
    match expression:
        case Literal() | Read():
            return ()
        case Call(arguments=arguments):
            return arguments
        case Binary(left=left, right=right):
            return left, right
        case Clamp(value=value, limit=limit):
            return value, limit
        case Select(condition=condition, chosen=chosen, otherwise=otherwise):
            return condition.left, condition.right, chosen, otherwise
        case _:
            return (expression.value,)
