# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers in the dialogs of Simulink's blocks: scalars, vectors, matrices, names of variables."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ravenbrick.simulink.expressions import Apply, Infix, Name, Number, Prefix, Rows, Span, Tree
from ravenbrick.simulink.expressions import parse as parse_expression

__all__ = [
    "Variables", "Workspace", "call", "evaluate", "matrix", "places", "scalar", "value_of",
    "vector",
]  # fmt: skip

Variables = Mapping[str, "float | np.ndarray"]

_MOST_ELEMENTS = 100_000
_HIGHEST_DEGREE = 1000
_NAMES = {
    "pi": math.pi, "inf": math.inf, "Inf": math.inf, "eps": 2.0**-52, "true": 1.0, "false": 0.0,
    "nan": math.nan, "NaN": math.nan,
}  # fmt: skip
_OPERATORS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "+": np.add, "-": np.subtract, ".*": np.multiply, "./": np.divide, "<": np.less,
    "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal,
    "==": np.equal, "~=": np.not_equal, "&": np.logical_and, "&&": np.logical_and,
    "|": np.logical_or, "||": np.logical_or,
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
    "logical": lambda v: 1.0 * (v != 0), "inv": np.linalg.inv,
    "diag": lambda v: np.diag(v.ravel()) if 1 in v.shape else np.diag(v)[:, np.newaxis],
    "sum": lambda v: np.sum(v, axis=0 if len(v) > 1 else 1),
    "prod": lambda v: np.prod(v, axis=0 if len(v) > 1 else 1),
    "length": lambda v: np.array(float(max(v.shape))), "numel": lambda v: np.array(float(v.size)),
    "size": lambda v: np.array([v.shape]), "isempty": lambda v: np.array(v.size == 0),
    "transpose": np.transpose, "det": lambda v: np.array(np.linalg.det(v)),
    "norm": lambda v: np.array(np.linalg.norm(v, 2)), "trace": lambda v: np.array(np.trace(v)),
    "rank": lambda v: np.array(float(np.linalg.matrix_rank(v))), "pinv": np.linalg.pinv,
    "eig": lambda v: _real(np.linalg.eigvals(v)),
    "roots": lambda v: _real(np.roots(_short(v))),
    "poly": lambda v: np.poly(v if v.shape[0] == v.shape[1] > 1 else _short(v))[np.newaxis],
    "expm": lambda v: _exponential(v), "fliplr": np.fliplr, "flipud": np.flipud,
    "diff": lambda v: np.diff(v, axis=0 if len(v) > 1 else 1),
    "cumsum": lambda v: np.cumsum(v, axis=0 if len(v) > 1 else 1),
    "mean": lambda v: np.mean(v, axis=0 if len(v) > 1 else 1),
    "sinc": np.sinc, "any": lambda v: np.array(np.any(v)), "all": lambda v: np.array(np.all(v)),
    **{f"int{bits}": _limited(-(2.0 ** (bits - 1)), 2.0 ** (bits - 1) - 1)
       for bits in (8, 16, 32)},
    **{f"uint{bits}": _limited(0, 2.0**bits - 1) for bits in (8, 16, 32)},
}  # fmt: skip
_TWO: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "atan2": np.arctan2, "mod": np.mod, "rem": np.fmod, "min": np.minimum, "max": np.maximum,
    "power": np.power, "times": np.multiply, "size": lambda v, axis: _size(v, int(axis[0, 0])),
    "conv": lambda v, w: np.convolve(_short(v), _short(w))[np.newaxis],
    "kron": lambda v, w: np.kron(v, w) if v.size * w.size <= _MOST_ELEMENTS else _too_large(),
    "dot": lambda v, w: np.array(np.sum(v * w)), "hypot": np.hypot,
    "cross": lambda v, w: np.cross(v.ravel(), w.ravel()).reshape(v.shape),
}  # fmt: skip
_SHAPES: dict[str, Callable[[list[int]], np.ndarray]] = {
    "zeros": np.zeros, "ones": np.ones, "eye": lambda sizes: np.eye(sizes[0], sizes[1]),
}  # fmt: skip


def _size(value: np.ndarray, axis: int) -> np.ndarray:
    if axis < 1:
        raise ValueError("dimensions are counted from 1")
    return np.array(float(value.shape[axis - 1] if axis <= 2 else 1))


def _real(values: np.ndarray) -> np.ndarray:
    """A column, in order of size; raises `ValueError` for complex numbers."""
    if np.any(np.abs(np.imag(values)) > 1e-12 * np.abs(values)):
        raise ValueError("the values are complex; signals are real numbers")
    return np.asarray(np.sort(np.real(values))[:, np.newaxis])


def _short(values: np.ndarray) -> np.ndarray:
    """The coefficients or roots of a polynomial."""
    if values.size > _HIGHEST_DEGREE:
        raise ValueError(f"a polynomial of {values.size} coefficients")
    return values.ravel()


def _too_large() -> np.ndarray:
    raise ValueError(f"a matrix of more than {_MOST_ELEMENTS} elements")


def _exponential(value: np.ndarray) -> np.ndarray:
    from scipy.linalg import expm  # slow to load

    return np.asarray(expm(value))


