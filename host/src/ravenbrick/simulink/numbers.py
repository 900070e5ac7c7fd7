# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers in the dialogs of Simulink's blocks: scalars, vectors, matrices, names of variables."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ravenbrick.simulink.expressions import Apply, Infix, Name, Number, Prefix, Rows, Span, Tree
from ravenbrick.simulink.expressions import parse as parse_expression

__all__ = ["Variables", "Workspace", "evaluate", "matrix", "scalar", "value_of", "vector"]

Variables = Mapping[str, "float | np.ndarray"]

_MOST_ELEMENTS = 100_000
_NAMES = {
    "pi": math.pi, "inf": math.inf, "Inf": math.inf, "eps": 2.0**-52, "true": 1.0, "false": 0.0,
}  # fmt: skip
_OPERATORS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "+": np.add, "-": np.subtract, "/": np.divide, "<": np.less, "<=": np.less_equal,
    ">": np.greater, ">=": np.greater_equal, "==": np.equal, "~=": np.not_equal,
    "&": np.logical_and, "&&": np.logical_and, "|": np.logical_or, "||": np.logical_or,
}  # fmt: skip


def _half_away(value: np.ndarray) -> np.ndarray:
    return np.asarray(np.sign(value) * np.floor(np.abs(value) + 0.5))


def _limited(low: float, high: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda value: np.clip(_half_away(value), low, high)


_ONE: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    **{name: getattr(np, name) for name in (
        "sin", "cos", "tan", "sqrt", "abs", "exp", "log", "log10", "floor", "ceil", "fix", "sign",
        "sinh", "cosh", "tanh", "deg2rad", "rad2deg",
    )},
    "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "round": _half_away,
    "double": np.positive, "single": np.positive, "boolean": lambda v: 1.0 * (v != 0),
    "logical": lambda v: 1.0 * (v != 0), "inv": np.linalg.inv, "diag": np.diag,
    "sum": lambda v: np.sum(v, axis=0 if len(v) > 1 else 1),
    "prod": lambda v: np.prod(v, axis=0 if len(v) > 1 else 1),
    "length": lambda v: np.array(float(max(v.shape))), "numel": lambda v: np.array(float(v.size)),
    **{f"int{bits}": _limited(-(2.0 ** (bits - 1)), 2.0 ** (bits - 1) - 1)
       for bits in (8, 16, 32)},
    **{f"uint{bits}": _limited(0, 2.0**bits - 1) for bits in (8, 16, 32)},
}  # fmt: skip
_TWO: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "atan2": np.arctan2, "mod": np.mod, "rem": np.fmod, "min": np.minimum, "max": np.maximum,
    "power": np.power, "times": np.multiply,
}  # fmt: skip
_SHAPES = {"zeros": np.zeros, "ones": np.ones}


_FUNCTIONS = frozenset([*_ONE, *_TWO, *_SHAPES, "linspace"])


class Workspace(dict[str, "float | np.ndarray"]):
    """Variables by name; with `guess` each that is not given counts as 1."""

    def __init__(self, given: Variables, *, guess: bool = False) -> None:
        super().__init__(given)
        self.guess = guess

    def __contains__(self, name: object) -> bool:
        if super().__contains__(name):
            return True
        return self.guess and name not in _NAMES and name not in _FUNCTIONS and name != ":"

    def __missing__(self, name: str) -> float:
        return 1.0

    def inside(self, more: Variables) -> Workspace:
        """The variables inside a masked subsystem."""
        return Workspace({**self, **more}, guess=self.guess)


def value_of(text: str, variables: Variables) -> np.ndarray:
    """The matrix that an expression stands for; raises `ValueError` with what is wrong."""
    return evaluate(parse_expression(text), variables)


def evaluate(tree: Tree, variables: Variables) -> np.ndarray:
    """The matrix that a tree stands for; a number is a matrix of one element."""
    try:
        with np.errstate(all="ignore"):
            found: np.ndarray = np.atleast_2d(np.asarray(_value(tree, variables), float))
            return found
    except (ZeroDivisionError, OverflowError, TypeError, RecursionError, IndexError) as error:
        raise ValueError(f"the expression is not a number: {error}") from error
    except np.linalg.LinAlgError as error:
        raise ValueError(f"the matrix is not invertible: {error}") from error


