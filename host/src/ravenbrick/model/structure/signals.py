# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that only join and part signals: nothing is left of them in a program."""

from __future__ import annotations

from dataclasses import dataclass

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Block

__all__ = ["BusCreator", "BusSelector", "Demux", "Mux", "RoutingBlock", "Shape"]

# None is a single number; otherwise the names and shapes of the elements, in order.
Shape = tuple[tuple[str, "Shape"], ...] | None


@dataclass(frozen=True)
class RoutingBlock(Block):
    """A block whose outputs are its inputs, joined or parted."""


@dataclass(frozen=True)
class BusCreator(RoutingBlock):
    """Joins signals to a bus; `fields` are their names, one per input port."""

    fields: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.fields or len(set(self.fields)) != len(self.fields):
            raise DesignError(f"bus '{self.name}': its fields need names, each another")

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """One per field."""
        return (self.data_type,) * len(self.fields)


@dataclass(frozen=True)
class BusSelector(RoutingBlock):
    """Takes fields out of a bus, one per output; "body.pitch" is a field of a bus in a bus."""

    fields: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.fields:
            raise DesignError(f"bus selector '{self.name}': name at least one field")

    @property
    def output_count(self) -> int:
        """One per field."""
        return len(self.fields)


@dataclass(frozen=True)
class Mux(RoutingBlock):
    """Joins `count` signals to a vector; blocks compute on a vector element by element."""

    count: int = 2

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """One per element."""
        return (self.data_type,) * self.count


@dataclass(frozen=True)
class Demux(RoutingBlock):
    """Parts a vector of `count` elements."""

    count: int = 2

    @property
    def output_count(self) -> int:
        """One per element."""
        return self.count
