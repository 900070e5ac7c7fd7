# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The blocks of a synchronous diagram: ports, states, feed-through, and what they compute."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

from ravenbrick.model import program as ir

__all__ = [
    "Block",
    "Constant",
    "Conversion",
    "DiscreteIntegrator",
    "DiscreteTransferFunction",
    "Gain",
    "Inport",
    "IntegrationMethod",
    "Outport",
    "Parameter",
    "Saturation",
    "Sum",
    "UnitDelay",
]


@dataclass(frozen=True)
class Parameter:
    """A tunable value: a field of `<model>_P` in the generated C, shared by name."""

    name: str
    value: float
    unit: str
    description: str


Value = float | Parameter

Inputs = Sequence[ir.Expression]
"""What stands at the input ports of a block, in order."""

Assignments = tuple[tuple[ir.Slot, ir.Expression], ...]
"""Variables with their new values, in order."""


def number(value: Value) -> float:
    """The value to begin with."""
    return value.value if isinstance(value, Parameter) else value


@dataclass(frozen=True)
class Block:
    """A block.

    `data_type` is the format of the ports. `sample_time` in s, or None to take the diagram's.
    `unit` is that of the outputs, such as "rad/s", where it is stated.
    Subclasses say how many inputs they have and whether the output needs input `i` in the same
    step (`feedthrough`).
    """

    name: str
    data_type: ir.DataType = ir.DataType.REAL32
    sample_time: float | None = None
    unit: str = field(default="", kw_only=True)

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """Format of each input port, in order."""
        return (self.data_type,)

    @property
    def output_type(self) -> ir.DataType | None:
        """Format of the output port; None for a block without one."""
        return self.data_type

    @property
    def is_continuous(self) -> bool:
        """Whether it lives in continuous time: only a simulation has it, no generated code."""
        return False

    def feedthrough(self, port: int) -> bool:
        """Whether the output depends on input `port` in the same step."""
        return True

    def values(self) -> tuple[Value, ...]:
        """Numbers that may be parameters."""
        return ()

    def states(self) -> tuple[ir.Slot, ...]:
        """State variables with their initial values."""
        return ()

    def intermediates(self, inputs: Inputs) -> Assignments:
        """Values computed before the output, under names that begin with the block's."""
        return ()

    def output(self, inputs: Inputs) -> ir.Expression:
        """The output; inputs without feed-through must not be read."""
        raise NotImplementedError(f"block type {type(self).__name__} has no output")

    @property
    def output_count(self) -> int:
        """Number of output ports, all of the format `output_type`."""
        return 0 if self.output_type is None else 1

    def outputs(self, inputs: Inputs) -> tuple[ir.Expression, ...]:
        """One expression per output port."""
        return (self.output(inputs),)

    def compute(
        self, inputs: Inputs, targets: Sequence[ir.Slot | None]
    ) -> tuple[ir.Instruction, ...]:
        """Instructions that assign the outputs; None stands for one that nothing reads."""
        values = zip(targets, self.outputs(inputs), strict=True)
        used = [(target, value) for target, value in values if target is not None]
        return tuple(self._assign(*one) for one in (*self.intermediates(inputs), *used))

    def _assign(self, target: ir.Slot, value: ir.Expression) -> ir.Statement:
        return ir.Statement(target, value, self.name, type(self).__name__)

    def timed(self, sample_time: float) -> Block:
        """The block as it is when it runs every `sample_time` (s)."""
        return self

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """New values of the states, in order of assignment.

        All updates run after all outputs. Values that must be kept while states change go into
        signals (`_local`) first.
        """
        return ()

    def _local(self, suffix: str) -> ir.Slot:
        return ir.Slot(ir.Kind.SIGNAL, f"{self.name}_{suffix}", self.data_type, self.name)

    def _literal(self, value: float) -> ir.Expression:
        return ir.Literal(value, self.data_type)

    def _state(self, suffix: str, initial: float) -> ir.Slot:
        return ir.Slot(
            ir.Kind.STATE, f"{self.name}_{suffix}", self.data_type, self.name, initial=initial
        )

    def _value(self, value: Value) -> ir.Expression:
        if isinstance(value, Parameter):
            return ir.Read(parameter_slot(value, self.data_type, self.name))
        return self._literal(value)


def parameter_slot(parameter: Parameter, data_type: ir.DataType, block: str) -> ir.Slot:
    """The variable that holds a parameter."""
    return ir.Slot(
        ir.Kind.PARAMETER,
        parameter.name,
        data_type,
        block,
        initial=parameter.value,
        unit=parameter.unit,
        description=parameter.description,
    )