def _value(tree: Tree, variables: Variables) -> np.ndarray:
    match tree:
        case Number(value=number):
            return np.array([[number]])
        case Name(text=name):
            return _variable(name, variables)
        case Prefix(operator=operator, operand=operand):
            value = evaluate(operand, variables)
            if operator == "'":
                return value.T
            if operator == "~":
                return np.asarray(1.0 * (value == 0))
            return -value if operator == "-" else value
        case Infix(operator=operator, left=left, right=right):
            return _infix(operator, evaluate(left, variables), evaluate(right, variables))
        case Span(first=first, step=step, last=last):
            ends = [float(evaluate(end, variables)[0, 0]) for end in (first, step, last)]
            return _span(*ends)
        case Apply(name=name, arguments=arguments):
            return _apply(name, arguments, variables)
        case Rows(rows=rows):
            return _rows([[evaluate(one, variables) for one in row] for row in rows])


def _variable(name: str, variables: Variables) -> np.ndarray:
    if name in variables:
        return np.atleast_2d(np.asarray(variables[name], float))
    if name in _NAMES:
        return np.array([[_NAMES[name]]])
    raise ValueError(f"the variable '{name}' is not given")


def _infix(operator: str, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    if operator == "^":
        if np.abs(right).max(initial=0) > 64:
            raise ValueError("a power above 64")
        return np.asarray(np.power(left, right))
    if operator == "*":
        plain = left.size == 1 or right.size == 1 or left.shape == right.shape
        return np.asarray(left * right if plain else left @ right)
    return 1.0 * _OPERATORS[operator](left, right)


def _span(first: float, step: float, last: float) -> np.ndarray:
    count = math.floor((last - first) / step + 1e-9) + 1 if step else 0
    if count > _MOST_ELEMENTS:
        raise ValueError(f"a range of {count} elements")
    return (first + step * np.arange(max(count, 0)))[np.newaxis]


def _rows(rows: list[list[np.ndarray]]) -> np.ndarray:
    if not rows:
        return np.zeros((0, 0))
    try:
        return np.vstack([np.hstack(row) for row in rows])
    except ValueError as error:
        raise ValueError("the rows of a matrix have different lengths") from error


def _apply(name: str, arguments: tuple[Tree, ...], variables: Variables) -> np.ndarray:
    if name in variables:
        if isinstance(variables, Workspace) and name not in dict.keys(variables):
            return np.ones((1, 1))
        return _elements(_variable(name, variables), arguments, variables)
    given = [evaluate(one, variables) for one in arguments]
    if name in _ONE and len(given) == 1:
        return _ONE[name](given[0])
    if name in _TWO and len(given) == 2:
        return _TWO[name](*given)
    if name in ("min", "max") and len(given) == 1:
        return np.asarray(getattr(np, name)(given[0]))
    if name == "linspace" and len(given) == 3 and given[2][0, 0] <= _MOST_ELEMENTS:
        return np.linspace(given[0][0, 0], given[1][0, 0], int(given[2][0, 0]))
    if name in _SHAPES and 1 <= len(given) <= 2:
        sizes = [int(one[0, 0]) for one in given] * (1 if len(given) == 2 else 2)
        if not 0 <= sizes[0] * sizes[1] <= _MOST_ELEMENTS:
            raise ValueError(f"a matrix of {sizes[0]} x {sizes[1]} elements")
        return _SHAPES[name](sizes)
    raise ValueError(f"the function or variable '{name}' is not known")


def _elements(value: np.ndarray, arguments: tuple[Tree, ...], variables: Variables) -> np.ndarray:
    """Elements counted from 1, by one place or by row and column."""
    places = []
    for axis, one in enumerate(arguments):
        if one == Name(":"):
            size = value.size if len(arguments) == 1 else value.shape[axis]
            places.append(np.arange(size))
        else:
            places.append(evaluate(one, variables).astype(int).ravel() - 1)
        if (places[-1] < 0).any():
            raise ValueError("elements are counted from 1")
    if len(places) == 1:
        return value.T.ravel()[places[0]]
    return value[np.ix_(places[0], places[1])]


def scalar(text: str, variables: Variables) -> float:
    """One number; raises `ValueError` that says what is not understood."""
    value = value_of(text, variables)
    if value.size != 1:
        raise ValueError(f"'{text.strip()}' has {value.size} elements and is not a number")
    return float(value[0, 0])


def vector(text: str, variables: Variables) -> list[float]:
    """The elements of a row or a column; one number is a vector too."""
    value = value_of(text, variables)
    if min(value.shape) > 1:
        raise ValueError(f"'{text.strip()}' is a matrix, not a vector")
    return [float(one) for one in value.ravel()]


def matrix(text: str, variables: Variables) -> list[list[float]]:
    """Rows of numbers, all of one length."""
    return [[float(one) for one in row] for row in value_of(text, variables)]
