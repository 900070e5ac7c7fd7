# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers in the dialogs of Simulink's blocks: scalars, vectors, matrices, names of variables."""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping

__all__ = ["matrix", "scalar", "vector"]

_OPERATORS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_NAMES = {"pi": math.pi, "inf": math.inf, "Inf": math.inf, "eps": 2.0**-52}
_LONGEST = 2000


def scalar(text: str, variables: Mapping[str, float]) -> float:
    """One number; raises `ValueError` that says what is not understood."""
    text = text.strip()
    if len(text) > _LONGEST:
        raise ValueError(f"an expression of {len(text)} characters")
    if text.startswith("[") and text.endswith("]"):
        return scalar(text[1:-1], variables)
    try:
        tree = ast.parse(
            text.replace(".^", "**").replace("^", "**").replace(".*", "*"), mode="eval"
        )
        return float(_value(tree.body, variables))
    except (SyntaxError, ZeroDivisionError, OverflowError, TypeError, RecursionError) as error:
        raise ValueError(f"the value '{text}' is not a number") from error


def _value(node: ast.expr, variables: Mapping[str, float]) -> float:
    match node:
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.Name(id=name):
            if name in variables:
                return variables[name]
            if name in _NAMES:
                return _NAMES[name]
            raise ValueError(f"the variable '{name}' is not given")
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand, variables)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _value(operand, variables)
        case ast.BinOp(left=left, op=kind, right=right) if type(kind) in _OPERATORS:
            sides = _value(left, variables), _value(right, variables)
            if isinstance(kind, ast.Pow) and abs(sides[1]) > 64:
                raise ValueError("a power above 64")
            return _OPERATORS[type(kind)](*sides)
        case _:
            raise ValueError(f"the expression '{ast.unparse(node)}' is not understood")


def vector(text: str, variables: Mapping[str, float]) -> list[float]:
    """Numbers in brackets, parted by blanks or commas; one number is a vector too."""
    rows = matrix(text, variables)
    if len(rows) == 1:
        return rows[0]
    if all(len(row) == 1 for row in rows):
        return [row[0] for row in rows]
    raise ValueError(f"'{text}' is a matrix, not a vector")


def matrix(text: str, variables: Mapping[str, float]) -> list[list[float]]:
    """Rows parted by semicolons; all of one length."""
    inner = text.strip()
    if not (inner.startswith("[") and inner.endswith("]")):
        return [[scalar(inner, variables)]]
    rows = []
    for row in inner[1:-1].split(";"):
        tight = re.sub(r"\s*([*/^])\s*", r"\1", row.strip())
        words = [word for word in re.split(r"[\s,]+", tight) if word]
        if words:
            rows.append([scalar(word, variables) for word in words])
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise ValueError(f"the rows of '{text}' have different lengths")
    return rows