def choose(
    left: ir.Expression,
    operator: str,
    right: ir.Expression,
    chosen: ir.Expression,
    otherwise: ir.Expression,
) -> ir.Select:
    """`chosen` where the comparison holds."""
    return ir.Select(ir.Comparison(operator, left, right), chosen, otherwise)


def _scaled(block: Block, factor: Value, value: ir.Expression) -> ir.Expression:
    """The product, or the value itself for the factor 1."""
    if factor == 1.0:
        return value
    return ir.Binary("*", block._value(factor), value)


@dataclass(frozen=True)
class _Port(Block):
    """A port of the diagram; `unit` and `description` go into the generated header."""

    unit: str = ""
    description: str = ""

    def _variable(self, kind: ir.Kind) -> ir.Slot:
        return ir.Slot(
            kind,
            self.name,
            self.data_type,
            self.name,
            unit=self.unit,
            description=self.description,
        )


@dataclass(frozen=True)
class Inport(_Port):
    """An input of the diagram."""

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """No input port."""
        return ()

    def output(self, inputs: Inputs) -> ir.Expression:
        """The value given from outside."""
        return ir.Read(self.slot)

    @property
    def slot(self) -> ir.Slot:
        """The input variable."""
        return self._variable(ir.Kind.INPUT)


@dataclass(frozen=True)
class Outport(_Port):
    """An output of the diagram."""

    @property
    def output_type(self) -> ir.DataType | None:
        """No output port."""
        return None

    @property
    def slot(self) -> ir.Slot:
        """The output variable."""
        return self._variable(ir.Kind.OUTPUT)


@dataclass(frozen=True)
class Constant(Block):
    """A constant or tunable value."""

    value: Value = 0.0

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """No input port."""
        return ()

    def values(self) -> tuple[Value, ...]:
        """The value."""
        return (self.value,)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The value."""
        return self._value(self.value)


@dataclass(frozen=True)
class Gain(Block):
    """`y = gain * u`."""

    gain: Value = 1.0

    def values(self) -> tuple[Value, ...]:
        """The gain."""
        return (self.gain,)

    def output(self, inputs: Inputs) -> ir.Expression:
        """One product."""
        return _scaled(self, self.gain, inputs[0])


@dataclass(frozen=True)
class Sum(Block):
    """Inputs added or subtracted from left to right; `signs` such as '+-', the first is '+'."""

    signs: str = "++"

    def __post_init__(self) -> None:
        if len(self.signs) < 2 or self.signs[0] != "+" or set(self.signs) - set("+-"):
            raise ValueError(
                f"block '{self.name}': signs must be '+' followed by '+' or '-', not '{self.signs}'"
            )

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """One port per sign."""
        return (self.data_type,) * len(self.signs)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The sum, each addition rounded."""
        total = inputs[0]
        for sign, value in zip(self.signs[1:], inputs[1:], strict=True):
            total = ir.Binary(sign, total, value)
        return total


@dataclass(frozen=True)
class Saturation(Block):
    """`u` limited to [-limit, limit]; the limit must not be negative.

    With `lower` it is limited to [lower, limit], and either may be infinite.
    """

    limit: Value = 1.0
    lower: Value | None = None

    def __post_init__(self) -> None:
        if self.lower is not None:
            if not number(self.lower) <= number(self.limit):
                raise ValueError(
                    f"block '{self.name}': the lower limit {number(self.lower)} must not be above "
                    f"the upper one, {number(self.limit)}"
                )
            return
        if not number(self.limit) >= 0:
            raise ValueError(
                f"block '{self.name}': the limit must be >= 0, not {number(self.limit)}"
            )

    def values(self) -> tuple[Value, ...]:
        """The limits that are finite."""
        limits = (self.limit,) if self.lower is None else (self.limit, self.lower)
        return tuple(value for value in limits if math.isfinite(number(value)))

    def output(self, inputs: Inputs) -> ir.Expression:
        """The limited value."""
        if self.lower is None:
            return ir.Clamp(inputs[0], self._value(self.limit))
        found = inputs[0]
        for limit, operator in ((self.lower, "<"), (self.limit, ">")):
            if math.isfinite(number(limit)):
                bound = self._value(limit)
                found = ir.Select(ir.Comparison(operator, inputs[0], bound), bound, found)
        return found


@dataclass(frozen=True)
class Conversion(Block):
    """The input in the format `data_type`; the input's format is `from_type`."""

    from_type: ir.DataType = ir.DataType.REAL64

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """The other format."""
        return (self.from_type,)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The rounded value."""
        return ir.Cast(inputs[0], self.data_type)


@dataclass(frozen=True)
class UnitDelay(Block):
    """The input of the step before; `initial` in the first step."""

    initial: float = 0.0

    def feedthrough(self, port: int) -> bool:
        """The output is the state alone."""
        return False

    def states(self) -> tuple[ir.Slot, ...]:
        """The stored sample."""
        return (self._state("DSTATE", self.initial),)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The stored sample."""
        return ir.Read(self.states()[0])

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """Store the input."""
        return ((self.states()[0], inputs[0]),)


