# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Statements with their decisions taken: smooth between two instants at which one changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ravenbrick.model import program as ir
from ravenbrick.model.execution import evaluate, holds

__all__ = ["Mode", "Values"]

Values = dict[tuple[ir.Kind, str], Any]
_TOLERANCE = 1e-10  # of a difference, relative to the greater side and at least absolute


@dataclass(frozen=True)
class _Decision:
    """Left minus right keeps its `sign` while the decision stays as it is."""

    left: ir.Expression
    right: ir.Expression
    sign: float

    def distance(self, values: Mapping[tuple[ir.Kind, str], Any]) -> float:
        """Positive while the decision stays; at equality it does."""
        left, right = evaluate(self.left, values), evaluate(self.right, values)
        tolerance = _TOLERANCE * max(abs(left), abs(right), 1.0)
        return float(self.sign * (left - right) + tolerance)


class Mode:
    """Statements and derivatives in which every choice is replaced by the side that is chosen.

    `values` are those of the instant; the statements are executed on them once.
    """

    def __init__(
        self, statements: Sequence[ir.Statement], derivatives: Sequence[ir.Expression],
        values: Values,
    ) -> None:  # fmt: skip
        self._values = values
        self._decisions: list[_Decision] = []
        self._statements: list[ir.Statement] = []
        for one in statements:
            self._statements.append(replace(one, expression=self._decided(one.expression)))
            self._execute(self._statements[-1])
        self._derivatives = [self._decided(one) for one in derivatives]

    def _execute(self, statement: ir.Statement) -> None:
        target = statement.target
        self._values[target.kind, target.name] = evaluate(statement.expression, self._values)

    def execute(self) -> None:
        """The statements, for new values of time and states."""
        for statement in self._statements:
            self._execute(statement)

    def slopes(self) -> list[float]:
        """The derivatives, after the statements."""
        return [float(evaluate(one, self._values)) for one in self._derivatives]

    def distance(self) -> float:
        """To the nearest change of a decision, after the statements; negative beyond it."""
        return min((one.distance(self._values) for one in self._decisions), default=1.0)

    def _decided(self, expression: ir.Expression) -> ir.Expression:
        match expression:
            case ir.Select(condition=condition, chosen=chosen, otherwise=otherwise):
                yes = self._decide(condition)
                return self._decided(chosen if yes else otherwise)
            case ir.Clamp(value=value, limit=limit):
                bound = self._decided(limit)
                zero = ir.Literal(0.0, ir.expression_type(bound))
                negative = ir.Binary("-", zero, bound)
                if self._decide(ir.Comparison(">", value, bound)):
                    return bound
                if self._decide(ir.Comparison("<", value, negative)):
                    return negative
                return self._decided(value)
            case ir.Binary(left=left, right=right):
                return replace(expression, left=self._decided(left), right=self._decided(right))
            case ir.Call(arguments=arguments):
                return replace(expression, arguments=tuple(map(self._decided, arguments)))
            case ir.Cast(value=value) | ir.Rounded(value=value) | ir.Table(value=value):
                return replace(expression, value=self._decided(value))
            case _:
                return expression

    def _decide(self, condition: ir.Comparison) -> bool:
        left, right = self._decided(condition.left), self._decided(condition.right)
        found = holds(ir.Comparison(condition.operator, left, right), self._values)
        above = (condition.operator in (">", ">=")) == found
        if not (isinstance(left, ir.Literal) and isinstance(right, ir.Literal)):
            self._decisions.append(_Decision(left, right, 1.0 if above else -1.0))
        return found
