# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Which block of a step function declares a local variable: the narrowest with all its uses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from ravenbrick.model import program as ir

__all__ = ["ACCUMULATOR", "FILL_INDEX", "WIDE_ACCUMULATOR", "Local", "declared_here"]

# Variables of the generated text itself: a sum before its limits, and the place in a delay line.
ACCUMULATOR = "accumulator"
WIDE_ACCUMULATOR = "wide_accumulator"
FILL_INDEX = "fill_index"

Local = ir.Slot | str


def declared_here(
    block: Sequence[ir.Instruction], given: Sequence[Local]
) -> tuple[list[Local], list[Local]]:
    """Of the variables that no other block uses: those to declare in this one, and the others.

    The others are used in exactly one of the blocks inside this one.
    """
    own: set[Local] = set()
    inner: Counter[Local] = Counter()
    for one in _in_line(block):
        own.update(_uses(one))
        if isinstance(one, ir.If):
            for part in (one.body, one.otherwise):
                inner.update(set(_all_uses(part)))
    here = [local for local in given if local in own or inner[local] > 1]
    return here, [local for local in given if local not in own and inner[local] == 1]


def _in_line(block: Sequence[ir.Instruction]) -> Iterator[ir.Instruction]:
    """The instructions of a block with those of its cases, which declare nothing."""
    for one in block:
        yield one
        if isinstance(one, ir.Case):
            for branch in one.branches:
                yield from _in_line(branch)


def _all_uses(block: Sequence[ir.Instruction]) -> Iterator[Local]:
    for one in _in_line(block):
        yield from _uses(one)
        if isinstance(one, ir.If):
            yield from _all_uses((*one.body, *one.otherwise))


def _uses(one: ir.Instruction) -> Iterator[Local]:
    """What an instruction assigns and reads, without the instructions inside it."""
    outermost: tuple[ir.Expression, ...] = ()
    match one:
        case ir.Statement(target=target, expression=expression):
            yield target
            outermost = (expression,)
            if isinstance(expression, ir.Bounded):
                yield WIDE_ACCUMULATOR if ir.is_wide(expression) else ACCUMULATOR
        case ir.If(conditions=conditions):
            outermost = tuple(side for test in conditions for side in (test.left, test.right))
        case ir.Restart(states=states):
            if any(isinstance(slot, ir.DelayLine) for slot in states):
                yield FILL_INDEX
        case ir.Case(selector=selector):
            yield selector
    for expression in outermost:
        for node in ir.nodes(expression):
            if isinstance(node, ir.Read):
                yield node.slot
