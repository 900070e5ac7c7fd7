# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program rewritten with integers: one fraction of a 32-bit accumulator for all its sums."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.assignments import multiplied_sums, plain_stores, several_times
from ravenbrick.model.number_format import (
    Enumeration,
    FixedFormat,
    Interval,
    Rounding,
    finest_fraction,
)
from ravenbrick.model.ranges import Key, key

__all__ = ["FixedPointOptions", "Rewriting", "Scaled", "TooFineError", "is_constant", "is_whole"]

_LEAST_GAIN_BITS = 10
_LEAST_GAIN = 32
_STATE_ROOM = 1 / 32
_SIGN_BIT = 31


class TooFineError(Exception):
    """The accumulator's fraction leaves no room for a sum."""


@dataclass(frozen=True)
class FixedPointOptions:
    """What the choice of formats starts from.

    `ranges` gives by block the largest size (or the interval) of each Inport and of each state
    that is not bounded by itself; such a state saturates there. A state is named by its block, or
    alone by its own name (`Filter_DSTATE2`). `formats` fixes a format by block or parameter name.
    `accumulator_bits` is 32, 64, or None: 64 where 32 leave no room or too few digits to the
    gains (`tolerance` of the frequency response; None allows any). `gain_fraction`, for 32 bits,
    is the most fractional bits of a gain that keeps 10 significant bits with them.
    """

    ranges: Mapping[str, float | Interval]
    formats: Mapping[str, FixedFormat] = field(default_factory=dict)
    rounding: Rounding = Rounding.NEAREST
    gain_fraction: int = 15
    accumulator_bits: int | None = None
    tolerance: float | None = 1e-3

    def intervals(self) -> dict[str, Interval]:
        """The ranges as intervals."""
        return {
            name: value if isinstance(value, Interval) else Interval.around_zero(value)
            for name, value in self.ranges.items()
        }


@dataclass(frozen=True)
class Scaled:
    """An integer expression that stands for itself times 2**-fraction, with its real range."""

    expression: ir.Expression
    fraction: int
    interval: Interval

    def finer(self, fraction: int) -> Scaled:
        """The same value with more fractional bits."""
        if fraction == self.fraction:
            return self
        bits = fraction - self.fraction
        factor = ir.Literal(1 << bits, FixedFormat(32 if bits < _SIGN_BIT else 64, bits))
        return Scaled(ir.Binary("*", self.expression, factor), fraction, self.interval)


