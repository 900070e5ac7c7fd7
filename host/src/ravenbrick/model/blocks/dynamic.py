# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Linear blocks with several states: delays, averages, filters, PID, state space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import (
    Assignments,
    Block,
    Inputs,
    Parameter,
    Value,
)
from ravenbrick.model.lazy import control

__all__ = [
    "ComplementaryFilter",
    "Delay",
    "DiscreteStateSpace",
    "MovingAverage",
    "PidController",
    "state_space_block",
]

_LONGEST_DELAY = 1024
_LONGEST_AVERAGE = 256
# Up to here it takes fewer cycles to move all samples than to keep an index.
_MOST_SHIFTED = 3


def _check_length(block: Block, length: int, least: int, most: int) -> None:
    if not least <= length <= most:
        raise ValueError(
            f"block '{block.name}': the length must lie between {least} and {most} "
            f"samples, not {length}"
        )


def _shifted(states: Sequence[ir.Slot], newest: ir.Expression) -> Assignments:
    """Each sample moves on by one, the oldest first."""
    moved = [(states[at], ir.Read(states[at - 1])) for at in range(len(states) - 1, 0, -1)]
    return (*moved, (states[0], newest))


@dataclass(frozen=True)
class Delay(Block):
    """The input of `length` steps before; the time that it takes does not grow with the length."""

    length: int = 1
    initial: float = 0.0

    def __post_init__(self) -> None:
        _check_length(self, self.length, 1, _LONGEST_DELAY)

    def states(self) -> tuple[ir.Slot, ...]:
        """Earlier inputs: a few samples, newest first, or a line of them."""
        if self.length > _MOST_SHIFTED:
            form, initial = self.data_type, self.initial
            return (
                ir.DelayLine(
                    ir.Kind.STATE,
                    f"{self.name}_DSTATE",
                    form,
                    self.name,
                    initial,
                    length=self.length,
                ),
            )
        return tuple(self._state(f"DSTATE{at}", self.initial) for at in range(1, self.length + 1))

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """The newest sample enters."""
        return _shifted(self.states(), inputs[0])

    def feedthrough(self, port: int) -> bool:
        """The output is a state alone."""
        return False

    def output(self, inputs: Inputs) -> ir.Expression:
        """The oldest sample."""
        return ir.Read(self.states()[-1])


@dataclass(frozen=True)
class MovingAverage(Block):
    """Mean of the last `length` inputs; those before the first step are `initial`.

    All are added anew in each step, the newest first, so that no rounding error is kept.
    """

    length: int = 2
    initial: float = 0.0

    def __post_init__(self) -> None:
        _check_length(self, self.length, 2, _LONGEST_AVERAGE)

    def states(self) -> tuple[ir.Slot, ...]:
        """Earlier inputs, newest first."""
        return tuple(self._state(f"DSTATE{at}", self.initial) for at in range(1, self.length))

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """The newest sample enters."""
        return _shifted(self.states(), inputs[0])

    def output(self, inputs: Inputs) -> ir.Expression:
        """The sum times 1 / length."""
        total = inputs[0]
        for state in self.states():
            total = ir.Binary("+", total, ir.Read(state))
        return ir.Binary("*", self._literal(1.0 / self.length), total)


@dataclass(frozen=True)
class ComplementaryFilter(Block):
    """Angle from a rate (input 0) and a slow absolute measurement (input 1).

    y = weight (y_before + step * rate) + (1 - weight) measurement; `step` is the sample time in s,
    `weight` between 0 and 1 gives the time constant step * weight / (1 - weight).
    """

    weight: float = 0.98
    step: float = 0.01
    initial: float = 0.0

    def __post_init__(self) -> None:
        if not 0 <= self.weight <= 1:
            raise ValueError(
                f"block '{self.name}': the weight must lie between 0 and 1, not {self.weight}"
            )

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """Rate, measurement."""
        return (self.data_type,) * 2

    def states(self) -> tuple[ir.Slot, ...]:
        """The last angle."""
        return (self._state("DSTATE", self.initial),)

    def output(self, inputs: Inputs) -> ir.Expression:
        """Prediction and measurement, weighted."""
        turned = ir.Binary("*", self._literal(self.step), inputs[0])
        predicted = ir.Binary("+", ir.Read(self.states()[0]), turned)
        first = ir.Binary("*", self._literal(self.weight), predicted)
        return ir.Binary("+", first, ir.Binary("*", self._literal(1.0 - self.weight), inputs[1]))

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """Store the angle."""
        return ((self.states()[0], output),)


