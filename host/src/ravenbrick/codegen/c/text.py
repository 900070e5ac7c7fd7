# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Expressions and statements of a program as C text, operation for operation."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ravenbrick.codegen.scopes import (
    ACCUMULATOR,
    FILL_INDEX,
    WIDE_ACCUMULATOR,
    Local,
    declared_here,
)
from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.number_format import Enumeration, FixedFormat, Rounding

__all__ = [
    "C_KEYWORDS",
    "SHARED_GUARDS",
    "Locals",
    "block_title",
    "c_block",
    "c_initial",
    "c_literal",
    "c_local",
    "c_type",
    "format_suffix",
    "line_index",
    "origin",
    "type_name",
]

C_KEYWORDS = frozenset(
    """auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while""".split()
)
# Conditions around the instructions of several blocks.
SHARED_GUARDS = ("Rate", "Enable")
_ABBREVIATIONS = {"Pid": "PID"}
_TEMPORARY_TYPES = {ACCUMULATOR: "int32_T", WIDE_ACCUMULATOR: "int64_T", FILL_INDEX: "uint32_T"}
_STEP_NAMES = C_KEYWORDS | {"work", "u", "y", *_TEMPORARY_TYPES}


def c_literal(value: float, data_type: ir.NumberFormat) -> str:
    """The shortest decimal text that reads back as the same number of the format.

    Of a fixed-point format the value is the raw one.
    """
    if isinstance(data_type, FixedFormat | Enumeration):
        return str(int(value))
    number = data_type.scalar(value)
    if not np.isfinite(number):
        raise DesignError(f"the constant {value} is not finite in {data_type.value}")
    text = np.format_float_positional(number, unique=True, trim="0")
    if len(text) > 17:
        text = np.format_float_scientific(number, unique=True, trim="0")
    return f"{text}F" if data_type is ir.DataType.REAL32 else text


def type_name(program: ir.Program, form: ir.NumberFormat) -> str:
    """The C type of a format; enumerations belong to the model."""
    return f"{program.name}_{form.name}" if isinstance(form, Enumeration) else form.value


def c_type(slot: ir.Slot) -> str:
    """The C type of a number; local integers take a word, which the processor prefers."""
    if slot.kind is ir.Kind.SIGNAL and isinstance(slot.data_type, FixedFormat):
        return "int32_T"
    return slot.data_type.value


def c_local(slot: ir.Slot) -> str:
    """The name of a local variable; those of the step function itself are kept free."""
    return f"{slot.name}_value" if slot.name in _STEP_NAMES else slot.name


def origin(slot: ir.Slot) -> str:
    """A comment with the block that a variable belongs to, and its scaling."""
    scaling = f", {slot.data_type}" if isinstance(slot.data_type, FixedFormat) else ""
    return f" /* '<Root>/{slot.block}'{scaling} */"


@dataclass(frozen=True)
class Locals:
    """Local variables that a block of the C declares, itself or further inside.

    Those in `kept` start with zero. If `traced`, a comment names the block of each.
    """

    variables: Sequence[Local]
    kept: Collection[ir.Slot]
    traced: bool

    def declaration(self, program: ir.Program, local: Local) -> str:
        """The line that declares a variable."""
        if isinstance(local, str):
            return f"{_TEMPORARY_TYPES[local]} {local};"
        form = local.data_type
        kind = c_type(local) if isinstance(form, FixedFormat) else type_name(program, form)
        start = f" = {c_literal(0.0, form)}" if local in self.kept else ""
        return f"{kind} {c_local(local)}{start};{origin(local) if self.traced else ''}"


def line_index(line: ir.DelayLine) -> str:
    """The field with the place of a delay line's oldest sample."""
    return f"{line.name}_oldest"


def c_initial(program: ir.Program, slot: ir.Slot) -> list[str]:
    """Lines of C, without indentation, that give a state its initial value."""
    if not isinstance(slot, ir.DelayLine):
        return [f"work->{slot.name} = {_c_constant(program, slot.initial, slot.data_type)};"]
    value = _c_constant(program, slot.initial, slot.data_type)
    return [
        f"for ({FILL_INDEX} = 0U; {FILL_INDEX} < {slot.length}U; {FILL_INDEX}++) {{",
        f"  work->{slot.name}[{FILL_INDEX}] = {value};",
        "}",
        f"work->{line_index(slot)} = 0U;",
    ]