class Rewriting:
    """One attempt with a certain fraction of the accumulator."""

    def __init__(
        self,
        source: ir.Program,
        options: FixedPointOptions,
        ranges: Mapping[Key, Interval],
        fraction: int,
    ) -> None:
        self._source = source
        self._options = options
        self._ranges = ranges
        self._fraction = fraction
        self._slots: dict[Key, ir.Slot] = {}
        self._block = ""
        self.constants: dict[tuple[str, ir.Literal], float] = {}
        self._narrow = multiplied_sums(source)
        self._chosen = several_times(source)
        for slot in source.inputs:
            self._declare(slot, 16, finest_fraction(ranges[key(slot)], 16))
        self._kept = plain_stores(source)
        for slot in source.states:
            if isinstance(slot.data_type, ir.DataType):
                self._declare(slot, *self._state_format(slot))
            else:
                self._slots[key(slot)] = slot

    def _state_format(self, slot: ir.Slot) -> tuple[int, int]:
        """Width and fraction of a state."""
        width = 16 if key(slot) in self._kept else 32
        finest = finest_fraction(self._ranges[key(slot)], width)
        return width, finest if width == 16 else min(finest, self._fraction)

    def _declare(self, slot: ir.Slot, width: int, fraction: int) -> ir.Slot:
        chosen = self._options.formats.get(slot.block if slot.kind is not ir.Kind.PARAMETER else "")
        chosen = chosen or self._options.formats.get(slot.name) or FixedFormat(width, fraction)
        known = self._slots.get(key(slot))
        if known is not None:
            if known.data_type != chosen:
                raise DesignError(
                    f"parameter '{slot.name}' needs the formats {known.data_type} and {chosen}; "
                    "give the blocks parameters of their own"
                )
            return known
        try:
            initial = chosen.raw(slot.initial)
        except DesignError as error:
            raise DesignError(f"block '{slot.block}', '{slot.name}': {error}") from error
        unit = f"{slot.unit}, {chosen}" if slot.unit else str(chosen)
        self._slots[key(slot)] = replace(slot, data_type=chosen, initial=initial, unit=unit)
        return self._slots[key(slot)]

    def program(self) -> ir.Program:
        """The fixed-point program."""
        statements = self._instructions(self._source.statements)
        source, slots = self._source, self._slots
        for slot in source.parameters:
            if key(slot) not in slots:
                raise DesignError(f"parameter '{slot.name}' is not used")
        return ir.Program(
            name=source.name,
            sample_time=source.sample_time,
            inputs=tuple(slots[key(slot)] for slot in source.inputs),
            outputs=tuple(slots[key(slot)] for slot in source.outputs),
            parameters=tuple(slots[key(slot)] for slot in source.parameters),
            states=tuple(slots[key(slot)] for slot in source.states),
            signals=tuple(slots[key(slot)] for slot in source.signals),
            statements=statements,
        )

    def _instructions(self, given: Iterable[ir.Instruction]) -> tuple[ir.Instruction, ...]:
        found: list[ir.Instruction] = []
        for one in given:
            match one:
                case ir.Statement():
                    found.append(self._statement(one))
                case ir.Restart(states=states):
                    slots = tuple(self._slots[key(slot)] for slot in states)
                    found.append(replace(one, states=slots))
                case ir.If(conditions=conditions):
                    self._block = one.block
                    tests = tuple(map(self._condition, conditions))
                    body, otherwise = map(self._instructions, (one.body, one.otherwise))
                    found.append(replace(one, conditions=tests, body=body, otherwise=otherwise))
                case ir.Case(branches=branches):
                    found.append(replace(one, branches=tuple(map(self._instructions, branches))))
        return tuple(found)

    def _condition(self, condition: ir.Comparison) -> ir.Comparison:
        left, right = self._aligned(condition.left, condition.right)
        return ir.Comparison(condition.operator, left.expression, right.expression)

    def _several(self, statement: ir.Statement) -> ir.Statement:
        """One of the assignments of a signal: all of them share its format."""
        target = statement.target
        if isinstance(target.data_type, Enumeration):
            self._slots[key(target)] = target
            return statement
        range_ = self._ranges[key(target)]
        whole = isinstance(target.data_type, FixedFormat)
        fraction = 0 if whole else min(finest_fraction(range_, 16), self._fraction)
        slot = self._declare(target, 32, fraction)
        if is_constant(statement.expression):
            value = self._constant(statement.expression, fraction, 32)
        else:
            value = self._at_fraction(self._convert(statement.expression), fraction)
        return replace(statement, target=slot, expression=value.expression)

    def _statement(self, statement: ir.Statement) -> ir.Statement:
        self._block = statement.block
        target = statement.target
        if isinstance(target.data_type, FixedFormat) and is_whole(statement.expression):
            self._slots.setdefault(key(target), target)
            return statement
        if self._has_no_range(target) or key(target) in self._chosen:
            return self._several(statement)
        value = self._convert(statement.expression)
        if target.kind is ir.Kind.STATE:
            slot = self._slots[key(target)]
        elif target.kind is ir.Kind.OUTPUT:
            slot = self._declare(target, 16, finest_fraction(self._ranges[key(target)], 16))
        else:
            slot = self._signal(statement, value)
        return replace(statement, target=slot, expression=self._fit(value, slot))

    def _has_no_range(self, target: ir.Slot) -> bool:
        return isinstance(target.data_type, Enumeration)

    def _signal(self, statement: ir.Statement, value: Scaled) -> ir.Slot:
        """The format of a signal between blocks."""
        target = statement.target
        slot = self._declare(target, 32, value.fraction)
        if target.name in self._narrow and not isinstance(statement.expression, ir.Read):
            finest = finest_fraction(self._ranges[key(target)], 16)
            if finest < value.fraction:
                self._slots.pop(key(target))
                slot = self._declare(target, 16, finest)
        return slot

    def _fit(self, value: Scaled, slot: ir.Slot) -> ir.Expression:
        """The value in the target's format; states are limited to their ranges."""
        wanted = slot.data_type
        assert isinstance(wanted, FixedFormat)
        expression = self._at_fraction(value, wanted.fraction).expression
        low, high = wanted.limits
        if slot.kind is ir.Kind.STATE:
            range_ = self._state_limits(slot)
            low = max(low, math.floor(math.ldexp(range_.low, wanted.fraction)))
            high = min(high, math.ceil(math.ldexp(range_.high, wanted.fraction)))
        if isinstance(expression, ir.Literal) or (
            slot.kind is ir.Kind.SIGNAL and wanted.width == 32
        ):
            return expression
        return ir.Bounded(expression, low, high)

    def _state_limits(self, slot: ir.Slot) -> Interval:
        """Its range if the user gave it: it saturates there. Else with room for errors.

        A stored sample has the limits of its format.
        """
        range_, form = self._ranges[key(slot)], slot.data_type
        assert isinstance(form, FixedFormat)
        if slot.block in self._options.ranges or slot.name in self._options.ranges:
            return range_
        if key(slot) in self._kept:
            return Interval(*map(form.real, form.limits))
        room = range_.size * _STATE_ROOM
        return Interval(range_.low - room, range_.high + room)

    def _at_fraction(self, value: Scaled, fraction: int) -> Scaled:
        if fraction >= value.fraction:
            return value.finer(fraction)
        bits = value.fraction - fraction
        expression = ir.Rescale(value.expression, bits, self._options.rounding)
        return Scaled(expression, fraction, value.interval)

    def _convert(self, expression: ir.Expression) -> Scaled:
        match expression:
            case ir.Read(slot=slot):
                own = self._slots[key(slot)]
                assert isinstance(own.data_type, FixedFormat)
                return Scaled(ir.Read(own), own.data_type.fraction, self._ranges[key(slot)])
            case ir.Literal(value=number):
                return self._constant(expression, self._literal_fraction(number))
            case ir.Cast(value=inner):
                return self._convert(inner)
            case ir.Binary(operator="*", left=left, right=right):
                return self._product(left, right)
            case ir.Binary(operator=operator, left=left, right=right):
                return self._sum(operator, left, right)
            case ir.Clamp(value=inner, limit=limit):
                value = self._convert(inner)
                bound = self._constant(limit, value.fraction, 32)
                size = bound.interval.size
                clamp = ir.Clamp(value.expression, bound.expression)
                return Scaled(clamp, value.fraction, value.interval.limited(-size, size))
            case ir.Rounded(value=inner):
                exact = self._convert(inner)
                whole = ir.Rescale(exact.expression, exact.fraction, Rounding.NEAREST)
                low, high = exact.interval.low - 0.5, exact.interval.high + 0.5
                return Scaled(whole, 0, Interval(low, high))
            case ir.Table():
                return self._convert(ir.as_choices(expression))
            case ir.Select(condition=condition, chosen=chosen, otherwise=otherwise):
                test = self._condition(condition)
                first, second = self._aligned(chosen, otherwise)
                select = ir.Select(test, first.expression, second.expression)
                return Scaled(select, first.fraction, first.interval.hull(second.interval))
            case _:
                raise DesignError(
                    f"block '{self._block}' has no fixed-point form; use it in floating point, "
                    "or a LookupTable of the function"
                )

    def _aligned(self, left: ir.Expression, right: ir.Expression) -> tuple[Scaled, Scaled]:
        """Two values with the same fraction, so that their integers can be compared."""
        sides = (left, right)
        values = [None if is_constant(side) else self._convert(side) for side in sides]
        known = [value.fraction for value in values if value is not None]
        hull = self._source_range(left).hull(self._source_range(right))
        fraction = max(known, default=min(finest_fraction(hull, 16), self._fraction))
        if finest_fraction(hull, 32) < fraction:
            raise TooFineError(f"block '{self._block}' reaches {hull.size:.6g}")
        first, second = (
            self._constant(side, fraction, 32) if value is None else value.finer(fraction)
            for value, side in zip(values, sides, strict=True)
        )
        return first, second

    def _source_range(self, expression: ir.Expression) -> Interval:
        if is_constant(expression):
            return self._constant_range(expression)
        return self._convert(expression).interval

    def _literal_fraction(self, value: float) -> int:
        return min(finest_fraction(Interval(value, value), 16), self._fraction)

    def _constant(self, expression: ir.Expression, fraction: int, width: int = 16) -> Scaled:
        """A literal or parameter with a certain fraction."""
        if isinstance(expression, ir.Literal):
            form = FixedFormat(width, fraction)
            if finest_fraction(Interval(expression.value, expression.value), width) < fraction:
                raise TooFineError(f"block '{self._block}' has the number {expression.value:.6g}")
            literal = ir.Literal(form.raw(expression.value), form)
            self.constants[self._block, literal] = expression.value
            return Scaled(literal, fraction, Interval(expression.value, expression.value))
        assert isinstance(expression, ir.Read)
        slot = self._declare(expression.slot, width, fraction)
        assert isinstance(slot.data_type, FixedFormat)
        if width == 32 and slot.data_type.fraction != fraction:
            raise DesignError(f"parameter '{slot.name}' must have {fraction} fractional bits")
        return Scaled(ir.Read(slot), slot.data_type.fraction, self._ranges[key(expression.slot)])

    def _sum(self, operator: str, left: ir.Expression, right: ir.Expression) -> Scaled:
        operands = [None if is_constant(side) else self._convert(side) for side in (left, right)]
        if isinstance(left, ir.Literal) and isinstance(right, ir.Literal):
            value = left.value + right.value if operator == "+" else left.value - right.value
            return self._constant(replace(left, value=value), self._literal_fraction(value), 32)
        fraction = max(
            (value.fraction for value in operands if value is not None), default=self._fraction
        )
        first, second = (
            self._constant(side, fraction, 32) if value is None else value.finer(fraction)
            for value, side in zip(operands, (left, right), strict=True)
        )
        interval = first.interval + second.interval
        if operator == "-":
            interval = first.interval - second.interval
        if finest_fraction(interval, 32) < fraction:
            raise TooFineError(f"block '{self._block}' reaches {interval.size:.6g}")
        expression = ir.Binary(operator, first.expression, second.expression)
        return Scaled(expression, fraction, interval)

    def _product(self, left: ir.Expression, right: ir.Expression) -> Scaled:
        if is_constant(right):
            left, right = right, left
        if not is_constant(left):
            return self._signals_product(left, right)
        value = self._convert(right)
        interval = self._constant_range(left)
        product = interval * value.interval
        room = finest_fraction(product, 32)
        gain_fraction = self._gain_fraction(interval)
        if value.fraction + gain_fraction > room or value.fraction > self._fraction:
            narrow = finest_fraction(value.interval, 16)
            value = self._at_fraction(value, min(narrow, value.fraction))
        gain_fraction = min(gain_fraction, room - value.fraction, self._fraction - value.fraction)
        gain = self._constant(left, gain_fraction)
        if interval.size and math.ldexp(interval.size, gain.fraction) < _LEAST_GAIN:
            raise DesignError(
                f"block '{self._block}': the gain {interval.size:.6g} keeps too few bits; "
                "lower the ranges of the states that it drives, or use a LookupTable"
            )
        expression = ir.Binary("*", gain.expression, value.expression)
        return Scaled(expression, gain.fraction + value.fraction, product)

    def _signals_product(self, left: ir.Expression, right: ir.Expression) -> Scaled:
        """Two signals with 16 bits each, so that the product fits into 32."""
        first, second = (self._in_16_bits(side) for side in (left, right))
        fraction = first.fraction + second.fraction
        expression = ir.Binary("*", first.expression, second.expression)
        interval = first.interval * second.interval
        kept = min(fraction, self._fraction)
        if math.ldexp(interval.size, kept) < 1 << _LEAST_GAIN_BITS:
            raise DesignError(
                f"block '{self._block}' multiplies signals and keeps too few bits of their "
                f"product, which is within {interval.size:.6g}; use a LookupTable of the function, "
                "or lower the ranges elsewhere"
            )
        return self._at_fraction(Scaled(expression, fraction, interval), kept)

    def _in_16_bits(self, side: ir.Expression) -> Scaled:
        value = self._convert(side)
        return self._at_fraction(value, min(value.fraction, finest_fraction(value.interval, 16)))

    def _constant_range(self, expression: ir.Expression) -> Interval:
        if isinstance(expression, ir.Literal):
            return Interval(expression.value, expression.value)
        assert isinstance(expression, ir.Read)
        return self._ranges[key(expression.slot)]

    def _gain_fraction(self, interval: Interval) -> int:
        needed = _LEAST_GAIN_BITS - 1 - math.floor(math.log2(interval.size or 1.0))
        return min(finest_fraction(interval, 16), max(self._options.gain_fraction, needed))


def is_constant(expression: ir.Expression) -> bool:
    if isinstance(expression, ir.Read):
        return expression.slot.kind is ir.Kind.PARAMETER
    return isinstance(expression, ir.Literal)


def is_whole(expression: ir.Expression) -> bool:
    """Whether an expression is one of integers already, such as a counter's."""
    if isinstance(expression, ir.Read):
        return isinstance(expression.slot.data_type, FixedFormat)
    if isinstance(expression, ir.Literal):
        return isinstance(expression.data_type, FixedFormat)
    return all(map(is_whole, ir.children(expression)))
