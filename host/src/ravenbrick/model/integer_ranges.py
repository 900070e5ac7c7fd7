# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Proof by interval arithmetic over the integers that a fixed-point program never overflows."""

from __future__ import annotations

from collections.abc import Mapping

from ravenbrick.model import program as ir
from ravenbrick.model.flattening import flattened
from ravenbrick.model.number_format import Enumeration, FixedFormat, Interval, Rounding
from ravenbrick.model.ranges import Key, key, narrowed

__all__ = ["Key", "expression_range", "integer_ranges", "key"]

_WORD = Interval(-(2**31), 2**31 - 1)
_LONG = Interval(-(2**63), 2**63 - 1)
_ROUNDS = 60


def integer_ranges(program: ir.Program) -> dict[Key, Interval]:
    """Raw ranges of all variables, for any inputs of their formats and any number of steps.

    By induction: the states' ranges grow from their initial values until one more step leaves
    them as they are; a state that still grows gets all that its limits, or else its format,
    allow, which the next step must keep. Raises `OverflowError` that names the block whose result
    exceeds its accumulator or its format.
    """
    program = flattened(program)
    ranges: dict[Key, Interval] = {}
    for slot in program.inputs:
        ranges[key(slot)] = _limits(slot)
    for slot in program.parameters + program.states:
        ranges[key(slot)] = Interval(slot.initial, slot.initial)
    for last_chance in (False, True):
        for _ in range(_ROUNDS):
            before = {key(slot): ranges[key(slot)] for slot in program.states}
            _pass(program, ranges)
            for name, interval in before.items():
                ranges[name] = ranges[name].hull(interval)
            growing = [name for name, interval in before.items() if ranges[name] != interval]
            if not growing:
                return ranges
        if last_chance:
            break
        for slot in program.states:
            if key(slot) in growing:
                ranges[key(slot)] = ranges[key(slot)].hull(_kept_within(program, slot))
    raise OverflowError(f"the range of state '{growing[0][1]}' has no end")


def _kept_within(program: ir.Program, slot: ir.Slot) -> Interval:
    """What the assignments of a state limit it to."""
    found = None
    for statement in ir.statements(program.statements):
        if key(statement.target) == key(slot):
            bounded = statement.expression
            if not isinstance(bounded, ir.Bounded):
                return _limits(slot)
            own = Interval(bounded.low, bounded.high)
            found = own if found is None else found.hull(own)
    return found or _limits(slot)


def _limits(slot: ir.Slot) -> Interval:
    form = slot.data_type
    if isinstance(form, Enumeration):
        return Interval(0, len(form.members) - 1)
    assert isinstance(form, FixedFormat)
    return Interval(*form.limits)


def _pass(program: ir.Program, ranges: dict[Key, Interval]) -> None:
    for statement in ir.statements(program.statements):
        target = statement.target
        result = expression_range(statement.expression, ranges, statement.block)
        if not result.within(_limits(target)):
            raise OverflowError(f"block '{statement.block}' exceeds {target.data_type}")
        ranges[key(target)] = result


def expression_range(
    expression: ir.Expression, ranges: Mapping[Key, Interval], block: str
) -> Interval:
    """Raw range of an expression; raises `OverflowError` for a part beyond 32 bits."""
    match expression:
        case ir.Read(slot=slot):
            return ranges[slot.kind, slot.name]
        case ir.Literal(value=value):
            result = Interval(value, value)
        case ir.Binary(operator=operator, left=left, right=right):
            first, second = (
                expression_range(left, ranges, block),
                expression_range(right, ranges, block),
            )
            if operator == "*":
                result = first * second
            else:
                result = first + second if operator == "+" else first - second
        case ir.Clamp(value=inner, limit=limit):
            size = expression_range(limit, ranges, block).size
            result = expression_range(inner, ranges, block).limited(-size, size)
        case ir.Bounded(value=inner, low=low, high=high):
            result = expression_range(inner, ranges, block).limited(low, high)
        case ir.Rescale(value=inner, bits=bits, rounding=rounding):
            room = _room(inner)
            result = _rescaled(expression_range(inner, ranges, block), bits, rounding, block, room)
        case ir.Cast(value=inner):
            result = expression_range(inner, ranges, block)
        case ir.Select(condition=condition, chosen=chosen, otherwise=otherwise):
            sides = [
                expression_range(side, ranges, block) for side in (condition.left, condition.right)
            ]
            branches = [
                expression_range(branch, known, block)
                for holds, branch in ((True, chosen), (False, otherwise))
                if (known := narrowed(condition, sides, ranges, holds=holds, unit=1))
            ]
            result = branches[0].hull(branches[-1])
        case _:
            raise OverflowError(f"block '{block}' is not in fixed point")
    room = _room(expression)
    if not result.within(room):
        bits = 32 if room is _WORD else 64
        raise OverflowError(f"block '{block}' reaches {result.size:.0f}, beyond {bits} bits")
    return result


def _room(expression: ir.Expression) -> Interval:
    return _LONG if ir.is_wide(expression) else _WORD


def _rescaled(
    value: Interval, bits: int, rounding: Rounding, block: str, room: Interval
) -> Interval:
    """The C adds half a unit before it divides: that must fit as well."""
    half = (1 << bits) >> 1 if rounding is Rounding.NEAREST else 0
    if not Interval(value.low - half, value.high + half).within(room):
        raise OverflowError(f"block '{block}' leaves no room to round")
    low, high = int(value.low), int(value.high)
    return Interval(rounding.divide(low, bits), rounding.divide(high, bits))
