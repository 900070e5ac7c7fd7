# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How a program assigns its variables, as far as their fixed-point formats depend on it."""

from __future__ import annotations

from collections import Counter

from ravenbrick.model import program as ir
from ravenbrick.model.ranges import Key, key

__all__ = ["multiplied_sums", "plain_stores", "several_times"]


def several_times(program: ir.Program) -> set[Key]:
    """Signals that more than one statement assigns, each under its own condition."""
    assigned = [
        key(statement.target)
        for statement in ir.statements(program.statements)
        if statement.target.kind is ir.Kind.SIGNAL
    ]
    return {name for name, count in Counter(assigned).items() if count > 1}


def multiplied_sums(program: ir.Program) -> set[str]:
    """Signals that a sum adds whose result is multiplied: they get 16 bits before the sum."""
    multiplied = {
        side.slot.name
        for statement in ir.statements(program.statements)
        if isinstance(statement.expression, ir.Binary) and statement.expression.operator == "*"
        for side in (statement.expression.left, statement.expression.right)
        if isinstance(side, ir.Read) and side.slot.kind is ir.Kind.SIGNAL
    }
    found: set[str] = set()
    for statement in ir.statements(program.statements):
        expression = statement.expression
        if statement.target.name not in multiplied or statement.target.kind is not ir.Kind.SIGNAL:
            continue
        if not isinstance(expression, ir.Binary) or expression.operator == "*":
            continue
        inner = [expression]
        while inner:
            node = inner.pop()
            for side in (node.left, node.right):
                if isinstance(side, ir.Binary) and side.operator != "*":
                    inner.append(side)
                elif isinstance(side, ir.Read) and side.slot.kind is ir.Kind.SIGNAL:
                    found.add(side.slot.name)
    products = {
        statement.target.name
        for statement in ir.statements(program.statements)
        if isinstance(statement.expression, ir.Binary) and statement.expression.operator == "*"
    }
    return found & products


def plain_stores(program: ir.Program) -> set[Key]:
    """States whose update only stores a value, as in a delay."""
    return {
        key(statement.target)
        for statement in ir.statements(program.statements)
        if statement.target.kind is ir.Kind.STATE
        and isinstance(statement.expression, ir.Read)
        and not _is_own_signal(statement.expression.slot, statement.block)
    }


def _is_own_signal(slot: ir.Slot, block: str) -> bool:
    return slot.kind is ir.Kind.SIGNAL and slot.block == block
