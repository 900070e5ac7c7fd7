# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Matrices whose elements are numbers or signals, and the blocks that compute with them.

An array is two-dimensional. One of floats is a constant; one of objects holds floats and wires.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce

import numpy as np

from ravenbrick.simulink.blocks.elementary import ONE, TWO
from ravenbrick.simulink.blocks.functions import power
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.expressions import Infix, Name
from ravenbrick.simulink.numbers import call, evaluate
from ravenbrick.simulink.signals import Wire

__all__ = ["Arrays", "array_of", "is_constant"]

Element = float | Wire
_TESTS = ("==", "~=", "<", "<=", ">", ">=")
_LOGIC = {"&": "AND", "&&": "AND", "|": "OR", "||": "OR"}
_LARGEST_INVERSE = 4
_MOST_FACTORS = 8
_OF_SHAPES = ("size", "length", "numel", "isempty")


def is_constant(array: np.ndarray) -> bool:
    """Whether it holds numbers only."""
    return array.dtype != object


def array_of(elements: list[Element], rows: int, columns: int) -> np.ndarray:
    """An array from its elements by columns; of floats if no element is a signal."""
    found = np.empty(len(elements), dtype=object)
    found[:] = elements
    whole = all(isinstance(one, float | int) for one in elements)
    return (found.astype(float) if whole else found).reshape((rows, columns), order="F")


def _like(shape: tuple[int, ...], elements: list[Element]) -> np.ndarray:
    return array_of(elements, shape[0], shape[1])


def _flat(array: np.ndarray) -> list[Element]:
    return list(array.ravel(order="F"))


