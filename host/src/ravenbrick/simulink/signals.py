# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Signals of a Simulink model: shapes of vectors, matrices and buses, and single wires."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ravenbrick.model import Block

__all__ = ["Bus", "Node", "Ref", "Shape", "Tap", "Wire", "plain", "size_of"]


@dataclass(frozen=True)
class Bus:
    """Signals with names, in order.

    With an `origin` more may be asked for: the type of the port it begins at is not in the file.
    Without names it is a signal of `width` elements.
    """

    fields: tuple[tuple[str, Shape], ...]
    origin: str = ""
    width: int = 1

    def find(self, name: str) -> tuple[int, Shape]:
        """Place of the first element and shape of a signal, `a.b` in a bus inside."""
        first = 0
        for own, shape in self.fields:
            if own == name:
                return first, shape
            if isinstance(shape, Bus) and name.startswith(f"{own}."):
                inner, found = shape.find(name[len(own) + 1 :])
                return first + inner, found
            first += size_of(shape)
        known = ", ".join(f"'{own}'" for own, _ in self.fields)
        raise ValueError(f"the bus has no signal '{name}'; there are: {known or 'none'}")


# (1,) is a number, (n,) a vector, (rows, columns) a matrix, stored by columns.
Shape = tuple[int, ...] | Bus


def size_of(shape: Shape) -> int:
    """The number of its elements."""
    if isinstance(shape, Bus):
        if not shape.fields:
            return shape.width
        return sum(size_of(inner) for _, inner in shape.fields)
    return math.prod(shape)


def plain(shape: Shape) -> tuple[int, ...]:
    """A bus as the vector of its elements; others as they are."""
    return (size_of(shape),) if isinstance(shape, Bus) else shape


@dataclass(frozen=True)
class Ref:
    """One element of the signal at an output of a block of the model."""

    path: str
    port: int
    element: int


@dataclass(eq=False)
class Node:
    """A block of the diagram, made for the block at `path`, with the wires to its inputs."""

    block: Block
    path: str
    inputs: list[Wire] = field(default_factory=list)


@dataclass(frozen=True)
class Tap:
    """An output of a node with several, counted from 0."""

    node: Node
    output: int


Wire = Ref | Node | Tap
