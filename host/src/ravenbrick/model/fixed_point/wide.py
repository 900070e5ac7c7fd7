# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program rewritten with 64-bit sums: a fraction per state, signal and gain, of 32 bits each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.fixed_point.rewriting import (
    FixedPointOptions,
    Rewriting,
    Scaled,
    TooFineError,
    is_constant,
)
from ravenbrick.model.number_format import FixedFormat, Interval, Rounding, finest_fraction
from ravenbrick.model.ranges import Key, key

__all__ = ["WideRewriting"]

_SUM_BITS = 63
_MOST_FRACTION = 60


class WideRewriting(Rewriting):
    """One attempt with `headroom` bits left free in each sum, state and signal."""

    def __init__(
        self,
        source: ir.Program,
        options: FixedPointOptions,
        ranges: Mapping[Key, Interval],
        headroom: int,
    ) -> None:
        self._headroom = headroom
        super().__init__(source, options, ranges, _MOST_FRACTION)

    def _state_format(self, slot: ir.Slot) -> tuple[int, int]:
        return 32, self._finest(self._ranges[key(slot)], 32)

    def _finest(self, interval: Interval, width: int) -> int:
        return min(finest_fraction(interval, width - self._headroom), _MOST_FRACTION)

    def _has_no_range(self, target: ir.Slot) -> bool:
        return not isinstance(target.data_type, ir.DataType)

    def _signal(self, statement: ir.Statement, value: Scaled) -> ir.Slot:
        target = statement.target
        finest = self._finest(self._ranges[key(target)].hull(value.interval), 32)
        limited = isinstance(value.expression, ir.Clamp)
        return self._declare(target, 32, value.fraction if limited else finest)

    def _at_fraction(self, value: Scaled, fraction: int) -> Scaled:
        finer = fraction > value.fraction
        if finer and isinstance(value.expression, ir.Literal):
            return self._shifted(value, fraction)
        return super()._at_fraction(self._wide(value) if finer else value, fraction)

    def _shifted(self, value: Scaled, fraction: int) -> Scaled:
        """A number with more fractional bits, as one number."""
        wide = self._wide(value)
        assert isinstance(wide.expression, ir.Literal)
        raw = int(wide.expression.value) << (fraction - value.fraction)
        literal = ir.Literal(raw, FixedFormat(64, fraction))
        own = wide.expression.data_type
        assert isinstance(own, FixedFormat)
        held = own.real(int(wide.expression.value))
        self.constants[self._block, literal] = self.constants.get(
            (self._block, wide.expression), held
        )
        return Scaled(literal, fraction, value.interval)

    def _wide(self, value: Scaled) -> Scaled:
        """The value in 64 bits."""
        expression = value.expression
        if ir.is_wide(expression):
            return value
        form = FixedFormat(64, value.fraction)
        if isinstance(expression, ir.Literal):
            wide = ir.Literal(expression.value, form)
            real = self.constants.get((self._block, expression))
            if real is not None:
                self.constants[self._block, wide] = real
            return replace(value, expression=wide)
        return replace(value, expression=ir.Cast(expression, form))

    def _in_32_bits(self, value: Scaled) -> Scaled:
        """The value in at most 32 bits, still computed in 64 if it was."""
        if not ir.is_wide(value.expression):
            return value
        return self._at_fraction(value, min(value.fraction, self._finest(value.interval, 32)))

    def _constant(self, expression: ir.Expression, fraction: int, width: int = 32) -> Scaled:
        """As coarse as 32 bits need it, then as fine as wanted."""
        interval = self._constant_range(expression)
        held = min(fraction, finest_fraction(interval, 32))
        if isinstance(expression, ir.Literal):
            form = FixedFormat(32, held)
            literal = ir.Literal(form.raw(expression.value), form)
            self.constants[self._block, literal] = expression.value
            found = Scaled(literal, held, interval)
        else:
            assert isinstance(expression, ir.Read)
            slot = self._declare(expression.slot, 32, held)
            assert isinstance(slot.data_type, FixedFormat)
            found = Scaled(ir.Read(slot), slot.data_type.fraction, interval)
        return found if found.fraction == fraction else self._at_fraction(found, fraction)

    def _convert(self, expression: ir.Expression) -> Scaled:
        if isinstance(expression, ir.Literal) and isinstance(expression.data_type, FixedFormat):
            own = expression.data_type.real(int(expression.value))
            return Scaled(expression, expression.data_type.fraction, Interval(own, own))
        if is_constant(expression):
            fraction = self._finest(self._constant_range(expression), 32)
            return self._constant(expression, fraction)
        if isinstance(expression, ir.Clamp):
            return self._limited(expression)
        if isinstance(expression, ir.Rounded):
            return self._rounded(self._wide(self._convert(expression.value)))
        return super()._convert(expression)

    def _rounded(self, exact: Scaled) -> Scaled:
        if exact.fraction <= 0:
            return exact
        whole = ir.Rescale(exact.expression, exact.fraction, Rounding.NEAREST)
        low, high = exact.interval.low - 0.5, exact.interval.high + 0.5
        return Scaled(whole, 0, Interval(low, high))

    def _limited(self, clamp: ir.Clamp) -> Scaled:
        value = self._in_32_bits(self._convert(clamp.value))
        size = self._constant_range(clamp.limit).size
        fraction = min(value.fraction, finest_fraction(Interval.around_zero(size), 32))
        value = self._at_fraction(value, fraction)
        bound = self._constant(clamp.limit, fraction)
        limited = ir.Clamp(value.expression, bound.expression)
        return Scaled(limited, fraction, value.interval.limited(-size, size))

    def _aligned(self, left: ir.Expression, right: ir.Expression) -> tuple[Scaled, Scaled]:
        values = self._convert(left), self._convert(right)
        narrow = not any(ir.is_wide(value.expression) for value in values)
        if narrow and values[0].fraction == values[1].fraction:
            return values
        hull = values[0].interval.hull(values[1].interval)
        return self._with_one_fraction(values, hull)

    def _with_one_fraction(
        self, values: tuple[Scaled, Scaled], reach: Interval
    ) -> tuple[Scaled, Scaled]:
        finest = max(value.fraction for value in values)
        room = reach
        for value in values:
            room = room.hull(value.interval)
        fraction = min(finest, self._finest(room, _SUM_BITS))
        first, second = (self._at_fraction(self._wide(value), fraction) for value in values)
        return first, second

    def _sum(self, operator: str, left: ir.Expression, right: ir.Expression) -> Scaled:
        one, other = self._convert(left), self._convert(right)
        interval = one.interval + other.interval
        if operator == "-":
            interval = one.interval - other.interval
        first, second = self._with_one_fraction((one, other), interval)
        expression = ir.Binary(operator, first.expression, second.expression)
        return Scaled(expression, first.fraction, interval)

    def _product(self, left: ir.Expression, right: ir.Expression) -> Scaled:
        if is_constant(left):
            left, right = right, left
        first, second = (self._in_32_bits(self._convert(side)) for side in (left, right))
        interval = first.interval * second.interval
        expression = ir.Binary("*", self._wide(first).expression, second.expression)
        if ir.is_wide(second.expression) and not ir.is_wide(first.expression):
            expression = ir.Binary("*", second.expression, first.expression)
        fraction = first.fraction + second.fraction
        if finest_fraction(interval, 64) < fraction:
            raise TooFineError(f"block '{self._block}' reaches {interval.size:.6g}")
        if math.ldexp(interval.size, fraction) < 1 and interval.size:
            raise DesignError(f"block '{self._block}': its product is below every fraction")
        return Scaled(expression, fraction, interval)