_FUNCTIONS = frozenset([*_ONE, *_TWO, *_SHAPES, "linspace", "logspace", "repmat"])


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

    def known(self) -> Workspace:
        """The same without guesses."""
        return Workspace(self) if self.guess else self

    def guesses(self, text: str) -> bool:
        """Whether an expression has a value only by a guess."""
        return self.guess and self.sure(text) is None

    def sure(self, text: str) -> np.ndarray | None:
        """The matrix that an expression stands for without guesses; None if it has none."""
        guess, self.guess = self.guess, False  # no copy, as there may be thousands of variables
        try:
            return value_of(text, self)
        except ValueError:
            return None
        finally:
            self.guess = guess

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
    if operator in ("^", ".^"):
        if np.abs(right).max(initial=0) > 64:
            raise ValueError("a power above 64")
        if operator == ".^" or left.size == 1:
            return np.asarray(np.power(left, right))
        if right.size > 1 or right[0, 0] != round(right[0, 0]) or left.shape[0] != left.shape[1]:
            raise ValueError("a power of a matrix that is not square, or not by a whole number")
        return np.asarray(np.linalg.matrix_power(left, round(right[0, 0])))
    single = left.size == 1 or right.size == 1
    if operator == "*" and not single:
        if left.shape[1] != right.shape[0]:
            raise ValueError(
                f"a matrix with {left.shape[1]} columns times one with {right.shape[0]} rows"
            )
        return np.asarray(left @ right)
    if operator == "/" and right.size > 1:
        return _solved(right.T, left.T).T
    if operator == "\\":
        return _solved(left, right)
    return 1.0 * _OPERATORS[f".{operator}" if operator in "*/" else operator](left, right)


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """X with matrix X = right, by least squares if the matrix is not square."""
    if matrix.size == 1:
        return np.asarray(right / matrix)
    if matrix.shape[0] != right.shape[0]:
        raise ValueError(f"{matrix.shape[0]} equations with {right.shape[0]} right sides")
    if matrix.shape[0] == matrix.shape[1]:
        return np.asarray(np.linalg.solve(matrix, right))
    return np.asarray(np.linalg.lstsq(matrix, right)[0])


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
    return call(name, [evaluate(one, variables) for one in arguments])


def call(name: str, given: list[np.ndarray]) -> np.ndarray:
    """A mathematical function of matrices; raises `ValueError` for one that is not known."""
    if name in _ONE and len(given) == 1:
        return _ONE[name](given[0])
    if name in _TWO and len(given) == 2:
        return _TWO[name](*given)
    if name in ("min", "max") and len(given) == 1:
        return np.asarray(getattr(np, name)(given[0], axis=0 if len(given[0]) > 1 else 1))
    if name == "linspace" and len(given) == 3 and given[2][0, 0] <= _MOST_ELEMENTS:
        return np.linspace(given[0][0, 0], given[1][0, 0], int(given[2][0, 0]))
    if name == "logspace" and len(given) == 3 and given[2][0, 0] <= _MOST_ELEMENTS:
        return np.logspace(given[0][0, 0], given[1][0, 0], int(given[2][0, 0]))
    if name == "repmat" and 2 <= len(given) <= 3:
        turns = [int(one) for value in given[1:] for one in value.ravel()]
        turns = turns * 2 if len(turns) == 1 else turns
        if min(turns) < 0 or given[0].size * math.prod(turns) > _MOST_ELEMENTS:
            raise ValueError(f"a matrix repeated {' x '.join(map(str, turns))} times")
        return np.tile(given[0], turns)
    if name in _SHAPES and 1 <= len(given) <= 2:
        sizes = [int(one) for value in given for one in value.ravel()]
        sizes = sizes * 2 if len(sizes) == 1 else sizes
        if len(sizes) != 2 or not 0 <= sizes[0] * sizes[1] <= _MOST_ELEMENTS or min(sizes) < 0:
            raise ValueError(f"a matrix of {' x '.join(map(str, sizes))} elements")
        return np.asarray(_SHAPES[name](sizes))
    raise ValueError(f"the function or variable '{name}' is not known")


def _elements(value: np.ndarray, arguments: tuple[Tree, ...], variables: Variables) -> np.ndarray:
    """Elements counted from 1, by one place or by row and column."""
    found = places(value.shape, arguments, variables)
    if len(found) == 1:
        chosen: np.ndarray = value.T.ravel()[found[0]]
        column = value.shape[1] == 1 or arguments[0] == Name(":")
        return chosen[:, np.newaxis] if column else chosen[np.newaxis]
    part: np.ndarray = value[np.ix_(found[0], found[1])]
    return part


def places(
    shape: tuple[int, ...], arguments: tuple[Tree, ...], variables: Variables
) -> list[np.ndarray]:
    """What indices mean, counted from 0: one of all elements by columns, or rows and columns."""
    found = []
    for axis, one in enumerate(arguments):
        size = math.prod(shape) if len(arguments) == 1 else shape[axis]
        if one == Name(":"):
            found.append(np.arange(size))
        else:
            known = variables if isinstance(variables, Workspace) else Workspace(variables)
            found.append(evaluate(one, known.inside({"end": size})).astype(int).ravel() - 1)
        if (found[-1] < 0).any():
            raise ValueError("elements are counted from 1")
    return found


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