class Arrays:
    """Arithmetic of arrays, which adds blocks to a builder."""

    def __init__(self, b: Builder) -> None:
        self._b = b

    def _product(self, left: Element, right: Element) -> Element:
        if isinstance(left, float | int) and isinstance(right, float | int):
            return float(left * right)
        if isinstance(right, float | int):
            left, right = right, left
        if isinstance(left, float | int):
            return 0.0 if left == 0.0 else self._b.scaled(float(left), self._b.element(right))
        return self._b.product(left, self._b.element(right))

    def _quotient(self, left: Element, right: Element) -> Element:
        if isinstance(right, float | int):
            if right == 0.0:
                raise ValueError("a division by 0")
            return self._product(left, 1.0 / right)
        return self._b.product(self._b.element(left), right, operators="*/")

    def _total(self, terms: list[tuple[str, Element]]) -> Element:
        """A sum of terms with their signs."""
        number = math.fsum(float(e) if sign == "+" else -float(e) for sign, e in terms
                           if isinstance(e, float | int))  # fmt: skip
        wires = [(sign, e) for sign, e in terms if not isinstance(e, float | int)]
        if not wires:
            return number
        signs = "".join(sign for sign, _ in wires) + ("+" if number else "")
        more = [self._b.element(number)] if number else []
        return self._b.sum(*(e for _, e in wires), *more, signs=signs)

    def _power(self, base: Element, exponent: Element) -> Element:
        if not isinstance(exponent, float | int):
            return power(self._b, self._b.element(base), exponent)
        whole = float(exponent).is_integer() and 1 <= abs(exponent) <= _MOST_FACTORS
        if exponent == 0.0:
            return 1.0
        if exponent == 1.0:
            return base
        if exponent == 0.5:
            return ONE["sqrt"](self._b, self._b.element(base))
        if not whole:
            return power(self._b, self._b.element(base), self._b.element(float(exponent)))
        found = self._b.product(*[self._b.element(base)] * int(abs(exponent)))
        return found if exponent > 0 else self._quotient(1.0, found)

    def _one(self, operator: str, left: Element, right: Element) -> Element:
        """One element of two."""
        if isinstance(left, float | int) and isinstance(right, float | int):
            tree = Infix(operator, Name("x"), Name("y"))
            return float(evaluate(tree, {"x": float(left), "y": float(right)})[0, 0])
        if operator in ("+", "-"):
            return self._total([("+", left), (operator, right)])
        if operator in _TESTS:
            return self._b.compare(self._b.element(left), operator, self._b.element(right))
        if operator in _LOGIC:
            return self._b.logic(_LOGIC[operator], self._b.element(left), self._b.element(right))
        kinds = {"*": self._product, "/": self._quotient, "^": self._power}
        return kinds[operator.lstrip(".")](left, right)

    def each(self, make: Callable[..., Element], *given: np.ndarray) -> np.ndarray:
        """Element by element; an array of one element goes with each of the other."""
        try:
            whole = np.broadcast_arrays(*given)
        except ValueError as error:
            sizes = " and ".join(f"{a.shape[0]} x {a.shape[1]}" for a in given)
            raise ValueError(f"matrices of {sizes} elements do not fit") from error
        return _like(whole[0].shape, [make(*pair) for pair in zip(*map(_flat, whole), strict=True)])

    def infix(self, operator: str, left: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Two arrays and an operator between them."""
        single = left.size == 1 or right.size == 1
        if operator == "*" and not single:
            return self.times(left, right)
        if operator == "/" and right.size > 1:
            return self.times(left, self.inverse(right))
        if operator == "\\":
            return self.times(self.inverse(left), right) if left.size > 1 else self.infix(
                "/", right, left)  # fmt: skip
        if operator == "^" and max(left.size, right.size) > 1:
            return self._matrix_power(left, right)
        return self.each(lambda x, y: self._one(operator, x, y), left, right)

    def times(self, left: np.ndarray, right: np.ndarray) -> np.ndarray:
        """The matrix product."""
        if left.shape[1] != right.shape[0]:
            raise ValueError(
                f"a matrix with {left.shape[1]} columns times one with {right.shape[0]} rows"
            )
        return array_of([self._dot(list(row), list(column)) for column in right.T for row in left],
                        left.shape[0], right.shape[1])  # fmt: skip

    def _dot(self, left: list[Element], right: list[Element]) -> Element:
        return self._total([("+", self._product(*pair)) for pair in zip(left, right, strict=True)])

    def _matrix_power(self, base: np.ndarray, exponent: np.ndarray) -> np.ndarray:
        if not is_constant(exponent) or exponent.size > 1 or abs(exponent[0, 0]) > _MOST_FACTORS:
            raise ValueError(
                "a power of a matrix that is a signal, but not by a small whole number"
            )
        count = float(exponent[0, 0])
        if not count.is_integer() or count == 0.0:
            raise ValueError(f"a matrix to the power of {count:g}")
        factor = base if count > 0 else self.inverse(base)
        found = factor
        for _ in range(int(abs(count)) - 1):
            found = self.times(found, factor)
        return found

    def determinant(self, matrix: np.ndarray) -> Element:
        """By minors along the first column."""
        if matrix.shape[0] != matrix.shape[1] or len(matrix) > _LARGEST_INVERSE:
            sizes = f"{matrix.shape[0]} x {matrix.shape[1]}"
            raise ValueError(
                f"the inverse or determinant of a signal of {sizes} elements; it must be square "
                f"and not larger than {_LARGEST_INVERSE} x {_LARGEST_INVERSE}"
            )
        if len(matrix) == 1:
            only: Element = matrix[0, 0]
            return only
        minors = [self.determinant(_without(matrix, row, 0)) for row in range(len(matrix))]
        return self._total([("-" if row % 2 else "+", self._product(matrix[row, 0], minor))
                            for row, minor in enumerate(minors)])  # fmt: skip

    def inverse(self, matrix: np.ndarray) -> np.ndarray:
        """The adjugate over the determinant."""
        whole = self.determinant(matrix)
        if is_constant(matrix):
            return call("inv", [matrix])
        size = len(matrix)
        if size == 1:
            return array_of([self._quotient(1.0, whole)], 1, 1)
        over = self._quotient(1.0, whole)
        return array_of(
            [self._product(over, self._total([("-" if (row + column) % 2 else "+",
                           self.determinant(_without(matrix, column, row)))]))
             for column in range(size) for row in range(size)], size, size)  # fmt: skip

    def call(self, name: str, given: list[np.ndarray]) -> np.ndarray:
        """A mathematical function; raises `ValueError` for one without counterpart."""
        if name in _OF_SHAPES:
            given = [np.zeros(given[0].shape), *given[1:]]
        if all(map(is_constant, given)):
            return np.atleast_2d(np.asarray(call(name, given), float))
        if name in ONE and len(given) == 1:
            return self.each(lambda x: ONE[name](self._b, self._b.element(x)), given[0])
        if name in ("pow", "power"):
            return self.each(self._power, *given)
        if name in TWO and len(given) == 2:
            return self.each(
                lambda x, y: TWO[name](self._b, self._b.element(x), self._b.element(y)), *given
            )
        if name in _REDUCED and len(given) == 1:
            lines = [given[0]] if 1 in given[0].shape else list(given[0].T)
            found = [_REDUCED[name](self, _flat(line)) for line in lines]
            return array_of(found, 1, len(found))
        if name in _WHOLE:
            return _WHOLE[name](self, *given)
        raise ValueError(f"the function '{name}' has no counterpart for signals")

    def _reduced(self, name: str, elements: list[Element]) -> Element:
        found = elements[0]
        for one in elements[1:]:
            found = TWO[name](self._b, self._b.element(found), self._b.element(one))
        return found

    def truth(self, array: np.ndarray) -> Element:
        """Whether no element is 0."""
        tests = [self._one("~=", one, 0.0) for one in _flat(array)]
        found = tests[0] if tests else 1.0
        for one in tests[1:]:
            found = self._one("&", found, one)
        return found

    def chosen(self, test: Element, yes: Element, no: Element) -> Element:
        """`yes` where the test is 1."""
        if yes == no:
            return yes
        return self._b.choose(self._b.element(test), self._b.element(yes), self._b.element(no))


def _without(matrix: np.ndarray, row: int, column: int) -> np.ndarray:
    return np.delete(np.delete(matrix, row, 0), column, 1)


_REDUCED: dict[str, Callable[[Arrays, list[Element]], Element]] = {
    "sum": lambda own, e: own._total([("+", one) for one in e]),
    "prod": lambda own, e: reduce(own._product, e),
    "mean": lambda own, e: own._quotient(own._total([("+", one) for one in e]), float(len(e))),
    "min": lambda own, e: own._reduced("min", e),
    "max": lambda own, e: own._reduced("max", e),
}


def _diagonal(own: Arrays, array: np.ndarray) -> np.ndarray:
    if 1 not in array.shape:
        return np.diag(array)[:, np.newaxis]
    size = array.size
    elements: list[Element] = [0.0] * (size * size)
    elements[:: size + 1] = _flat(array)
    return array_of(elements, size, size)


def _norm(own: Arrays, array: np.ndarray) -> np.ndarray:
    if 1 not in array.shape:
        raise ValueError("the norm of a matrix that is a signal")
    squares = own._dot(_flat(array), _flat(array))
    return array_of([ONE["sqrt"](own._b, own._b.element(squares))], 1, 1)


def _cross(own: Arrays, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    (a, b, c), (x, y, z) = _flat(left), _flat(right)
    minors = ((b, z, c, y), (c, x, a, z), (a, y, b, x))
    return _like(left.shape, [own._total([("+", own._product(p, q)), ("-", own._product(r, s))])
                              for p, q, r, s in minors])  # fmt: skip


def _reshaped(own: Arrays, array: np.ndarray, *sizes: np.ndarray) -> np.ndarray:
    rows, columns = (int(one) for value in sizes for one in value.ravel())
    return array_of(_flat(array), rows, columns)


_WHOLE: dict[str, Callable[..., np.ndarray]] = {
    "inv": lambda own, a: own.inverse(a),
    "det": lambda own, a: array_of([own.determinant(a)], 1, 1),
    "transpose": lambda own, a: a.T,
    "diag": _diagonal,
    "norm": _norm,
    "dot": lambda own, a, b: array_of([own._dot(_flat(a), _flat(b))], 1, 1),
    "cross": _cross,
    "reshape": _reshaped,
    "trace": lambda own, a: array_of([own._total([("+", one) for one in np.diag(a)])], 1, 1),
    "double": lambda own, a: a,
    "single": lambda own, a: a,
}
