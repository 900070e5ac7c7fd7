# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Expressions and statements of a program as Ada text, operation for operation."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

from ravenbrick.codegen.c.text import SHARED_GUARDS, block_title, c_literal, line_index
from ravenbrick.codegen.scopes import Local, declared_here
from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.linearisation import fraction_of
from ravenbrick.model.number_format import Enumeration, FixedFormat, Rounding

__all__ = [
    "AdaText",
    "ada_literal",
    "ada_name",
    "ada_type",
    "nearest_name",
    "oldest",
    "stored_format",
    "wrapped",
]

_WIDTH = 96
_SHORT_CONDITION = 50
_REAL_TYPES = {ir.DataType.REAL32: "Float", ir.DataType.REAL64: "Long_Float"}
_RESERVED = frozenset(
    """abort abs abstract accept access aliased all and array at begin body case constant declare
    delay delta digits do else elsif end entry exception exit for function generic goto if in
    interface is limited loop mod new not null of or others out overriding package parallel pragma
    private procedure protected raise range record rem renames requeue return reverse select
    separate some subtype synchronized tagged task terminate then type until use when while with
    xor""".split()
)


def ada_name(name: str) -> str:
    """An Ada name in Mixed_Case for a C name; raises `DesignError` where there is none."""
    words = name.split("_")
    if not all(words) or not name[0].isalpha():
        raise DesignError(
            f"'{name}' is not an Ada name: underscores stand alone between letters; rename it"
        )
    if name.lower() in _RESERVED:
        return f"{name[0].upper()}{name[1:]}_Value"
    return "_".join(word[0].upper() + word[1:] for word in words)


def ada_type(form: ir.NumberFormat) -> str:
    """The Ada type of a number format."""
    if isinstance(form, FixedFormat):
        name = str(form)
        return name[0].upper() + name[1:]
    if isinstance(form, Enumeration):
        return ada_name(form.name)
    return _REAL_TYPES[form]


def ada_literal(value: float, form: ir.NumberFormat) -> str:
    """Text that is exactly the number of the format; of a fixed-point one `value` is raw."""
    if isinstance(form, Enumeration):
        return ada_name(form.members[int(value)])
    if not isinstance(form, FixedFormat):
        return c_literal(value, form).removesuffix("F").replace("e", "E")
    exact = Fraction(int(value)) * Fraction(2) ** -form.fraction
    digits = max(form.fraction, 0)
    whole, rest = divmod(abs(exact) * 10**digits, 10**digits)
    decimals = str(int(rest)).rjust(digits, "0").rstrip("0") or "0"
    return f"{'-' if exact < 0 else ''}{int(whole)}.{decimals}"


def stored_format(slot: ir.Slot) -> ir.NumberFormat:
    """The format that a variable is kept in; local integers take a word."""
    form = slot.data_type
    if slot.kind is ir.Kind.SIGNAL and isinstance(form, FixedFormat):
        return FixedFormat(32, form.fraction)
    return form


def wrapped(text: str, indent: int) -> list[str]:
    """The text in lines of at most 96 columns, broken at blanks, continued two columns in."""
    return textwrap.wrap(
        text,
        _WIDTH,
        initial_indent=" " * indent,
        subsequent_indent=" " * (indent + 2),
        break_long_words=False,
        break_on_hyphens=False,
    )


def oldest(line: ir.DelayLine) -> str:
    """The field with the place of a delay line's oldest sample."""
    return ada_name(line_index(line))


def nearest_name(form: ir.NumberFormat) -> str:
    """The last part of a helper's name: Real32 or Real64."""
    return "Real32" if form is ir.DataType.REAL32 else "Real64"


def _is_one(expression: ir.Expression) -> bool:
    """Whether a factor only shifts: a literal that stands for 1 with fractional bits."""
    return (
        isinstance(expression, ir.Literal)
        and isinstance(expression.data_type, FixedFormat)
        and expression.value == 2.0**expression.data_type.fraction
        and expression.data_type.width == 32
    )


