# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Expressions and statements of a program as C text, operation for operation."""

from __future__ import annotations

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.number_format import FixedFormat, Rounding

__all__ = ["ACCUMULATOR", "C_KEYWORDS", "c_literal", "c_statement", "c_type", "format_suffix"]

C_KEYWORDS = frozenset(
    """auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while work u y""".split()
)
ACCUMULATOR = "accumulator"


def c_literal(value: float, data_type: ir.NumberFormat) -> str:
    """The shortest decimal text that reads back as the same number of the format.

    Of a fixed-point format the value is the raw one.
    """
    if isinstance(data_type, FixedFormat):
        return str(int(value))
    number = data_type.scalar(value)
    if not np.isfinite(number):
        raise DesignError(f"the constant {value} is not finite in {data_type.value}")
    text = np.format_float_positional(number, unique=True, trim="0")
    if len(text) > 17:
        text = np.format_float_scientific(number, unique=True, trim="0")
    return f"{text}F" if data_type is ir.DataType.REAL32 else text


def c_type(slot: ir.Slot) -> str:
    """The C type of a variable; local integers take a word, which the processor prefers."""
    if slot.kind is ir.Kind.SIGNAL and isinstance(slot.data_type, FixedFormat):
        return "int32_T"
    return slot.data_type.value


def c_variable(program: ir.Program, slot: ir.Slot) -> str:
    """How the step function names a variable."""
    match slot.kind:
        case ir.Kind.INPUT:
            return f"u->{slot.name}"
        case ir.Kind.OUTPUT:
            return f"y->{slot.name}"
        case ir.Kind.STATE:
            return f"work->{slot.name}"
        case ir.Kind.PARAMETER:
            return f"{program.name}_P.{slot.name}"
        case ir.Kind.SIGNAL:
            return slot.name


def format_suffix(expression: ir.Expression) -> str:
    """The last part of a helper's name: the expression's format, such as real32."""
    return ir.expression_type(expression).value.removesuffix("_T")


def _c_expression(program: ir.Program, expression: ir.Expression, *, nested: bool = False) -> str:
    match expression:
        case ir.Read(slot=slot):
            text = c_variable(program, slot)
            narrow = c_type(slot) == "int16_T"
            return f"(int32_T){text}" if nested and narrow else text
        case ir.Literal(value=value, data_type=data_type):
            text = c_literal(value, data_type)
            return f"({text})" if text.startswith("-") else text
        case ir.Cast(value=value, data_type=data_type):
            return f"({data_type.value})({_c_expression(program, value)})"
        case ir.Binary(
            operator="-", left=ir.Literal(value=0, data_type=FixedFormat()), right=right
        ):
            text = f"-{_c_expression(program, right, nested=True)}"
        case ir.Binary(operator=operator, left=left, right=right):
            text = _c_infix(program, operator, left, right)
        case ir.Select(condition=condition, chosen=chosen, otherwise=otherwise):
            test = _c_infix(program, condition.operator, condition.left, condition.right)
            first, second = (_c_branch(program, branch) for branch in (chosen, otherwise))
            text = f"({test}) ? {first} : {second}"
        case ir.Call(name=name, arguments=arguments):
            given = ", ".join(_c_expression(program, one) for one in arguments)
            return f"{program.name}_{name}({given})"
        case ir.Rounded(value=value):
            return f"{program.name}_nearest_{format_suffix(value)}({_c_expression(program, value)})"
        case ir.Table(value=value, name=name, breakpoints=breakpoints):
            arrays = f"{name}_breakpoints, {name}_values, {name}_slopes"
            inner = _c_expression(program, value)
            head = f"{program.name}_look_up_{format_suffix(value)}"
            return f"{head}({arrays}, {len(breakpoints)}U, {inner})"
        case ir.Rescale(value=value, bits=bits, rounding=Rounding.NEAREST):
            inner = _c_expression(program, value)
            return f"{program.name}_nearest_quotient({inner}, {1 << bits})"
        case ir.Rescale(value=value, bits=bits):
            text = f"{_c_expression(program, value, nested=True)} / {1 << bits}"
        case ir.Clamp() | ir.Bounded():
            raise DesignError("a limit inside an expression cannot become C; give it its own block")
    return f"({text})" if nested else text


def _c_branch(program: ir.Program, branch: ir.Expression) -> str:
    """One side of a choice; a small integer alone would have a narrower type than a variable."""
    text = _c_expression(program, branch, nested=True)
    whole = isinstance(branch, ir.Literal) and isinstance(branch.data_type, FixedFormat)
    return f"(int32_T){text}" if whole else text


def _c_infix(program: ir.Program, operator: str, left: ir.Expression, right: ir.Expression) -> str:
    first = _c_expression(program, left, nested=True)
    second = _c_expression(program, right, nested=True)
    return f"{first} {operator} {second}"


def c_statement(program: ir.Program, statement: ir.Statement) -> list[str]:
    """Lines of C, without indentation, that do what the statement does."""
    target = c_variable(program, statement.target)
    expression = statement.expression
    if isinstance(expression, ir.Bounded):
        return _c_bounded(program, statement, expression)
    if not isinstance(expression, ir.Clamp):
        return [f"{target} = {_c_assigned(program, expression, statement.target)};"]
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


def _c_assigned(program: ir.Program, expression: ir.Expression, target: ir.Slot) -> str:
    """The expression converted to the target's type; only integers need it."""
    text = _c_expression(program, expression)
    form = target.data_type
    if not isinstance(form, FixedFormat) or isinstance(expression, ir.Literal):
        return text
    given = c_type(expression.slot) if isinstance(expression, ir.Read) else "int32_T"
    if given == c_type(target):
        return text
    simple = isinstance(expression, ir.Read)
    return f"({c_type(target)}){text}" if simple else f"({c_type(target)})({text})"


def _c_bounded(program: ir.Program, statement: ir.Statement, bounded: ir.Bounded) -> list[str]:
    target = c_variable(program, statement.target)
    form = statement.target.data_type
    cast = f"({form.value})" if c_type(statement.target) == "int16_T" else ""
    return [
        f"{ACCUMULATOR} = {_c_expression(program, bounded.value)};",
        f"if ({ACCUMULATOR} > {bounded.high}) {{",
        f"  {target} = {bounded.high};",
        f"}} else if ({ACCUMULATOR} < {_signed(bounded.low)}) {{",
        f"  {target} = {_signed(bounded.low)};",
        "} else {",
        f"  {target} = {cast}{ACCUMULATOR};",
        "}",
    ]


def _signed(value: int) -> str:
    return f"({value})" if value < 0 else str(value)
