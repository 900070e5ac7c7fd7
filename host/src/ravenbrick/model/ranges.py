# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ranges of a program's variables from those of its inputs, in real numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.diagram import DiagramError
from ravenbrick.model.flattening import flattened, samples, with_shifts
from ravenbrick.model.linearisation import linear_system
from ravenbrick.model.number_format import Interval

__all__ = ["Key", "key", "narrowed", "real_ranges"]

Key = tuple[ir.Kind, str]
Array = npt.NDArray[np.float64]

_ROUNDS = 60
_MOST_STEPS = 100_000
_REMAINDER = 1e-6
_DIVERGED = 1e100
_SLOWEST = 1e-4


def key(slot: ir.Slot) -> Key:
    """What identifies a variable."""
    return slot.kind, slot.name


def real_ranges(program: ir.Program, given: Mapping[str, Interval]) -> dict[Key, Interval]:
    """The range of every variable.

    `given` by block, or by the name of a state: all Inports, and the states that neither interval
    analysis nor peak gains bound (an integrator has no bound of its own).
    Parameters have the single value they begin with. Raises `DesignError` that names the block
    without a range.
    """
    program = flattened(program)
    ranges: dict[Key, Interval] = {}
    for slot in program.inputs:
        if slot.block not in given:
            raise DesignError(f"Inport '{slot.block}' needs a range for fixed point")
        ranges[key(slot)] = given[slot.block]
    for slot in program.parameters:
        ranges[key(slot)] = Interval(slot.initial, slot.initial)
    stated = {slot.name: given.get(slot.name, given.get(slot.block)) for slot in program.states}
    free = [slot for slot in program.states if stated[slot.name] is None]
    for slot in program.states:
        start, wanted = Interval(slot.initial, slot.initial), stated[slot.name]
        ranges[key(slot)] = start if wanted is None else wanted.hull(start)
    starts = dict(ranges)
    growing = _iterate(program, ranges, free)
    if not growing:
        return ranges
    try:
        _use_peak_gains(program, ranges, free, growing)
    except DesignError:
        ranges = starts
        if not _iterate(program, ranges, free, _landmarks(program)):
            return ranges
        raise
    return ranges


def _landmarks(program: ir.Program) -> list[float]:
    """Where a range that grows may end: the numbers that values are compared with, and one more."""
    found = {0.0}
    for statement in ir.statements(program.statements):
        for node in ir.nodes(statement.expression):
            if isinstance(node, ir.Literal):
                found |= {abs(node.value), abs(node.value) + 1.0}
    return sorted(found)


def _iterate(
    program: ir.Program,
    ranges: dict[Key, Interval],
    free: list[ir.Slot],
    landmarks: list[float] | None = None,
) -> list[ir.Slot]:
    """Grow the free states' ranges until none grows; those that do not end to grow.

    With `landmarks` a growing range grows to the next of them at once.
    """
    fixed = frozenset(key(slot) for slot in program.states) - {key(slot) for slot in free}
    growing: list[ir.Slot] = []
    for _ in range(_ROUNDS):
        before = {key(slot): ranges[key(slot)] for slot in free}
        _pass(program, ranges, fixed)
        for name, interval in before.items():
            ranges[name] = ranges[name].hull(interval)
            if landmarks is not None and ranges[name] != interval:
                ranges[name] = _widened(ranges[name], interval, landmarks)
        growing = [slot for slot in free if ranges[key(slot)] != before[key(slot)]]
        if not growing:
            break
    return growing


def _widened(found: Interval, before: Interval, landmarks: list[float]) -> Interval:
    low, high = found.low, found.high
    if low < before.low:
        low = max((-mark for mark in landmarks if -mark <= low), default=low)
    if high > before.high:
        high = min((mark for mark in landmarks if mark >= high), default=high)
    return Interval(low, high)


def _pass(program: ir.Program, ranges: dict[Key, Interval], kept: frozenset[Key]) -> None:
    for statement in ir.statements(program.statements):
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
    test = select.condition
    sides = [_range(side, ranges, block) for side in (test.left, test.right)]
    for holds, branch in ((True, select.chosen), (False, select.otherwise)):
        known = narrowed(test, sides, ranges, holds=holds)
        if known is not None:
            branches.append(_range(branch, known, block))
    return branches[0].hull(branches[-1])


def narrowed(
    condition: ir.Comparison,
    sides: Sequence[Interval],
    ranges: Mapping[Key, Interval],
    *,
    holds: bool,
    unit: int = 0,
) -> Mapping[Key, Interval] | None:
    """The ranges where the condition holds (or not); None if that cannot be.

    `sides` are the ranges of what is compared, `unit` the least difference of unequal values.
    """
    left, right = sides
    below = (condition.operator in ("<", "<=")) == holds
    apart = unit if (condition.operator in ("<", ">")) == holds else 0
    low = left.low if below else max(left.low, right.low + apart)
    high = min(left.high, right.high - apart) if below else left.high
    if low > high:
        return None
    if not isinstance(condition.left, ir.Read):
        return ranges
    return {**ranges, key(condition.left.slot): Interval(low, high)}


