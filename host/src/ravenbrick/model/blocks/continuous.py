# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks in continuous time, which only a simulation has: states with derivatives, friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Block, Inputs, choose
from ravenbrick.model.lazy import control

__all__ = [
    "ContinuousBlock",
    "ContinuousStateSpace",
    "CustomDerivatives",
    "DryFriction",
    "EncoderCount",
    "Integrator",
    "SmoothFunction",
    "continuous_transfer_function",
]

Row = tuple[float, ...]
Matrix = tuple[Row, ...]


@dataclass(frozen=True)
class ContinuousBlock(Block):
    """A block in continuous time, in double precision.

    What `updates` gives are the derivatives of the states, not their next values.
    """

    data_type: ir.DataType = ir.DataType.REAL64

    @property
    def is_continuous(self) -> bool:
        """Always."""
        return True


def _sum(terms: Sequence[ir.Expression], zero: ir.Expression) -> ir.Expression:
    total = terms[0] if terms else zero
    for term in terms[1:]:
        total = ir.Binary("+", total, term)
    return total


@dataclass(frozen=True)
class ContinuousStateSpace(ContinuousBlock):
    """x' = A x + B u, y = C x + D u; the matrices by rows, `initial` the states at the beginning.

    There is a port for each element of u and of y. As it stands it is an integrator.
    """

    a: Matrix = ((0.0,),)
    b: Matrix = ((1.0,),)
    c: Matrix = ((1.0,),)
    d: Matrix = ((0.0,),)
    initial: Row = (0.0,)

    @classmethod
    def of(cls, name: str, system: Any, initial: Row = ()) -> ContinuousStateSpace:
        """From a linear system, such as python-control's.

        Raises `ValueError` if it is improper or sampled; one initial value goes to all states.
        """
        found = control.ss(system)
        if found.isdtime(strict=True):
            raise ValueError(f"block '{name}': the system is sampled, not continuous")
        a, b, c, d = (
            tuple(tuple(map(float, row)) for row in part)
            for part in (found.A, found.B, found.C, found.D)
        )
        start = initial * len(a) if len(initial) == 1 else initial or (0.0,) * len(a)
        if len(start) != len(a):
            raise ValueError(f"{len(start)} initial states for {len(a)} states")
        return cls(name, a=a, b=b, c=c, d=d, initial=tuple(map(float, start)))

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """One per column of D."""
        return (self.data_type,) * len(self.d[0])

    @property
    def output_count(self) -> int:
        """One per row of D."""
        return len(self.d)

    def feedthrough(self, port: int) -> bool:
        """Only with D."""
        return any(row[port] for row in self.d)

    def states(self) -> tuple[ir.Slot, ...]:
        """The vector x."""
        return tuple(self._state(f"x{i}", value) for i, value in enumerate(self.initial, 1))

    def outputs(self, inputs: Inputs) -> tuple[ir.Expression, ...]:
        """C x + D u."""
        return tuple(self._combined(*rows, inputs) for rows in zip(self.c, self.d, strict=True))

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """A x + B u, for each state."""
        rows = zip(self.states(), self.a, self.b, strict=True)
        return tuple((state, self._combined(row, gains, inputs)) for state, row, gains in rows)

    def _combined(self, row: Row, gains: Row, inputs: Inputs) -> ir.Expression:
        factors = (*row, *gains)
        values = (*map(ir.Read, self.states()), *inputs)
        terms = [
            ir.Binary("*", self._literal(factor), value)
            for factor, value in zip(factors, values, strict=True) if factor
        ]  # fmt: skip
        return _sum(terms, self._literal(0.0))


def continuous_transfer_function(
    name: str, numerator: Sequence[float], denominator: Sequence[float]
) -> ContinuousStateSpace:
    """A transfer function in s, highest power first, at rest at the beginning."""
    return ContinuousStateSpace.of(name, control.tf(list(numerator), list(denominator)))


