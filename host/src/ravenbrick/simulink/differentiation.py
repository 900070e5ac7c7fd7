# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Derivatives of signals in continuous time by the rules of calculus, where blocks are smooth."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ravenbrick.model import Constant, Gain, Product, Sum
from ravenbrick.model.blocks.continuous import ContinuousStateSpace, SmoothFunction
from ravenbrick.model.blocks.time_functions import TimeFunction
from ravenbrick.simulink.blocks.elementary import ONE, root
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.signals import Node, Wire

__all__ = ["Differentiation"]

_FARTHEST = 400  # blocks on the way to a source
_MOST_BLOCKS = 4000


class NotSmoothError(Exception):
    """A block on the way has no derivative, or jumps."""


class Differentiation:
    """The derivatives of signals; `node_of` gives the node of a wire, None if it only jumps."""

    def __init__(self, node_of: Callable[[Wire], Node | None]) -> None:
        self._node_of = node_of
        self._known: dict[int, Wire | float] = {}

    def rates(self, b: Builder, wires: Sequence[Wire]) -> list[Wire] | None:
        """The derivatives of wires as nodes of a builder; None if one is not smooth."""
        made = len(b.nodes)
        known = dict(self._known)
        try:
            with b.sharing():
                return [b.element(self._of(b, self._node_of(wire), 0)) for wire in wires]
        except NotSmoothError:
            del b.nodes[made:]
            self._known = known
            return None

    def _of(self, b: Builder, node: Node | None, depth: int) -> Wire | float:
        if node is None or depth > _FARTHEST or len(b.nodes) > _MOST_BLOCKS:
            raise NotSmoothError
        if id(node) not in self._known:
            self._known[id(node)] = self._found(b, node, depth)
        return self._known[id(node)]

    def _found(self, b: Builder, node: Node, depth: int) -> Wire | float:
        block, inputs = node.block, node.inputs

        def inner() -> list[Wire | float]:
            return [self._of(b, self._node_of(wire), depth + 1) for wire in inputs]

        match block:
            case Constant():
                return 0.0
            case TimeFunction():
                if block.derivative is None:
                    raise NotSmoothError
                return b.add(replace(block.derivative(), name="B"))
            case ContinuousStateSpace():
                return _of_states(b, block, inputs)
            case Gain():
                (rate,) = inner()
                return 0.0 if rate == 0.0 else b.scaled(block.gain, b.element(rate))
            case Sum():
                terms = [(sign, b.element(rate))
                         for sign, rate in zip(block.signs, inner(), strict=True)
                         if rate != 0.0]  # fmt: skip
                return _total(b, terms)
            case Product():
                return _of_product(b, node, block.operators, inner())
            case SmoothFunction() if block.function in _RULES:
                return _RULES[block.function](b, node, inputs, inner())
        raise NotSmoothError


def _of_states(b: Builder, block: ContinuousStateSpace, inputs: list[Wire]) -> Wire:
    """The input of an integrator; of others C A x + C B u, with states of its own."""
    a, gains, c, d = (np.array(part) for part in (block.a, block.b, block.c, block.d))
    if len(c) > 1 or d.any():
        raise NotSmoothError
    if a.tolist() == [[0.0]] and gains.tolist() == [[1.0]] and c.tolist() == [[1.0]]:
        return inputs[0]
    rows = [tuple(tuple(map(float, row)) for row in part) for part in (c @ a, c @ gains)]
    return b.add(replace(block, name="B", c=rows[0], d=rows[1]), *inputs, ending="_rate")


def _of_product(b: Builder, node: Node, operators: str, rates: list[Wire | float]) -> Wire | float:
    """The sum over the factors; one that divides gives -u' / u times the whole."""
    terms: list[tuple[str, Wire]] = []
    for place, (operator, rate) in enumerate(zip(operators, rates, strict=True)):
        if rate == 0.0:
            continue
        if operator == "/":
            share = b.product(node, b.element(rate), node.inputs[place], operators="**/")
            terms.append(("-", share))
            continue
        others = [*node.inputs[:place], b.element(rate), *node.inputs[place + 1 :]]
        terms.append(("+", b.product(*others, operators=operators)))
    return _total(b, terms)


def _total(b: Builder, terms: list[tuple[str, Wire]]) -> Wire | float:
    """The sum of terms with their signs; 0 of none."""
    signs = "".join(sign for sign, _ in terms)
    return b.sum(*(term for _, term in terms), signs=signs) if terms else 0.0


def _times(b: Builder, factor: Wire, rate: Wire | float) -> Wire | float:
    return 0.0 if rate == 0.0 else b.product(factor, b.element(rate))


Rule = Callable[[Builder, Node, list[Wire], list["Wire | float"]], "Wire | float"]


def _of_sine(b: Builder, node: Node, inputs: list[Wire], rates: list[Wire | float]) -> Wire | float:
    return _times(b, ONE["cos"](b, inputs[0]), rates[0])


def _of_cosine(
    b: Builder, node: Node, inputs: list[Wire], rates: list[Wire | float]
) -> Wire | float:
    return _times(b, b.scaled(-1.0, ONE["sin"](b, inputs[0])), rates[0])


def _of_root(b: Builder, node: Node, inputs: list[Wire], rates: list[Wire | float]) -> Wire | float:
    half = b.product(b.constant(0.5), node, operators="*/")
    return _times(b, half, rates[0])


def _of_angle(
    b: Builder, node: Node, inputs: list[Wire], rates: list[Wire | float]
) -> Wire | float:
    (high, wide), terms = inputs, []
    for sign, factor, rate in (("+", wide, rates[0]), ("-", high, rates[1])):
        if rate != 0.0:
            terms.append((sign, b.product(factor, b.element(rate))))
    if not terms:
        return 0.0
    square = b.sum(b.product(high, high), b.product(wide, wide))
    return b.product(b.element(_total(b, terms)), square, operators="*/")


_RULES: dict[Callable[..., float], Rule] = {
    math.sin: _of_sine, math.cos: _of_cosine, root: _of_root, math.atan2: _of_angle,
}  # fmt: skip