def _use_peak_gains(
    program: ir.Program, ranges: dict[Key, Interval], free: list[ir.Slot], growing: list[ir.Slot]
) -> None:
    """Bound the free states by peak gains, and all other variables by what these leave them.

    A limit counts as absent until its input's range exceeds it; then it is cut: its output is one
    more input of the linear program, as large as the limit. Before a value first exceeds a limit
    that is not cut, the program computes what this linear one does for some of its inputs, so all
    its variables are in their ranges. The first such value would be computed from these, and so
    lie in its own range, which does not exceed the limit: there is none.
    """
    states = frozenset(key(slot) for slot in program.states)
    linear, found = program, dict(ranges)
    while True:
        _bound_by_peak_gains(linear, found, free, growing)
        _pass(linear, found, states)
        before, linear = linear, _without_exceeded_limits(linear, found)
        if len(linear.inputs) == len(before.inputs):
            break
    ranges |= {name: found[name] for name in states}
    _pass(program, ranges, states)


def _without_exceeded_limits(program: ir.Program, ranges: dict[Key, Interval]) -> ir.Program:
    """Each limit that its input's range exceeds becomes an input, with its range."""
    inputs = list(program.inputs)

    def cut(node: ir.Expression) -> ir.Expression:
        if isinstance(node, ir.Clamp):
            limit = Interval.around_zero(_range(node.limit, ranges, program.name).size)
            if not _range(node.value, ranges, program.name).within(limit):
                name = f"limit {len(inputs)}"
                inputs.append(ir.Slot(ir.Kind.INPUT, name, ir.expression_type(node), program.name))
                ranges[key(inputs[-1])] = limit
                return ir.Read(inputs[-1])
        return ir.rebuilt(node, cut)

    statements = ir.mapped(program.statements, cut)
    return replace(program, inputs=tuple(inputs), statements=statements)


def _bound_by_peak_gains(
    program: ir.Program, ranges: dict[Key, Interval], free: list[ir.Slot], growing: list[ir.Slot]
) -> None:
    """Bound the free states by the peak gains of the program, its limits left out, besides what it
    does without inputs: from its initial values, driven by its constants."""
    try:
        system = linear_system(program, constants=True)
    except DiagramError as error:
        raise _unbounded(_first_growing(program, growing)) from error
    states = with_shifts(program).states
    index = {key(slot): place for place, slot in enumerate(states)}
    single = [sample for slot in free for sample in samples(slot)]
    rows = [index[key(slot)] for slot in single]
    matrix = system.A[np.ix_(rows, rows)]
    held = [place for place in range(len(states)) if place not in rows]
    drive = np.hstack([system.B[rows, :-1], system.A[np.ix_(rows, held)]])
    known = {key(one): ranges[key(slot)] for slot in program.states for one in samples(slot)}
    sizes = np.array(
        [ranges[key(slot)].size for slot in program.inputs]
        + [known[key(states[place])].size for place in held]
    )
    alone = np.array([slot.initial for slot in single])
    bound, swing, step = np.zeros(len(rows)), np.abs(alone), np.eye(len(rows))
    for _ in range(_MOST_STEPS):
        bound = bound + np.abs(step @ drive) @ sizes
        step = matrix @ step
        alone = matrix @ alone + system.B[rows, -1]
        swing = np.maximum(swing, np.abs(alone))
        left = np.abs(step).sum()
        if not _REMAINDER <= left < _DIVERGED:
            break
    if not left < _REMAINDER:
        raise _unbounded([single[row] for row in _not_decaying(matrix)])
    # Whatever comes later is at most this share of the whole, of `swing` twice.
    whole = np.linalg.solve(np.eye(len(rows)) - 2 * np.abs(step), bound + swing)
    found = dict(zip(map(key, single), whole, strict=True))
    for slot in free:
        size = max(float(found[key(one)]) for one in samples(slot))
        ranges[key(slot)] = Interval.around_zero(size)


def _unbounded(states: list[ir.Slot]) -> DesignError:
    names = ", ".join(f"'{name}'" for name in dict.fromkeys(slot.block for slot in states))
    return DesignError(
        f"the state of {names} has no bound of its own; give its range: it saturates there"
    )


def _loops(edges: npt.NDArray[np.bool_]) -> tuple[int, npt.NDArray[np.int32]]:
    """How many strongly connected components a graph has, and the component of each node."""
    from scipy.sparse import csgraph  # slow to load

    count, part = csgraph.connected_components(edges, connection="strong")
    return int(count), part


def _not_decaying(matrix: Array) -> list[int]:
    """The rows of the states that keep each other from decaying; what they drive is left out."""
    count, part = _loops(matrix != 0.0)
    found: list[int] = []
    for number in range(count):
        rows = np.flatnonzero(part == number)
        poles = np.linalg.eigvals(matrix[np.ix_(rows, rows)])
        if np.abs(poles).max() > 1.0 - _SLOWEST:
            found += rows.tolist()
    return found or list(range(len(matrix)))


def _first_growing(program: ir.Program, growing: list[ir.Slot]) -> list[ir.Slot]:
    """Those of the growing states that no other growing state drives, loops taken as a whole."""
    names = [key(slot) for slot in growing]
    reads: dict[Key, set[Key]] = {key(slot): {key(slot)} for slot in program.states}
    for statement in ir.statements(program.statements):
        reads[key(statement.target)] = _read_by(statement.expression, reads)
    edges = np.array([[source in reads[target] for source in names] for target in names])
    _, part = _loops(edges)
    driven = {part[target] for target, source in np.argwhere(edges) if part[target] != part[source]}
    return [slot for place, slot in enumerate(growing) if part[place] not in driven]


def _read_by(expression: ir.Expression, reads: Mapping[Key, set[Key]]) -> set[Key]:
    if isinstance(expression, ir.Read):
        return set(reads.get(key(expression.slot), ()))
    return {name for child in ir.children(expression) for name in _read_by(child, reads)}