def _c_constant(program: ir.Program, value: float, form: ir.NumberFormat) -> str:
    if isinstance(form, Enumeration):
        return f"{program.name}_{form.members[int(value)]}"
    return c_literal(value, form)


def c_variable(program: ir.Program, slot: ir.Slot) -> str:
    """How the step function names a variable."""
    match slot.kind:
        case ir.Kind.INPUT:
            return f"u->{slot.name}"
        case ir.Kind.OUTPUT:
            return f"y->{slot.name}"
        case ir.Kind.STATE if isinstance(slot, ir.DelayLine):
            return f"work->{slot.name}[work->{line_index(slot)}]"
        case ir.Kind.STATE:
            return f"work->{slot.name}"
        case ir.Kind.PARAMETER:
            return f"{program.name}_P.{slot.name}"
        case ir.Kind.SIGNAL:
            return c_local(slot)


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
            text = _c_constant(program, value, data_type)
            if isinstance(data_type, FixedFormat) and data_type.width == 64:
                return f"((int64_T){text})"
            return f"({text})" if text.startswith("-") else text
        case ir.Cast(value=ir.Read(slot=slot), data_type=FixedFormat() as form):
            return f"({form.value}){c_variable(program, slot)}"
        case ir.Cast(value=ir.Clamp(value=value, limit=limit), data_type=form):
            wide = ir.Clamp(ir.Cast(value, form), ir.Cast(limit, form))
            return _c_expression(program, wide, nested=nested)
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
            name = "nearest_wide_quotient" if ir.is_wide(value) else "nearest_quotient"
            return f"{program.name}_{name}({inner}, {1 << bits})"
        case ir.Rescale(value=value, bits=bits):
            text = f"{_c_expression(program, value, nested=True)} / {1 << bits}"
        case ir.Clamp():
            return _c_expression(program, ir.limits_as_choices(expression), nested=nested)
        case ir.Bounded():
            raise DesignError("a bound inside an expression cannot become C; give it its own block")
    return f"({text})" if nested else text


def _c_branch(program: ir.Program, branch: ir.Expression) -> str:
    """One side of a choice; a small integer alone would have a narrower type than a variable."""
    text = _c_expression(program, branch, nested=True)
    whole = isinstance(branch, ir.Literal) and isinstance(branch.data_type, FixedFormat)
    return f"(int32_T){text}" if whole and not ir.is_wide(branch) else text


def _c_infix(program: ir.Program, operator: str, left: ir.Expression, right: ir.Expression) -> str:
    first = _c_expression(program, left, nested=True)
    second = _c_expression(program, right, nested=True)
    return f"{first} {operator} {second}"


def c_block(
    program: ir.Program,
    instructions: Sequence[ir.Instruction],
    given: Locals,
    *,
    titled: bool = True,
) -> list[str]:
    """Lines of C, without indentation: the block's own variables, then what its instructions do.

    If `titled`, a comment names the block of the diagram of each, after an empty line.
    """
    own, others = declared_here(instructions, given.variables)
    inside = replace(given, variables=others)
    lines = [given.declaration(program, local) for local in own]
    lines += [""] if own and not titled else []
    for one in instructions:
        if titled:
            lines += ["", f"/* {block_title(one)}: '<Root>/{one.block}' */"]
        lines += _c_instruction(program, one, inside)
    return lines


def block_title(one: ir.Instruction) -> str:
    """What an instruction is to its block: its type, or the update of its state."""
    first, *others = re.findall("[A-Z][a-z0-9]*", one.block_type)
    kind = " ".join([_ABBREVIATIONS.get(first, first), *map(str.lower, others)])
    if not isinstance(one, ir.Statement) or one.target.kind is not ir.Kind.STATE:
        return kind
    own = kind if kind.startswith(tuple(_ABBREVIATIONS.values())) else kind[0].lower() + kind[1:]
    return f"Update of {own}"


def _c_instruction(program: ir.Program, one: ir.Instruction, inside: Locals) -> list[str]:
    match one:
        case ir.Statement():
            return _c_statement(program, one)
        case ir.Restart(states=states):
            return [line for slot in states for line in c_initial(program, slot)]
        case ir.If():
            return _c_if(program, one, inside)
        case ir.Case():
            return _c_switch(program, one, inside)


