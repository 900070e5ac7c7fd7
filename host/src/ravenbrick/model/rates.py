# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagram with several rates as linear systems, one per step until all rates have their turn."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

from ravenbrick.model import program as ir
from ravenbrick.model.diagram import Diagram
from ravenbrick.model.linear_system import LinearSystem
from ravenbrick.model.linearisation import linear_system

__all__ = ["systems_of_steps"]


def systems_of_steps(diagram: Diagram | ir.Program) -> tuple[LinearSystem, ...]:
    """`linear_system` of each step of a period, in which the slowest rates run once.

    A diagram with one rate has one. All have the same states: those of the program without its
    counters of steps. In the first step all rates run.
    """
    program = diagram.lower() if isinstance(diagram, Diagram) else diagram
    divisors = {
        slot: divisor
        for one in program.statements
        if isinstance(one, ir.If) and one.block_type == "RateCounter"
        for slot, divisor in [_counted(one)]
    }
    states = tuple(slot for slot in program.states if slot not in divisors)
    return tuple(
        linear_system(
            replace(
                program,
                states=states,
                statements=_of_step(
                    program.statements, {s: step % divisor for s, divisor in divisors.items()}
                ),
            )
        )
        for step in range(math.lcm(*divisors.values()))
    )


def _counted(one: ir.If) -> tuple[ir.Slot, int]:
    """The counter that begins anew when it has reached the divisor less 1."""
    test = one.conditions[0]
    assert isinstance(test.left, ir.Read)
    assert isinstance(test.right, ir.Literal)
    return test.left.slot, int(test.right.value) + 1


def _of_step(
    instructions: Iterable[ir.Instruction], counts: Mapping[ir.Slot, int]
) -> tuple[ir.Instruction, ...]:
    """What runs while the counters have these values."""
    found: list[ir.Instruction] = []
    for one in instructions:
        if not isinstance(one, ir.If) or one.block_type not in ("Rate", "RateCounter"):
            found.append(one)
        elif one.block_type == "Rate":
            guards = [
                test
                for test in one.conditions
                if isinstance(test.left, ir.Read) and test.left.slot in counts
            ]
            others = tuple(test for test in one.conditions if test not in guards)
            if all(_count(test, counts) == 0 for test in guards):
                found += [replace(one, conditions=others)] if others else one.body
    return tuple(found)


def _count(test: ir.Comparison, counts: Mapping[ir.Slot, int]) -> int:
    assert isinstance(test.left, ir.Read)
    return counts[test.left.slot]
