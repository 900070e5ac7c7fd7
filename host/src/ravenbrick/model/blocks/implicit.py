# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Signals that a simulation finds beside the states: those of algebraic loops, and late ones."""

from __future__ import annotations

from dataclasses import dataclass

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Inputs
from ravenbrick.model.blocks.continuous import ContinuousBlock

__all__ = ["ImplicitSignal", "LateSignal", "LoopSignal"]


@dataclass(frozen=True)
class ImplicitSignal(ContinuousBlock):
    """Its output is kept; the simulation gives it the value that belongs to the input."""

    initial: float = 0.0

    def feedthrough(self, port: int) -> bool:
        """Never, as the output is known before the input."""
        return False

    def states(self) -> tuple[ir.Slot, ...]:
        """The output."""
        return (self._state("z", self.initial),)

    def output(self, inputs: Inputs) -> ir.Expression:
        """As it is kept."""
        return ir.Read(self.states()[0])

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """The input."""
        return ((self.states()[0], inputs[0]),)


@dataclass(frozen=True)
class LoopSignal(ImplicitSignal):
    """A place in an algebraic loop: at every instant output and input are equal."""


@dataclass(frozen=True)
class LateSignal(ImplicitSignal):
    """The input of `delay` seconds before, and `initial` until then."""

    delay: float = 1.0
