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

__all__ = ["sample_times", "systems_of_steps"]


def systems_of_steps(diagram: Diagram | ir.Program) -> tuple[LinearSystem, ...]:
    """`linear_system` of each step of a period, in which the slowest rates run once.

    A diagram with one rate has one. All have the same states: those of the program without its
    counters of steps. In the first step all rates run.
    """
    program = diagram.lower() if isinstance(diagram, Diagram) else diagram
    divisors = _divisors(program)
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


def sample_times(program: ir.Program) -> dict[str, float]:
    """Those of blocks that do not run in each step."""
    divisors = _divisors(program)
    return {
        statement.block: program.sample_time
        * math.lcm(*(divisors.get(slot, 1) for slot in map(_tested, one.conditions)))
        for one in program.statements
        if isinstance(one, ir.If) and one.block_type == "Rate"
        for statement in ir.statements((one,))
    }


def _tested(test: ir.Comparison) -> ir.Slot | None:
    return test.left.slot if isinstance(test.left, ir.Read) else None


def _divisors(program: ir.Program) -> dict[ir.Slot | None, int]:
    """Of each counter of steps, after how many it begins anew."""
    return dict(
        _counted(one)
        for one in program.statements
        if isinstance(one, ir.If) and one.block_type == "RateCounter"
    )


def _counted(one: ir.If) -> tuple[ir.Slot, int]:
    """The counter that begins anew when it has reached the divisor less 1."""
    test = one.conditions[0]
    assert isinstance(test.left, ir.Read)
    assert isinstance(test.right, ir.Literal)
    return test.left.slot, int(test.right.value) + 1


def _of_step(
    instructions: Iterable[ir.Instruction], counts: Mapping[ir.Slot | None, int]
) -> tuple[ir.Instruction, ...]:
    """What runs while the counters have these values."""
    found: list[ir.Instruction] = []
    for one in instructions:
        if not isinstance(one, ir.If) or one.block_type not in ("Rate", "RateCounter"):
            found.append(one)
        elif one.block_type == "Rate":
            others = tuple(test for test in one.conditions if _tested(test) not in counts)
            if all(counts.get(_tested(test), 0) == 0 for test in one.conditions):
                found += [replace(one, conditions=others)] if others else one.body
    return tuple(found)
