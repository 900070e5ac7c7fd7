# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ranges of a program's variables from those of its inputs, in real numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model.diagram import DiagramError
from ravenbrick.model.linearisation import linearise
from ravenbrick.model.number_format import Interval
from ravenbrick.model.program import (
    Binary,
    Cast,
    Clamp,
    Expression,
    Kind,
    Literal,
    Program,
    Read,
    Slot,
)

__all__ = ["Key", "key", "real_ranges"]

Key = tuple[Kind, str]

_ROUNDS = 60
_MOST_STEPS = 100_000
_REMAINDER = 1e-6


def key(slot: Slot) -> Key:
    """What identifies a variable."""
    return slot.kind, slot.name


def real_ranges(program: Program, given: Mapping[str, Interval]) -> dict[Key, Interval]:
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
    if _iterate(program, ranges, free):
        return ranges
    _use_peak_gains(program, ranges, free)
    _pass(program, ranges, frozenset(key(slot) for slot in program.states))
    return ranges


def _iterate(program: Program, ranges: dict[Key, Interval], free: list[Slot]) -> bool:
    """Grow the free states' ranges until none grows; False if that does not end."""
    fixed = frozenset(key(slot) for slot in program.states) - {key(slot) for slot in free}
    for _ in range(_ROUNDS):
        before = {key(slot): ranges[key(slot)] for slot in free}
        _pass(program, ranges, fixed)
        for name, interval in before.items():
            ranges[name] = ranges[name].hull(interval)
        if all(ranges[name] == interval for name, interval in before.items()):
            return True
    return False


def _pass(program: Program, ranges: dict[Key, Interval], kept: frozenset[Key]) -> None:
    for statement in program.statements:
        if key(statement.target) not in kept:
            ranges[key(statement.target)] = _range(statement.expression, ranges, statement.block)


def _range(expression: Expression, ranges: Mapping[Key, Interval], block: str) -> Interval:
    match expression:
        case Read(slot=slot):
            return ranges[key(slot)]
        case Literal(value=value):
            return Interval(value, value)
        case Cast(value=inner):
            return _range(inner, ranges, block)
        case Clamp(value=inner, limit=limit):
            size = _range(limit, ranges, block).size
            return _range(inner, ranges, block).limited(-size, size)
        case Binary(operator=operator, left=left, right=right):
            first, second = _range(left, ranges, block), _range(right, ranges, block)
            if operator == "*":
                return first * second
            return first + second if operator == "+" else first - second
        case _:
            raise DesignError(
                f"block '{block}' has no fixed-point form; use it in floating point or replace it "
                "by sums, gains, delays, integrators and saturations"
            )


def _use_peak_gains(program: Program, ranges: dict[Key, Interval], free: list[Slot]) -> None:
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