class AdaText:
    """Statements of one program; `formats` collects the fixed-point types that they need.

    `declaration` is the text that declares a local variable.
    """

    def __init__(
        self,
        program: ir.Program,
        names: Mapping[str, str],
        declaration: Callable[[ir.Slot], str],
    ) -> None:
        self._names = names
        self._declaration = declaration
        self.formats: set[FixedFormat] = set()
        slots = (*program.inputs, *program.outputs, *program.parameters, *program.states)
        for slot in (*slots, *program.signals):
            self._seen(stored_format(slot))

    def _seen(self, form: ir.NumberFormat) -> ir.NumberFormat:
        if isinstance(form, FixedFormat):
            self.formats.add(form)
        return form

    def variable(self, slot: ir.Slot) -> str:
        """How the step procedure names a variable."""
        name = self._names[slot.name]
        match slot.kind:
            case ir.Kind.INPUT:
                return f"Inputs.{name}"
            case ir.Kind.OUTPUT:
                return f"Outputs.{name}"
            case ir.Kind.STATE if isinstance(slot, ir.DelayLine):
                return f"Work.{name} (Work.{oldest(slot)})"
            case ir.Kind.STATE:
                return f"Work.{name}"
            case ir.Kind.PARAMETER if not isinstance(slot.data_type, FixedFormat):
                return f"Parameters.{name}"
            case _:
                return name

    def literal(self, value: float, form: ir.NumberFormat) -> str:
        """A number of the format, negative ones in parentheses."""
        text = ada_literal(value, form)
        if isinstance(form, FixedFormat):
            return f"{ada_type(self._seen(form))}'({text})"
        return f"({text})" if text.startswith("-") else text

    def expression(self, expression: ir.Expression, *, nested: bool = False) -> str:
        """Ada for the expression; in parentheses if `nested` and it has an operator."""
        match expression:
            case ir.Read(slot=slot):
                return self.variable(slot)
            case ir.Literal(value=value, data_type=form):
                return self.literal(value, form)
            case ir.Cast(value=value, data_type=form):
                return f"{ada_type(form)} ({self.expression(value)})"
            case ir.Binary() if isinstance(ir.expression_type(expression), FixedFormat):
                return self._fixed_binary(expression, nested=nested)
            case ir.Binary(operator=operator, left=left, right=right):
                text = self._infix(operator, left, right)
            case ir.Select() if isinstance(ir.expression_type(expression), FixedFormat):
                return self._fixed_choice(expression)
            case ir.Select(condition=condition, chosen=chosen, otherwise=otherwise):
                test = self._infix(condition.operator, condition.left, condition.right)
                first = self.expression(chosen, nested=True)
                return f"(if {test} then {first} else {self.expression(otherwise, nested=True)})"
            case ir.Call(name=name, arguments=arguments):
                return f"{ada_name(name)} ({', '.join(map(self.expression, arguments))})"
            case ir.Rounded(value=value):
                name = nearest_name(ir.expression_type(value))
                return f"Nearest_{name} ({self.expression(value)})"
            case ir.Table(value=value, name=name):
                own = ada_name(name)
                arrays = f"{own}_Breakpoints, {own}_Values, {own}_Slopes"
                helper = f"Look_Up_{nearest_name(ir.expression_type(value))}"
                return f"{helper} ({arrays}, {self.expression(value)})"
            case ir.Rescale():
                return self._rescale(expression)
            case ir.Clamp():
                return self.expression(ir.limits_as_choices(expression), nested=nested)
            case ir.Bounded():
                raise DesignError("a bound inside an expression cannot become Ada")
        return f"({text})" if nested else text

    def _infix(self, operator: str, left: ir.Expression, right: ir.Expression) -> str:
        first = self.expression(left, nested=True)
        return f"{first} {operator} {self.expression(right, nested=True)}"

    def _word(self, expression: ir.Expression) -> FixedFormat:
        """The 32-bit format with the expression's fraction."""
        form = FixedFormat(32, fraction_of(expression))
        self.formats.add(form)
        return form

    def _in_word(self, expression: ir.Expression) -> str:
        """The expression in its 32-bit format."""
        text = self.expression(expression, nested=True)
        if isinstance(expression, ir.Read | ir.Literal):
            form = _format_of(expression)
            if isinstance(form, FixedFormat) and form.width != 32:
                return f"{ada_type(self._word(expression))} ({text})"
        return text

    def _fixed_binary(self, expression: ir.Binary, *, nested: bool) -> str:
        if expression.operator == "*":
            own = ada_type(self._word(expression))
            if _is_one(expression.right):
                return f"{own} ({self.expression(expression.left)})"
            left = self.expression(expression.left, nested=True)
            return f"{own} ({left} * {self.expression(expression.right, nested=True)})"
        left, right = self._in_word(expression.left), self._in_word(expression.right)
        text = f"{left} {expression.operator} {right}"
        return f"({text})" if nested else text

    def _fixed_choice(self, select: ir.Select) -> str:
        test = self._condition(select.condition)
        chosen, otherwise = self._in_word(select.chosen), self._in_word(select.otherwise)
        return f"(if {test} then {chosen} else {otherwise})"

    def _rescale(self, expression: ir.Rescale) -> str:
        """The integer behind the value, divided: conversions of Ada may round either way."""
        inner = self.expression(expression.value)
        # The attribute does not tell the type of a choice.
        if isinstance(expression.value, ir.Select | ir.Clamp):
            inner = f"{ada_type(self._word(expression.value))}'{inner}"
        value = f"Integer_32'Integer_Value ({inner})"
        own = ada_type(self._word(expression))
        if expression.rounding is Rounding.NEAREST:
            return f"{own}'Fixed_Value (Nearest_Quotient ({value}, 2 ** {expression.bits}))"
        return f"{own}'Fixed_Value ({value} / 2 ** {expression.bits})"

    def instructions(
        self,
        instructions: Sequence[ir.Instruction],
        inside: Sequence[Local],
        *,
        titled: bool = True,
    ) -> list[str]:
        """Statements that do what the program's do, without indentation.

        `inside` are variables that an inner block declares. If `titled`, a comment names the block
        of the diagram of each, after an empty line.
        """
        lines: list[str] = []
        for one in instructions:
            if titled:
                lines += ["", f"--  {block_title(one)}: {one.block}"]
            match one:
                case ir.Statement():
                    lines += self._statement(one)
                case ir.Restart(states=states):
                    lines += [line for slot in states for line in self.initial(slot)]
                case ir.If():
                    lines += [*self._if(one, "if", inside), "end if;"]
                case ir.Case():
                    lines += self._case(one, inside)
        return lines

    def initial(self, slot: ir.Slot) -> list[str]:
        """Statements that give a state its initial value."""
        name, value = self._names[slot.name], ada_literal(slot.initial, slot.data_type)
        if isinstance(slot, ir.DelayLine):
            loop = f"for Sample of Work.{name} loop"
            return [loop, f"   Sample := {value};", "end loop;", f"Work.{oldest(slot)} := 0;"]
        return [f"Work.{name} := {value};"]

    def _if(self, one: ir.If, word: str, inside: Sequence[Local]) -> list[str]:
        """From the word, if or elsif, to the last statement."""
        first, *others = map(self._condition, one.conditions)
        lines = [f"{word} {first}", *(f"  and then {other}" for other in others), "then"]
        if not others and len(first) < _SHORT_CONDITION:
            lines = [f"{word} {first} then"]
        lines += self._inner(one.body, one, inside)
        match one.otherwise:
            case ():
                return lines
            case (ir.If() as other,) if not declared_here(one.otherwise, inside)[0]:
                return [*lines, *self._if(other, "elsif", inside)]
            case _:
                return [*lines, "else", *self._inner(one.otherwise, one, inside)]

    def _inner(
        self, instructions: Sequence[ir.Instruction], one: ir.If, given: Sequence[Local]
    ) -> list[str]:
        """The statements of one side of a condition, with the variables that only they use."""
        titled = one.block_type in SHARED_GUARDS
        own, inside = declared_here(instructions, given)
        lines = self.instructions(instructions, inside, titled=titled)[titled:]
        if own:
            declared = [self._declaration(slot) for slot in own if isinstance(slot, ir.Slot)]
            lines = ["declare", *_indented(declared), "begin", *_indented(lines), "end;"]
        return _indented(lines)

    def _case(self, one: ir.Case, inside: Sequence[Local]) -> list[str]:
        form = one.selector.data_type
        assert isinstance(form, Enumeration)
        lines = [f"case {self.variable(one.selector)} is"]
        for member, branch in zip(form.members, one.branches, strict=True):
            lines.append(f"   when {ada_name(member)} =>")
            lines += _indented(_indented(self.instructions(branch, inside, titled=False)))
        return [*lines, "end case;"]

    def _condition(self, test: ir.Comparison) -> str:
        if isinstance(ir.expression_type(test.left), FixedFormat):
            return f"{self._in_word(test.left)} {test.operator} {self._in_word(test.right)}"
        return self._infix(test.operator, test.left, test.right)

    def _entry(self, statement: ir.Statement, line: ir.DelayLine) -> list[str]:
        """The newest sample replaces the oldest, whose place moves on."""
        index = f"Work.{oldest(line)}"
        following = f"(if {index} = {line.length - 1} then 0 else {index} + 1)"
        return [*self._stored(statement), f"{index} := {following};"]

    def _statement(self, statement: ir.Statement) -> list[str]:
        if isinstance(statement.target, ir.DelayLine):
            return self._entry(statement, statement.target)
        return self._stored(statement)

    def _stored(self, statement: ir.Statement) -> list[str]:
        target = self.variable(statement.target)
        expression = statement.expression
        match expression:
            case ir.Bounded(value=value, low=low, high=high):
                return self._bounded(statement, value, low, high)
            case ir.Clamp(value=value, limit=limit):
                whole = isinstance(statement.target.data_type, FixedFormat)
                inner, bound = (
                    self._in_word(side) if whole else self.expression(side, nested=True)
                    for side in (value, limit)
                )
                return _limited(target, inner, (f"-{bound}", bound), inner)
            case _:
                return [f"{target} := {self._assigned(expression, statement.target)};"]

    def _assigned(self, expression: ir.Expression, target: ir.Slot) -> str:
        text = self.expression(expression)
        form = stored_format(target)
        if not isinstance(form, FixedFormat):
            return text
        if isinstance(expression, ir.Literal):
            return ada_literal(expression.value, form)
        given = (
            _format_of(expression) if isinstance(expression, ir.Read) else self._word(expression)
        )
        return text if given == form else f"{ada_type(form)} ({text})"

    def _bounded(
        self, statement: ir.Statement, value: ir.Expression, low: int, high: int
    ) -> list[str]:
        target, form = statement.target, stored_format(statement.target)
        word = self._word(value)
        cast = _ACCUMULATOR if word == form else f"{ada_type(form)} ({_ACCUMULATOR})"
        limits = ada_literal(low, word), ada_literal(high, word)
        assert isinstance(form, FixedFormat)
        lines = _limited(self.variable(target), _ACCUMULATOR, limits, cast)
        kept = f"{_ACCUMULATOR} : constant {ada_type(word)} := {self._in_word(value)};"
        return ["declare", f"   {kept}", "begin", *(f"   {line}" for line in lines), "end;"]


_ACCUMULATOR = "Accumulator"


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"   {line}".rstrip() for line in lines]


def _format_of(expression: ir.Read | ir.Literal) -> ir.NumberFormat:
    if isinstance(expression, ir.Read):
        return stored_format(expression.slot)
    return expression.data_type


def _limited(target: str, value: str, limits: tuple[str, str], kept: str) -> list[str]:
    low, high = limits
    return [
        f"if {value} > {high} then",
        f"   {target} := {high};",
        f"elsif {value} < {low} then",
        f"   {target} := {low};",
        "else",
        f"   {target} := {kept};",
        "end if;",
    ]
