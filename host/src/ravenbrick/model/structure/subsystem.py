# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagram as a block of another one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Block, Inport, Outport

if TYPE_CHECKING:
    from ravenbrick.model.diagram import Diagram

__all__ = ["Subsystem"]


@dataclass(frozen=True)
class Subsystem(Block):
    """A diagram inside of a block: its inports and outports are the ports, in order.

    The inner diagram's sample time is that of its blocks, a whole multiple of the outer one's. The
    block may be connected by the names of the ports: `input_port("speed")`.
    """

    diagram: Diagram = field(kw_only=True, compare=False)

    def __post_init__(self) -> None:
        if len({port.data_type for port in self.outports}) > 1:
            raise DesignError(
                f"subsystem '{self.name}': its outports have different number formats; put "
                "Conversion blocks before them"
            )

    @property
    def inports(self) -> tuple[Inport, ...]:
        """Those of the inner diagram."""
        return tuple(b for b in self.diagram.blocks if isinstance(b, Inport))

    @property
    def outports(self) -> tuple[Outport, ...]:
        """Those of the inner diagram."""
        return tuple(b for b in self.diagram.blocks if isinstance(b, Outport))

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """Those of the inports."""
        return tuple(port.data_type for port in self.inports)

    @property
    def output_type(self) -> ir.DataType | None:
        """That of the outports."""
        return self.outports[0].data_type if self.outports else None

    @property
    def output_count(self) -> int:
        """One per outport."""
        return len(self.outports)

    def input_port(self, name: str) -> int:
        """The place of an inport; raises `DesignError` with the names that there are."""
        return _place(self, "inport", [port.name for port in self.inports], name)

    def output_port(self, name: str) -> int:
        """The place of an outport."""
        return _place(self, "outport", [port.name for port in self.outports], name)


def _place(system: Subsystem, kind: str, names: list[str], name: str) -> int:
    if name not in names:
        known = ", ".join(names) or "none"
        raise DesignError(f"subsystem '{system.name}' has no {kind} '{name}'; there are: {known}")
    return names.index(name)
