# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Expressions and statements of a program as C text, operation for operation."""

from __future__ import annotations

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model.program import (
    Binary,
    Cast,
    Clamp,
    DataType,
    Expression,
    Kind,
    Literal,
    Program,
    Read,
    Slot,
    Statement,
)

__all__ = ["C_KEYWORDS", "c_literal", "c_statement", "c_variable"]

C_KEYWORDS = frozenset(
    """auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while work u y""".split()
)


def c_literal(value: float, data_type: DataType) -> str:
    """The shortest decimal text that reads back as the same number of the format."""
    number = data_type.scalar(value)
    if not np.isfinite(number):
        raise DesignError(f"the constant {value} is not finite in {data_type.value}")
    text = np.format_float_positional(number, unique=True, trim="0")
    if len(text) > 17:
        text = np.format_float_scientific(number, unique=True, trim="0")
    return f"{text}F" if data_type is DataType.REAL32 else text


def c_variable(program: Program, slot: Slot) -> str:
    """How the step function names a variable."""
    match slot.kind:
        case Kind.INPUT:
            return f"u->{slot.name}"
        case Kind.OUTPUT:
            return f"y->{slot.name}"
        case Kind.STATE:
            return f"work->{slot.name}"
        case Kind.PARAMETER:
            return f"{program.name}_P.{slot.name}"
        case Kind.SIGNAL:
            return slot.name


def _c_expression(program: Program, expression: Expression, *, nested: bool = False) -> str:
    match expression:
        case Read(slot=slot):
            return c_variable(program, slot)
        case Literal(value=value, data_type=data_type):
            text = c_literal(value, data_type)
            return f"({text})" if text.startswith("-") else text
        case Cast(value=value, data_type=data_type):
            return f"({data_type.value})({_c_expression(program, value)})"
        case Binary(operator=operator, left=left, right=right):
            first = _c_expression(program, left, nested=True)
            second = _c_expression(program, right, nested=True)
            text = f"{first} {operator} {second}"
            return f"({text})" if nested else text
        case Clamp():
            raise DesignError("a limit inside an expression cannot become C; give it its own block")


def c_statement(program: Program, statement: Statement) -> list[str]:
    """Lines of C, without indentation, that do what the statement does."""
    target = c_variable(program, statement.target)
    expression = statement.expression
    if not isinstance(expression, Clamp):
        return [f"{target} = {_c_expression(program, expression)};"]
    value = _c_expression(program, expression.value, nested=True)
    limit = _c_expression(program, expression.limit, nested=True)
    return [
        f"if ({value} > {limit}) {{",
        f"  {target} = {limit};",
        f"}} else if ({value} < -{limit}) {{",
        f"  {target} = -{limit};",
        "} else {",
        f"  {target} = {value};",
        "}",
    ]