@dataclass(frozen=True)
class Integrator(ContinuousBlock):
    """The integral of the input over time, from `initial`, held within [`lower`, `upper`]."""

    initial: float = 0.0
    lower: float = -math.inf
    upper: float = math.inf

    def __post_init__(self) -> None:
        if not self.lower <= self.initial <= self.upper:
            raise DesignError(
                f"integrator '{self.name}': its initial value {self.initial:g} is outside of its "
                f"limits {self.lower:g} and {self.upper:g}"
            )

    def feedthrough(self, port: int) -> bool:
        """Never."""
        return False

    def states(self) -> tuple[ir.Slot, ...]:
        """The integral."""
        return (self._state("x", self.initial),)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The integral."""
        return ir.Read(self.states()[0])

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """The input, but 0 where it leads beyond a limit."""
        state, zero = self.states()[0], self._literal(0.0)
        slope = inputs[0]
        for limit, beyond in ((self.upper, ">"), (self.lower, "<")):
            if math.isfinite(limit):
                inward = choose(inputs[0], beyond, zero, zero, inputs[0])
                slope = choose(ir.Read(state), f"{beyond}=", self._literal(limit), inward, slope)
        return ((state, slope),)


@dataclass(frozen=True)
class CustomDerivatives(ContinuousBlock):
    """Differential equations given as functions: x' = derivatives(x, u), y = outputs(x, u).

    All four are sequences of floats: `initial` as many as states, u `input_count`, y
    `output_count`. Without `direct` the outputs must not depend on u. Switches inside of the
    functions are not located; use blocks for them.
    """

    derivatives: Callable[[Row, Row], Sequence[float]] = field(
        default=lambda x, u: u, repr=False, compare=False
    )
    outputs_of: Callable[[Row, Row], Sequence[float]] = field(
        default=lambda x, u: x, repr=False, compare=False
    )
    initial: Row = (0.0,)
    input_count: int = 1
    outputs_count: int = 1
    direct: bool = False

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """`input_count` ports."""
        return (self.data_type,) * self.input_count

    @property
    def output_count(self) -> int:
        """`outputs_count` ports."""
        return self.outputs_count

    def feedthrough(self, port: int) -> bool:
        """As stated."""
        return self.direct

    def states(self) -> tuple[ir.Slot, ...]:
        """The vector x."""
        return tuple(self._state(f"x{i}", value) for i, value in enumerate(self.initial, 1))

    def outputs(self, inputs: Inputs) -> tuple[ir.Expression, ...]:
        """One call per output."""
        zeros = [self._literal(0.0)] * self.input_count
        return self._calls(self.outputs_of, self.outputs_count, inputs if self.direct else zeros)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """One call per state."""
        calls = self._calls(self.derivatives, len(self.initial), inputs)
        return tuple(zip(self.states(), calls, strict=True))

    def _calls(
        self, function: Callable[[Row, Row], Sequence[float]], count: int, inputs: Inputs
    ) -> tuple[ir.Expression, ...]:
        size = len(self.initial)

        @lru_cache(maxsize=1)
        def all_of(*values: float) -> Sequence[float]:
            found = function(values[:size], values[size:])
            if len(found) != count:
                raise DesignError(f"block '{self.name}': {len(found)} values instead of {count}")
            return found

        arguments = (*map(ir.Read, self.states()), *inputs)
        names = tuple(f"a{place}" for place in range(len(arguments)))
        return tuple(
            ir.Call(self.name, names, arguments, self.data_type, "", "", _element(all_of, place))
            for place in range(count)
        )


def _element(function: Callable[..., Sequence[float]], place: int) -> Callable[..., float]:
    return lambda *values: function(*values)[place]


@dataclass(frozen=True)
class SmoothFunction(ContinuousBlock):
    """A function without jumps of `ports` inputs, which a solver may follow freely."""

    function: Callable[..., float] = math.sin
    ports: int = 1

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """`ports` of them."""
        return (self.data_type,) * self.ports

    def output(self, inputs: Inputs) -> ir.Expression:
        """One call."""
        names = tuple(f"a{place}" for place in range(self.ports))
        return ir.Call(self.name, names, tuple(inputs), self.data_type, "", "", self.function)


@dataclass(frozen=True)
class DryFriction(ContinuousBlock):
    """Friction (N m or N) of a driving torque or force and a speed, which are its inputs.

    At standstill it balances the drive up to `static`; in motion it is `kinetic` against the speed.
    Slower than `standstill` (rad/s or m/s) counts as standing. Both changes are located in time.
    """

    static: float = 0.0
    kinetic: float = 0.0
    standstill: float = 1e-6

    def __post_init__(self) -> None:
        if not 0 <= self.kinetic <= self.static:
            raise DesignError(f"friction '{self.name}': 0 <= kinetic <= static is needed")

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """Drive and speed."""
        return (self.data_type,) * 2

    def output(self, inputs: Inputs) -> ir.Expression:
        """Against the motion, or the drive."""
        drive, speed = inputs
        kinetic, limit = self._literal(self.kinetic), self._literal(self.static)
        against, band = self._literal(-self.kinetic), self._literal(self.standstill)
        held = choose(drive, "<", self._literal(-self.static), against, drive)
        standing = choose(drive, ">", limit, kinetic, held)
        slow = choose(speed, "<", self._literal(-self.standstill), against, standing)
        return choose(speed, ">", band, kinetic, slow)


@dataclass(frozen=True)
class EncoderCount(ContinuousBlock):
    """The count of an incremental encoder on a shaft whose angle (rad) is the input.

    `phase` in counts (0 to 1) is the place in the first count. Each edge is located in time.
    """

    counts_per_turn: int = 360
    phase: float = 0.5

    def intermediates(self, inputs: Inputs) -> Assignments:
        """The angle in counts, and the whole number near its middle."""
        scaled = ir.Binary("*", self._literal(self.counts_per_turn / math.tau), inputs[0])
        counts = ir.Binary("+", scaled, self._literal(self.phase))
        middle = ir.Binary("-", ir.Read(self._local("turned")), self._literal(0.5))
        return (
            (self._local("turned"), counts),
            (self._local("near"), ir.Rounded(middle)),
        )

    def output(self, inputs: Inputs) -> ir.Expression:
        """The whole counts."""
        near, one = ir.Read(self._local("near")), self._literal(1.0)
        following = ir.Binary("+", near, one)
        return choose(ir.Read(self._local("turned")), ">=", following, following, near)
