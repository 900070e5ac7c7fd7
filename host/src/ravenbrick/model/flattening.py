# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The same program as a plain sequence of assignments, for analyses that know nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from ravenbrick.model import program as ir

__all__ = ["flattened", "samples", "with_shifts"]


def flattened(program: ir.Program) -> ir.Program:
    """Conditions of instructions become choices between values; the results are the same.

    A signal that is assigned under a condition and read there only is computed always.
    """
    return replace(program, statements=tuple(_flat(program.statements)))


def _flat(instructions: Iterable[ir.Instruction]) -> list[ir.Statement]:
    found: list[ir.Statement] = []
    for one in instructions:
        match one:
            case ir.Statement():
                found.append(one)
            case ir.Restart(states=states):
                found += [
                    ir.Statement(s, ir.Literal(s.initial, s.data_type), one.block, one.block_type)
                    for s in states
                ]
            case ir.If(conditions=conditions, body=body, otherwise=otherwise):
                chosen, other = _flat(body), _flat(otherwise)
                for test in reversed(conditions):
                    chosen = _joined(test, chosen, other)
                found += chosen
            case ir.Case(selector=selector, branches=branches):
                chosen = _flat(branches[-1])
                for place in range(len(branches) - 2, -1, -1):
                    literal = ir.Literal(place, selector.data_type)
                    test = ir.Comparison("<=", ir.Read(selector), literal)
                    chosen = _joined(test, _flat(branches[place]), chosen)
                found += chosen
    return found


def _joined(
    condition: ir.Comparison, body: list[ir.Statement], otherwise: list[ir.Statement]
) -> list[ir.Statement]:
    """Each variable once, in the order in which the longer side assigns them."""
    first = {statement.target: statement for statement in body}
    second = {statement.target: statement for statement in otherwise}
    order = [*first, *(target for target in second if target not in first)]
    found = []
    for target in order:
        own, other = first.get(target), second.get(target)
        statement = own or other
        assert statement is not None
        if target.kind is not ir.Kind.SIGNAL or (own is not None and other is not None):
            kept = ir.Read(target)
            expression = ir.Select(
                condition,
                kept if own is None else own.expression,
                kept if other is None else other.expression,
            )
            statement = replace(statement, expression=expression)
        found.append(statement)
    return found


def with_shifts(program: ir.Program) -> ir.Program:
    """Each delay line as single samples that move on by one, the newest in the first state."""
    lines = {slot.name: samples(slot) for slot in program.states if isinstance(slot, ir.DelayLine)}
    if not lines:
        return program

    def oldest(expression: ir.Expression) -> ir.Expression:
        match expression:
            case ir.Read(slot=ir.DelayLine(name=name)):
                return ir.Read(lines[name][-1])
            case _:
                return ir.rebuilt(expression, oldest)

    states = tuple(s for slot in program.states for s in samples(slot))
    instructions = ir.mapped(program.statements, oldest)
    return replace(program, states=states, statements=_shifting(instructions, lines))


def _shifting(
    instructions: Iterable[ir.Instruction], lines: Mapping[str, list[ir.Slot]]
) -> tuple[ir.Instruction, ...]:
    found: list[ir.Instruction] = []
    for one in instructions:
        match one:
            case ir.Statement(target=ir.DelayLine(name=name)):
                line = lines[name]
                for place in range(len(line) - 1, 0, -1):
                    moved = ir.Read(line[place - 1])
                    found.append(replace(one, target=line[place], expression=moved))
                found.append(replace(one, target=line[0]))
            case ir.If(body=body, otherwise=otherwise):
                inner = _shifting(body, lines), _shifting(otherwise, lines)
                found.append(replace(one, body=inner[0], otherwise=inner[1]))
            case ir.Restart(states=states):
                found.append(replace(one, states=tuple(x for s in states for x in samples(s))))
            case _:
                found.append(one)
    return tuple(found)


def samples(slot: ir.Slot) -> list[ir.Slot]:
    """The states that stand for a delay line, the newest first; any other state itself."""
    if not isinstance(slot, ir.DelayLine):
        return [slot]
    return [
        ir.Slot(slot.kind, f"{slot.name}{place}", slot.data_type, slot.block, slot.initial)
        for place in range(1, slot.length + 1)
    ]
