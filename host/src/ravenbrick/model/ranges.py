# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ranges of a program's variables from those of its inputs, in real numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.diagram import DiagramError
from ravenbrick.model.linearisation import linearise
from ravenbrick.model.number_format import Interval

__all__ = ["Key", "key", "real_ranges"]

Key = tuple[ir.Kind, str]

_ROUNDS = 60
_MOST_STEPS = 100_000
_REMAINDER = 1e-6


def key(slot: ir.Slot) -> Key:
    """What identifies a variable."""
    return slot.kind, slot.name


def real_ranges(program: ir.Program, given: Mapping[str, Interval]) -> dict[Key, Interval]:
    """The range of every variable.

    `given` by block: all Inports, and the states that neither interval analysis nor the peak gain
    of the linear program bounds (an integrator has no bound of its own). Parameters have the
    single value they begin with. Raises `DesignError` that names the block without a range.
    """
    ranges: dict[Key, Interval] = {}
    for slot in program.inputs:
        if slot.block not in given:
            raise DesignError(f"Inport '{slot.block}' needs a range for fixed point")
        ranges[key(slot)] = given[slot.block]
    for slot in program.parameters:
        ranges[key(slot)] = Interval(slot.initial, slot.initial)
    free = [slot for slot in program.states if slot.block not in given]
    for slot in program.states:
        start = Interval(slot.initial, slot.initial)
        ranges[key(slot)] = given[slot.block].hull(start) if slot.block in given else start
    starts = dict(ranges)
    if _iterate(program, ranges, free):
        return ranges
    try:
        _use_peak_gains(program, ranges, free)
    except DesignError:
        ranges = starts
        if _iterate(program, ranges, free, _landmarks(program)):
            return ranges
        raise
    _pass(program, ranges, frozenset(key(slot) for slot in program.states))
    return ranges


def _landmarks(program: ir.Program) -> list[float]:
    """Where a range that grows may end: the numbers that values are compared with, and one more."""
    found = {0.0}
    waiting = [statement.expression for statement in program.statements]
    while waiting:
        node = waiting.pop()
        waiting.extend(ir.children(node))
        if isinstance(node, ir.Literal):
            found |= {abs(node.value), abs(node.value) + 1.0}
    return sorted(found)


def _iterate(
    program: ir.Program,
    ranges: dict[Key, Interval],
    free: list[ir.Slot],
    landmarks: list[float] | None = None,
) -> bool:
    """Grow the free states' ranges until none grows; False if that does not end.

    With `landmarks` a growing range grows to the next of them at once.
    """
    fixed = frozenset(key(slot) for slot in program.states) - {key(slot) for slot in free}
    for _ in range(_ROUNDS):
        before = {key(slot): ranges[key(slot)] for slot in free}
        _pass(program, ranges, fixed)
        for name, interval in before.items():
            ranges[name] = ranges[name].hull(interval)
            if landmarks is not None and ranges[name] != interval:
                ranges[name] = _widened(ranges[name], interval, landmarks)
        if all(ranges[name] == interval for name, interval in before.items()):
            return True
    return False


def _widened(found: Interval, before: Interval, landmarks: list[float]) -> Interval:
    low, high = found.low, found.high
    if low < before.low:
        low = max((-mark for mark in landmarks if -mark <= low), default=low)
    if high > before.high:
        high = min((mark for mark in landmarks if mark >= high), default=high)
    return Interval(low, high)


def _pass(program: ir.Program, ranges: dict[Key, Interval], kept: frozenset[Key]) -> None:
    for statement in program.statements:
        if key(statement.target) not in kept:
            ranges[key(statement.target)] = _range(statement.expression, ranges, statement.block)


def _range(expression: ir.Expression, ranges: Mapping[Key, Interval], block: str) -> Interval:
    match expression:
        case ir.Read(slot=slot):
            return ranges[key(slot)]
        case ir.Literal(value=value):
            return Interval(value, value)
        case ir.Cast(value=inner):
            return _range(inner, ranges, block)
        case ir.Clamp(value=inner, limit=limit):
            size = _range(limit, ranges, block).size
            return _range(inner, ranges, block).limited(-size, size)
        case ir.Binary(operator=operator, left=left, right=right):
            first, second = _range(left, ranges, block), _range(right, ranges, block)
            if operator == "*":
                return first * second
            return first + second if operator == "+" else first - second
        case ir.Rounded(value=inner):
            found = _range(inner, ranges, block)
            return Interval(found.low - 0.5, found.high + 0.5)
        case ir.Table():
            return _range(ir.as_choices(expression), ranges, block)
        case ir.Select():
            return _choice(expression, ranges, block)
        case _:
            raise DesignError(
                f"block '{block}' has no fixed-point form; use it in floating point, or a "
                "LookupTable of the function"
            )


def _choice(select: ir.Select, ranges: Mapping[Key, Interval], block: str) -> Interval:
    """The hull of both branches, each with what its condition says of a variable."""
    branches = []
    for holds, branch in ((True, select.chosen), (False, select.otherwise)):
        known = _with_condition(select.condition, ranges, block, holds=holds)
        if known is not None:
            branches.append(_range(branch, known, block))
    return branches[0] if len(branches) == 1 else branches[0].hull(branches[1])


def _with_condition(
    condition: ir.Comparison, ranges: Mapping[Key, Interval], block: str, *, holds: bool
) -> Mapping[Key, Interval] | None:
    """The ranges where the condition holds (or not); None if that cannot be."""
    left, right = (_range(side, ranges, block) for side in (condition.left, condition.right))
    below = (condition.operator in ("<", "<=")) == holds
    if (left.low > right.high) if below else (left.high < right.low):
        return None
    if not isinstance(condition.left, ir.Read):
        return ranges
    low = left.low if below else max(left.low, right.low)
    high = min(left.high, right.high) if below else left.high
    return {**ranges, key(condition.left.slot): Interval(low, high)}


def _use_peak_gains(program: ir.Program, ranges: dict[Key, Interval], free: list[ir.Slot]) -> None:
    """Bound the free states by the peak gains of the linear program."""
    try:
        system = linearise(program)
    except DiagramError as error:
        raise DesignError(f"{error}; give ranges for the states") from error
    index = {key(slot): place for place, slot in enumerate(program.states)}
    rows = [index[key(slot)] for slot in free]
    matrix = system.A[np.ix_(rows, rows)]
    held = [place for place in range(len(program.states)) if place not in rows]
    drive = np.hstack([system.B[rows], system.A[np.ix_(rows, held)]])
    sources = [*program.inputs, *(program.states[place] for place in held)]
    sizes = np.array([ranges[key(slot)].size for slot in sources])
    start = np.abs([slot.initial for slot in free])
    constant = np.zeros(len(rows))
    bound, step = start.copy(), np.eye(len(rows))
    for _ in range(_MOST_STEPS):
        bound = bound + np.abs(step @ drive) @ sizes + constant
        step = matrix @ step
        left = np.abs(step).sum()
        if left < _REMAINDER:
            break
    else:
        names = ", ".join(f"'{name}'" for name in dict.fromkeys(slot.block for slot in free))
        raise DesignError(
            f"the state of {names} has no bound of its own; give its range: it saturates there"
        )
    for slot, size in zip(free, bound * (1 + 2 * left) + start, strict=True):
        ranges[key(slot)] = Interval.around_zero(float(size))