def _c_if(program: ir.Program, one: ir.If, inside: Locals) -> list[str]:
    """An if with its else; an else that is an if alone goes on with `else if`."""
    tests = [_c_infix(program, test.operator, test.left, test.right) for test in one.conditions]
    condition = tests[0] if len(tests) == 1 else " && ".join(f"({test})" for test in tests)
    titled = one.block_type in SHARED_GUARDS
    lines = [f"if ({condition}) {{", *_indented(program, one.body, inside, titled=titled)]
    match one.otherwise:
        case ():
            return [*lines, "}"]
        case (ir.If() as other,) if not declared_here(one.otherwise, inside.variables)[0]:
            head, *rest = _c_if(program, other, inside)
            return [*lines, f"}} else {head}", *rest]
        case _:
            return [*lines, "} else {", *_indented(program, one.otherwise, inside), "}"]


def _c_switch(program: ir.Program, one: ir.Case, inside: Locals) -> list[str]:
    """One clause per member; the last is also the default, which MISRA C wants."""
    form = one.selector.data_type
    assert isinstance(form, Enumeration)
    lines = [f"switch ({c_variable(program, one.selector)}) {{"]
    for place, (member, branch) in enumerate(zip(form.members, one.branches, strict=True), 1):
        lines.append(f"  case {program.name}_{member}:")
        lines += ["  default:"] if place == len(one.branches) else []
        lines += [f"  {line}" for line in _indented(program, branch, inside)]
        lines.append("    break;")
    return [*lines, "}"]


def _indented(
    program: ir.Program,
    instructions: Sequence[ir.Instruction],
    inside: Locals,
    *,
    titled: bool = False,
) -> list[str]:
    lines = c_block(program, instructions, inside, titled=titled)
    return [f"  {line}".rstrip() for line in lines[lines[:1] == [""] :]]


def _c_statement(program: ir.Program, statement: ir.Statement) -> list[str]:
    """Lines of C, without indentation, that do what the statement does."""
    if isinstance(statement.target, ir.DelayLine):
        return _c_entry(program, statement, statement.target)
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


def _c_entry(program: ir.Program, statement: ir.Statement, line: ir.DelayLine) -> list[str]:
    """The newest sample replaces the oldest, whose place moves on."""
    index = f"work->{line_index(line)}"
    sample = ir.Slot(line.kind, f"{line.name}[{index}]", line.data_type, line.block)
    return [
        *_c_statement(program, replace(statement, target=sample)),
        f"if ({index} >= {line.length - 1}U) {{",
        f"  {index} = 0U;",
        "} else {",
        f"  {index} = {index} + 1U;",
        "}",
    ]


def _c_assigned(program: ir.Program, expression: ir.Expression, target: ir.Slot) -> str:
    """The expression converted to the target's type; only integers need it."""
    text = _c_expression(program, expression)
    form = target.data_type
    if not isinstance(form, FixedFormat) or isinstance(expression, ir.Literal):
        return text
    given = c_type(expression.slot) if isinstance(expression, ir.Read) else _word(expression)
    if given == c_type(target):
        return text
    simple = isinstance(expression, ir.Read)
    return f"({c_type(target)}){text}" if simple else f"({c_type(target)})({text})"


def _c_bounded(program: ir.Program, statement: ir.Statement, bounded: ir.Bounded) -> list[str]:
    target = c_variable(program, statement.target)
    form = statement.target.data_type
    wide = ir.is_wide(bounded.value)
    own = WIDE_ACCUMULATOR if wide else ACCUMULATOR
    cast = f"({form.value})" if wide or c_type(statement.target) == "int16_T" else ""
    return [
        f"{own} = {_c_expression(program, bounded.value)};",
        f"if ({own} > {bounded.high}) {{",
        f"  {target} = {bounded.high};",
        f"}} else if ({own} < {_signed(bounded.low)}) {{",
        f"  {target} = {_signed(bounded.low)};",
        "} else {",
        f"  {target} = {cast}{own};",
        "}",
    ]


def _word(expression: ir.Expression) -> str:
    """The C type in which an integer expression is computed."""
    return "int64_T" if ir.is_wide(expression) else "int32_T"


def _signed(value: int) -> str:
    return f"({value})" if value < 0 else str(value)
