# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that only a simulation has: linear systems in continuous time, and functions of time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ravenbrick.model import Block, DataType
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Inputs
from ravenbrick.model.lazy import control

__all__ = ["TICK", "TIME", "LinearSystem", "TimeFunction", "pulse", "sine", "step"]

TICK = 1e-9
"""Two instants closer than this (s) are one."""

TIME = "time"
"""The input of the diagram that holds the time (s)."""

Row = tuple[float, ...]


@dataclass(frozen=True)
class LinearSystem(Block):
    """x' = A x + B u, y = C x + D u, with one input and one output; `a` holds the rows of A.

    What `updates` gives are the derivatives of the states, not their next values.
    """

    a: tuple[Row, ...] = ((0.0,),)
    b: Row = (1.0,)
    c: Row = (1.0,)
    d: float = 0.0
    initial: Row = (0.0,)

    @classmethod
    def of(cls, name: str, system: control.StateSpace | control.TransferFunction,
           initial: Row = ()) -> LinearSystem:  # fmt: skip
        """From python-control's system; raises `ValueError` if it is improper or not scalar."""
        found = control.ss(system)
        if found.ninputs != 1 or found.noutputs != 1:
            raise ValueError("a system with several inputs or outputs")
        rows = tuple(tuple(map(float, row)) for row in found.A)
        b, c = (tuple(map(float, np.ravel(part))) for part in (found.B, found.C))
        start = initial * len(rows) if len(initial) == 1 else initial or (0.0,) * len(rows)
        if len(start) != len(rows):
            raise ValueError(f"{len(start)} initial states for {len(rows)} states")
        return cls(name, a=rows, b=b, c=c, d=float(found.D[0, 0]), initial=start)

    def feedthrough(self, port: int) -> bool:
        """Only with D."""
        return self.d != 0.0

    def states(self) -> tuple[ir.Slot, ...]:
        """The vector x."""
        return tuple(self._state(f"x{i}", value) for i, value in enumerate(self.initial, 1))

    def output(self, inputs: Inputs) -> ir.Expression:
        """C x + D u."""
        return self._combined(self.c, self.d, inputs)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """A x + B u, for each state."""
        return tuple(
            (state, self._combined(row, gain, inputs))
            for state, row, gain in zip(self.states(), self.a, self.b, strict=True)
        )

    def _combined(self, row: Row, gain: float, inputs: Inputs) -> ir.Expression:
        terms = [
            ir.Binary("*", self._literal(factor), ir.Read(state))
            for factor, state in zip(row, self.states(), strict=True) if factor
        ]  # fmt: skip
        if gain:
            terms.append(ir.Binary("*", self._literal(gain), inputs[0]))
        total: ir.Expression = terms[0] if terms else self._literal(0.0)
        for term in terms[1:]:
            total = ir.Binary("+", total, term)
        return total


@dataclass(frozen=True)
class TimeFunction(Block):
    """A function of the time in seconds, which is its input; `breaks` gives its jumps up to one."""

    function: Callable[[float], float] = field(default=float, repr=False, compare=False)
    breaks: Callable[[float], list[float]] = field(default=lambda _: [], repr=False, compare=False)

    def output(self, inputs: Inputs) -> ir.Expression:
        """One call."""
        return ir.Call(self.name, ("t",), tuple(inputs), DataType.REAL64, "", "", self.function)


def step(at: float, before: float, after: float) -> TimeFunction:
    """A jump at an instant (s)."""
    return TimeFunction(
        "B", function=lambda t: after if t >= at - TICK / 2 else before, breaks=lambda _: [at]
    )


def sine(amplitude: float, frequency: float, phase: float, bias: float) -> TimeFunction:
    """`frequency` in rad/s, `phase` in rad."""
    return TimeFunction("B", function=lambda t: amplitude * math.sin(frequency * t + phase) + bias)


def pulse(amplitude: float, period: float, width: float, delay: float) -> TimeFunction:
    """`amplitude` for `width` s of each `period` (s), the first after `delay` (s)."""

    def function(t: float) -> float:
        place = (t - delay + TICK / 2) % period
        return amplitude if t >= delay - TICK / 2 and place < width else 0.0

    def breaks(until: float) -> list[float]:
        count = max(math.floor((until - delay) / period), 0) + 1
        begins = [delay + number * period for number in range(count)]
        return begins + [begin + width for begin in begins]

    return TimeFunction("B", function=function, breaks=breaks)