class IntegrationMethod(Enum):
    """How a discrete integrator approximates 1/s; `Ts` is the sample time.

    FORWARD_EULER: Ts/(z-1); BACKWARD_EULER: Ts z/(z-1); TUSTIN: Ts/2 (z+1)/(z-1).
    """

    FORWARD_EULER = "forward Euler"
    TUSTIN = "Tustin"
    BACKWARD_EULER = "backward Euler"

    @property
    def present_share(self) -> float:
        """Share of the present input in the present value: 0, 1/2 or 1."""
        return {"forward Euler": 0.0, "Tustin": 0.5, "backward Euler": 1.0}[self.value]


@dataclass(frozen=True)
class DiscreteIntegrator(Block):
    """Integral of `u` over time by `method`: the sum of `gain * u`.

    `gain` is the sample time in s unless given. With `gain` 1 the block accumulates: the sample
    time is then part of the gain before it.
    """

    gain: float | None = None
    method: IntegrationMethod = IntegrationMethod.FORWARD_EULER
    initial: float = 0.0

    def feedthrough(self, port: int) -> bool:
        """Only forward Euler leaves the present input out."""
        return self.method is not IntegrationMethod.FORWARD_EULER

    def states(self) -> tuple[ir.Slot, ...]:
        """The sum."""
        return (self._state("DSTATE", self.initial),)

    def timed(self, sample_time: float) -> DiscreteIntegrator:
        """With the sample time as gain, unless another is given."""
        return replace(self, gain=sample_time) if self.gain is None else self

    def _increment(self, value: ir.Expression) -> ir.Expression:
        half = self.method is IntegrationMethod.TUSTIN
        assert self.gain is not None
        return _scaled(self, self.gain / 2 if half else self.gain, value)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The sum so far, with the share of the present input that the method asks for."""
        state: ir.Expression = ir.Read(self.states()[0])
        if self.method is IntegrationMethod.FORWARD_EULER:
            return state
        return ir.Binary("+", state, self._increment(inputs[0]))

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """Add the present input's share for the next step."""
        state = self.states()[0]
        if self.method is IntegrationMethod.BACKWARD_EULER:
            return ((state, output),)
        return ((state, ir.Binary("+", output, self._increment(inputs[0]))),)


@dataclass(frozen=True)
class DiscreteTransferFunction(Block):
    """A rational function of z in transposed direct form II.

    `numerator` and `denominator` in falling powers of z, of equal length (pad the numerator with
    leading zeros), the denominator monic.
    """

    numerator: tuple[float, ...] = (1.0, 0.0)
    denominator: tuple[float, ...] = (1.0, 0.0)

    def __post_init__(self) -> None:
        if len(self.numerator) != len(self.denominator) or len(self.denominator) < 2:
            raise ValueError(
                f"block '{self.name}': numerator and denominator must have the same length of at "
                f"least 2, not {len(self.numerator)} and {len(self.denominator)}"
            )
        if self.denominator[0] != 1.0:
            raise ValueError(
                f"block '{self.name}': the denominator must begin with 1, "
                f"not {self.denominator[0]}; divide both polynomials by it"
            )

    def feedthrough(self, port: int) -> bool:
        """Only with as many zeros as poles."""
        return self.numerator[0] != 0.0

    def states(self) -> tuple[ir.Slot, ...]:
        """One state per pole."""
        return tuple(
            self._state(f"DSTATE{index}", 0.0) for index in range(1, len(self.denominator))
        )

    def output(self, inputs: Inputs) -> ir.Expression:
        """`b0 u + s1`."""
        state: ir.Expression = ir.Read(self.states()[0])
        if not self.feedthrough(0):
            return state
        return ir.Binary("+", _scaled(self, self.numerator[0], inputs[0]), state)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """`s_i := s_(i+1) + b_i u - a_i y`, in rising order of i."""
        states = self.states()
        result = []
        for index, state in enumerate(states, 1):
            terms: list[tuple[str, ir.Expression]] = []
            if index < len(states):
                terms.append(("+", ir.Read(states[index])))
            if self.numerator[index] != 0.0:
                terms.append(("+", _scaled(self, self.numerator[index], inputs[0])))
            if self.denominator[index] != 0.0:
                terms.append(("+", _scaled(self, -self.denominator[index], output)))
            total = terms[0][1] if terms else ir.Literal(0.0, self.data_type)
            for sign, term in terms[1:]:
                total = ir.Binary(sign, total, term)
            result.append((state, total))
        return tuple(result)