@dataclass(frozen=True)
class PidController(Block):
    """P + I + filtered D of input 0, both by forward Euler.

    u = proportional e + i + d; i grows by integral_step e (+ input 1 with `tracking`, for
    anti-windup); d = derivative_gain (e - x), x grows by filter_step (e - x). In terms of Kp, Ki,
    Kd and the filter coefficient N in 1/s: see `of_gains`.
    """

    proportional: Value = 1.0
    integral_step: Value = 0.0
    derivative_gain: Value = 0.0
    filter_step: float = 1.0
    tracking: bool = False

    def __post_init__(self) -> None:
        if not 0 < self.filter_step < 2:
            raise ValueError(
                f"block '{self.name}': the derivative filter is stable for a filter coefficient "
                f"times sample time between 0 and 2, not {self.filter_step}"
            )

    @classmethod
    def of_gains(
        cls,
        name: str,
        gains: tuple[float, float, float],
        filter_coefficient: float,
        sample_time: float,
        *,
        tracking: bool = False,
    ) -> PidController:
        """From (Kp, Ki in 1/s, Kd in s), N in 1/s and the sample time in s; all tunable."""
        proportional, integral, derivative = gains
        return cls(
            name,
            proportional=Parameter(f"{name}_Kp", proportional, "1", "proportional gain"),
            integral_step=Parameter(
                f"{name}_Ki_Ts", integral * sample_time, "1", "integral gain times sample time"
            ),
            derivative_gain=Parameter(
                f"{name}_Kd_N", derivative * filter_coefficient, "1", "derivative gain times N"
            ),
            filter_step=filter_coefficient * sample_time,
            tracking=tracking,
        )

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """Error, and with tracking what the integrator is driven by besides."""
        return (self.data_type,) * (2 if self.tracking else 1)

    def feedthrough(self, port: int) -> bool:
        """Only the error."""
        return port == 0

    def values(self) -> tuple[Value, ...]:
        """The gains."""
        return self.proportional, self.integral_step, self.derivative_gain

    def states(self) -> tuple[ir.Slot, ...]:
        """Integral, filtered error."""
        return self._state("ISTATE", 0.0), self._state("FSTATE", 0.0)

    def intermediates(self, inputs: Inputs) -> Assignments:
        """What the filter has not followed yet."""
        return ((self._local("rest"), ir.Binary("-", inputs[0], ir.Read(self.states()[1]))),)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The three parts from left to right."""
        integral, rest = ir.Read(self.states()[0]), ir.Read(self._local("rest"))
        first = ir.Binary("*", self._value(self.proportional), inputs[0])
        last = ir.Binary("*", self._value(self.derivative_gain), rest)
        return ir.Binary("+", ir.Binary("+", first, integral), last)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """Integral and filter."""
        integral, filtered = self.states()
        step: ir.Expression = ir.Binary("*", self._value(self.integral_step), inputs[0])
        if self.tracking:
            step = ir.Binary("+", step, inputs[1])
        follow = ir.Binary("*", self._literal(self.filter_step), ir.Read(self._local("rest")))
        return (
            (integral, ir.Binary("+", ir.Read(integral), step)),
            (filtered, ir.Binary("+", ir.Read(filtered), follow)),
        )


Row = tuple[float, ...]


@dataclass(frozen=True)
class DiscreteStateSpace(Block):
    """x_next = A x + B u, y = C x + D u; an input per column of B, an output per row of C.

    `a` (n, n), `b` (n, m), `c` (p, n) and `d` (p, m) as rows; with a single output `c` and `d` may
    be plain rows. Zeros cost nothing.
    """

    a: tuple[Row, ...] = ((0.0,),)
    b: tuple[Row, ...] = ((1.0,),)
    c: tuple[Row, ...] | Row = (1.0,)
    d: tuple[Row, ...] | Row = (0.0,)
    initial: Row = ()

    def __post_init__(self) -> None:
        order, ports, rows = len(self.a), len(self._d[0]), len(self._c)
        good = (
            order > 0
            and ports > 0
            and all(len(row) == order for row in (*self.a, *self._c))
            and len(self.b) == order
            and len(self._d) == rows
            and all(len(row) == ports for row in (*self.b, *self._d))
            and len(self.initial) in (0, order)
        )
        if not good:
            raise ValueError(
                f"block '{self.name}': the shapes of a, b, c, d and initial do not fit; for "
                f"{order} states, {ports} inputs and {rows} outputs: ({order}, {order}), "
                f"({order}, {ports}), ({rows}, {order}), ({rows}, {ports}), ({order})"
            )

    @property
    def _c(self) -> tuple[Row, ...]:
        return _as_rows(self.c)

    @property
    def _d(self) -> tuple[Row, ...]:
        return _as_rows(self.d)

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """One port per input."""
        return (self.data_type,) * len(self._d[0])

    @property
    def output_count(self) -> int:
        """One port per row of C."""
        return len(self._c)

    def feedthrough(self, port: int) -> bool:
        """Where d is not 0 in any row."""
        return any(row[port] != 0.0 for row in self._d)

    def states(self) -> tuple[ir.Slot, ...]:
        """x."""
        start = self.initial or (0.0,) * len(self.a)
        return tuple(self._state(f"DSTATE{index}", value) for index, value in enumerate(start, 1))

    def _row(self, weights: Sequence[float], values: Sequence[ir.Expression]) -> ir.Expression:
        terms = [
            ir.Binary("*", self._literal(weight), value) if weight != 1.0 else value
            for weight, value in zip(weights, values, strict=True)
            if weight != 0.0
        ]
        if not terms:
            return self._literal(0.0)
        total = terms[0]
        for term in terms[1:]:
            total = ir.Binary("+", total, term)
        return total

    def outputs(self, inputs: Inputs) -> tuple[ir.Expression, ...]:
        """C x + D u from left to right."""
        values = (*map(ir.Read, self.states()), *inputs)
        return tuple(self._row((*c, *d), values) for c, d in zip(self._c, self._d, strict=True))

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """All next states are computed before the first is stored."""
        states = self.states()
        sources = (*map(ir.Read, states), *inputs)
        computed, stored = [], []
        for index, (state, a, b) in enumerate(zip(states, self.a, self.b, strict=True), 1):
            following = self._local(f"next{index}")
            computed.append((following, self._row((*a, *b), sources)))
            stored.append((state, ir.Read(following)))
        return (*computed, *stored)


def _as_rows(numbers: tuple[Row, ...] | Row) -> tuple[Row, ...]:
    """Rows of a matrix, which may be a single plain one."""
    if any(isinstance(one, tuple) for one in numbers):
        return cast(tuple[Row, ...], numbers)
    return (cast(Row, numbers),)


def state_space_block(
    name: str,
    system: control.StateSpace,
    output: int | None = None,
    data_type: ir.DataType = ir.DataType.REAL32,
) -> DiscreteStateSpace:
    """A discrete python-control system, such as an observer or an LQG controller.

    All its outputs, one port each, or only the one with the number `output`.
    """
    if not control.isdtime(system, strict=True):
        raise ValueError(f"block '{name}': the system is continuous; discretise it first")
    chosen = slice(None) if output is None else slice(output, output + 1)
    a, b, c, d = (np.asarray(one).tolist() for one in (system.A, system.B, system.C, system.D))
    rows = [tuple(map(tuple, matrix)) for matrix in (a, b, c[chosen], d[chosen])]
    return DiscreteStateSpace(name, data_type, a=rows[0], b=rows[1], c=rows[2], d=rows[3])
