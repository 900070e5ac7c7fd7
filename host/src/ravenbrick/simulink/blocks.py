# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulink's block types and what they are in a diagram."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import control
import numpy as np

from ravenbrick.control.discretisation import DiscretisationMethod, discretise
from ravenbrick.model import (
    Backlash,
    Block,
    Constant,
    CustomFunction,
    DeadZone,
    Delay,
    DiscreteIntegrator,
    Gain,
    IntegrationMethod,
    LookupTable,
    Pulse,
    Quantiser,
    RateLimit,
    Relay,
    Saturation,
    Sine,
    Step,
    Sum,
    Switch,
    UnitDelay,
    ZeroOrderHold,
    state_space_block,
    transfer_function_block,
)
from ravenbrick.simulink.file import SimulinkBlock
from ravenbrick.simulink.numbers import matrix, scalar, vector

__all__ = ["IGNORED", "MAKERS", "STRUCTURE", "Dialog"]

IGNORED = frozenset(
    "Scope Display ToWorkspace ToFile Terminator XYGraph FloatingScope Annotation".split()
)
STRUCTURE = frozenset("Inport Outport SubSystem Goto From GotoTagVisibility".split())
_METHODS = {
    "ForwardEuler": IntegrationMethod.FORWARD_EULER,
    "Forward Euler": IntegrationMethod.FORWARD_EULER,
    "BackwardEuler": IntegrationMethod.BACKWARD_EULER,
    "Backward Euler": IntegrationMethod.BACKWARD_EULER,
    "Trapezoidal": IntegrationMethod.TUSTIN,
}


@dataclass(frozen=True)
class Dialog:
    """A block's parameters as numbers; `sample_time` (s) is the rate that the block runs at."""

    block: SimulinkBlock
    name: str
    variables: Mapping[str, float]
    sample_time: float

    def text(self, name: str, default: str = "") -> str:
        """A parameter as it stands in the file."""
        return self.block.parameters.get(name, default).strip()

    def number(self, name: str, default: str) -> float:
        """A scalar parameter."""
        return scalar(self.text(name, default) or default, self.variables)

    def numbers(self, name: str, default: str) -> tuple[float, ...]:
        """A vector parameter."""
        return tuple(vector(self.text(name, default) or default, self.variables))

    def samples(self, seconds: float) -> int:
        """A time as a whole number of samples."""
        count = round(seconds / self.sample_time)
        if not math.isclose(count * self.sample_time, seconds, rel_tol=1e-6, abs_tol=1e-12):
            raise ValueError(f"{seconds} s is no whole number of samples")
        return count

    def refuse(self, name: str, allowed: tuple[str, ...]) -> None:
        """Raise unless a parameter has one of these values or is not there."""
        if self.text(name) and self.text(name) not in allowed:
            raise ValueError(f"{name} '{self.text(name)}' is not supported")


Maker = Callable[[Dialog], Block]


def _sum(d: Dialog) -> Block:
    text = d.text("Inputs", "++").replace("|", "")
    signs = "+" * int(text) if text.isdigit() else text
    if len(signs) < 2:
        raise ValueError("a sum over the elements of one vector")
    if signs[0] == "-":
        raise ValueError("a sum whose first sign is minus; put a plus first")
    return Sum(d.name, signs=signs)


def _twin(name: str, function: Callable[..., float], c: str, ada: str) -> CustomFunction:
    return CustomFunction(name, function=function, c=c, ada=ada)


def _product(d: Dialog) -> Block:
    text = d.text("Inputs", "2")
    if text in ("2", "**"):
        return _twin(d.name, lambda a, b: a * b, "return a * b;", "return A * B;")
    if text == "*/":
        return _twin(d.name, lambda a, b: a / b, "return a / b;", "return A / B;")
    raise ValueError(f"a product with the inputs '{text}'")


def _minmax(d: Dialog) -> Block:
    if d.text("Inputs", "1") != "2":
        raise ValueError("minimum or maximum of other than two inputs")
    if d.text("Function", "min") == "min":
        return _twin(d.name, lambda a, b: a if a < b else b, "return (a < b) ? a : b;",
                     "return (if A < B then A else B);")  # fmt: skip
    return _twin(d.name, lambda a, b: a if a > b else b, "return (a > b) ? a : b;",
                 "return (if A > B then A else B);")  # fmt: skip


_COMPARISONS: Mapping[str, Callable[..., float]] = {
    "<": lambda a, b: 1.0 if a < b else 0.0,
    "<=": lambda a, b: 1.0 if a <= b else 0.0,
    ">": lambda a, b: 1.0 if a > b else 0.0,
    ">=": lambda a, b: 1.0 if a >= b else 0.0,
}


def _relation(d: Dialog) -> Block:
    sign = d.text("Operator", ">=")
    if sign not in _COMPARISONS:
        raise ValueError(f"the comparison '{sign}'")
    return _twin(d.name, _COMPARISONS[sign], f"return (a {sign} b) ? 1.0F : 0.0F;",
                 f"return (if A {sign} B then 1.0 else 0.0);")  # fmt: skip


def _logic(d: Dialog) -> Block:
    kind = d.text("Operator", "AND")
    if kind == "NOT":
        return _twin(d.name, lambda a: 1.0 if abs(a) < 0.5 else 0.0,
                     "return ((a < 0.5F) && (a > -0.5F)) ? 1.0F : 0.0F;",
                     "return (if A < 0.5 and then A > -0.5 then 1.0 else 0.0);")  # fmt: skip
    if d.text("Inputs", "2") != "2" or kind not in ("AND", "OR"):
        raise ValueError(f"the operation {kind} of {d.text('Inputs', '2')} inputs")
    if kind == "AND":
        return _twin(d.name, lambda a, b: 1.0 if a > 0.5 and b > 0.5 else 0.0,
                     "return ((a > 0.5F) && (b > 0.5F)) ? 1.0F : 0.0F;",
                     "return (if A > 0.5 and then B > 0.5 then 1.0 else 0.0);")  # fmt: skip
    return _twin(d.name, lambda a, b: 1.0 if a > 0.5 or b > 0.5 else 0.0,
                 "return ((a > 0.5F) || (b > 0.5F)) ? 1.0F : 0.0F;",
                 "return (if A > 0.5 or else B > 0.5 then 1.0 else 0.0);")  # fmt: skip


def _saturation(d: Dialog) -> Block:
    low, high = d.number("LowerLimit", "-0.5"), d.number("UpperLimit", "0.5")
    if low == -high:
        return Saturation(d.name, limit=high)
    if not low < high or not math.isfinite(high - low):
        raise ValueError("limits that do not rise or are infinite")
    return LookupTable(d.name, breakpoints=(low, high), table=(low, high))


def _integrator(d: Dialog) -> Block:
    d.refuse("ExternalReset", ("none",))
    d.refuse("LimitOutput", ("off",))
    d.refuse("InitialConditionSource", ("internal",))
    name = d.text("IntegratorMethod", "Integration: Forward Euler").partition(": ")
    if name[0] == "Accumulation":
        step = 1.0
    else:
        step = d.sample_time
    gain = d.number("gainval", "1.0") * step
    return DiscreteIntegrator(
        d.name, gain=gain, method=_METHODS[name[2]], initial=d.number("InitialCondition", "0")
    )


def _rational(d: Dialog) -> Block:
    top = d.numbers("Numerator", "[1]")
    bottom = d.numbers("Denominator", "[1 0.5]")
    if d.block.kind == "DiscreteFilter":  # in powers of 1/z
        width = max(len(top), len(bottom))
        top, bottom = (tuple(p) + (0.0,) * (width - len(p)) for p in (top, bottom))
    if len(bottom) == 1:
        return Gain(d.name, gain=top[0] / bottom[0])
    return transfer_function_block(d.name, control.tf(top, bottom, d.sample_time))


def _zero_pole(d: Dialog) -> Block:
    gain = d.number("Gain", "1")
    zeros, poles = d.numbers("Zeros", "[1]"), d.numbers("Poles", "[0 0.5]")
    top, bottom = gain * np.atleast_1d(np.poly(zeros)), np.poly(poles)
    if d.block.kind == "ZeroPole":
        return _sampled(d, control.tf(top, bottom))
    return transfer_function_block(d.name, control.tf(top, bottom, d.sample_time))


def _sampled(d: Dialog, system: control.TransferFunction) -> Block:
    """A continuous block by Tustin's method at the diagram's rate."""
    found = discretise(system, d.sample_time, DiscretisationMethod.TUSTIN)
    return transfer_function_block(d.name, found)


def _fir(d: Dialog) -> Block:
    top = d.numbers("Coefficients", "[0.5 0.5]")
    if len(top) == 1:
        return Gain(d.name, gain=top[0])
    bottom = (1.0, *(0.0,) * (len(top) - 1))
    return transfer_function_block(d.name, control.tf(top, bottom, d.sample_time))


def _state_space(d: Dialog) -> Block:
    parts = [matrix(d.text(part, "1") or "1", d.variables) for part in "ABCD"]
    if len(parts[2]) != 1:
        raise ValueError("a state space with several outputs")
    discrete = d.block.kind == "DiscreteStateSpace"
    system = control.ss(*parts, d.sample_time) if discrete else control.ss(*parts)
    if not discrete:
        system = control.sample_system(system, d.sample_time, "bilinear")
    start = d.numbers("X0", "0") if d.text("X0") else ()
    if any(start) and not discrete:
        raise ValueError("an initial state of a continuous state space")
    block = state_space_block(d.name, system)
    whole = start * len(parts[0]) if len(start) == 1 else start
    return replace(block, initial=tuple(whole)) if any(start) else block


def _switch(d: Dialog) -> Block:
    d.refuse("Criteria", ("u2 >= Threshold", "u2>=Threshold"))
    return Switch(d.name, threshold=d.number("Threshold", "0"))


def _table(d: Dialog) -> Block:
    if d.block.kind == "Lookup_n-D":
        if d.text("NumberOfTableDimensions", "1") != "1":
            raise ValueError("a table of several dimensions")
        points, values = d.numbers("BreakpointsForDimension1", "[0 1]"), d.numbers("Table", "[0 1]")
        onwards = d.text("ExtrapMethod", "Linear") == "Linear"
        return LookupTable(d.name, breakpoints=points, table=values, extrapolate=onwards)
    points, values = d.numbers("InputValues", "[0 1]"), d.numbers("Table", "[0 1]")
    onwards = d.text("LookUpMeth", "").startswith("Interpolation-Extra")
    return LookupTable(d.name, breakpoints=points, table=values, extrapolate=onwards)


def _delay(d: Dialog) -> Block:
    d.refuse("DelayLengthSource", ("Dialog",))
    length = d.number("DelayLength", "2") if d.block.kind == "Delay" else d.number("NumDelays", "4")
    initial = d.number("InitialCondition", "0.0") if d.text("InitialCondition") else 0.0
    return Delay(d.name, length=int(length), initial=initial)


def _rate_limit(d: Dialog) -> Block:
    step = d.sample_time
    rising = d.number("RisingSlewLimit", "1") * step
    falling = -d.number("FallingSlewLimit", "-1") * step
    return RateLimit(d.name, rising=rising, falling=falling)


def _relay(d: Dialog) -> Block:
    return Relay(
        d.name,
        on_above=d.number("OnSwitchValue", "eps"),
        off_below=d.number("OffSwitchValue", "eps"),
        on_value=d.number("OnOutputValue", "1"),
        off_value=d.number("OffOutputValue", "0"),
    )


def _step(d: Dialog) -> Block:
    at = d.samples(d.number("Time", "1"))
    return Step(d.name, at_sample=at, before=d.number("Before", "0"), after=d.number("After", "1"))


def _pulse(d: Dialog) -> Block:
    if d.number("PhaseDelay", "0") != 0:
        raise ValueError("a pulse with a phase delay")
    amplitude = d.number("Amplitude", "1")
    if d.text("PulseType", "Sample based") == "Sample based":
        period, width = d.number("Period", "2"), d.number("PulseWidth", "1")
        return Pulse(d.name, amplitude=amplitude, period=int(period), width=int(width))
    period = d.number("Period", "2")
    width = d.samples(period * d.number("PulseWidth", "5") / 100)
    return Pulse(d.name, amplitude=amplitude, period=d.samples(period), width=width)


def _sine(d: Dialog) -> Block:
    if d.number("Phase", "0") or d.number("Bias", "0"):
        raise ValueError("a sine with phase or bias")
    period = d.samples(math.tau / d.number("Frequency", "1"))
    return Sine(d.name, amplitude=d.number("Amplitude", "1"), period=period)


def _bias(d: Dialog) -> Block:
    offset = d.number("Bias", "0.0")
    return _twin(d.name, lambda a: a + type(a)(offset), f"return a + ({float(offset)!r}F);",
                 f"return A + ({float(offset)!r});")  # fmt: skip


def _gain(d: Dialog) -> Block:
    return Gain(d.name, gain=d.number("Gain", "1"))


def _same(d: Dialog) -> Block:
    return Gain(d.name, gain=1.0)


def _data_type(d: Dialog) -> Block:
    d.refuse("OutDataTypeStr", ("single", "double", "Inherit: Inherit via back propagation",
                                "Inherit: auto"))  # fmt: skip
    return _same(d)


def _initial(d: Dialog) -> float:
    for name in ("InitialCondition", "X0"):
        if d.text(name):
            return d.number(name, "0")
    return 0.0


MAKERS: Mapping[str, Maker] = {
    "Abs": lambda d: _twin(d.name, lambda a: abs(a), "return (a < 0.0F) ? -a : a;",
                           "return (if A < 0.0 then -A else A);"),
    "Backlash": lambda d: Backlash(
        d.name, width=d.number("BacklashWidth", "1"), initial=d.number("InitialOutput", "0")
    ),
    "Bias": _bias,
    "Constant": lambda d: Constant(d.name, value=d.number("Value", "1")),
    "DataTypeConversion": _data_type,
    "DeadZone": lambda d: DeadZone(
        d.name, start=d.number("LowerValue", "-0.5"), end=d.number("UpperValue", "0.5")
    ),
    "Delay": _delay,
    "DiscreteFilter": _rational,
    "DiscreteFir": _fir,
    "DiscreteIntegrator": _integrator,
    "DiscretePulseGenerator": _pulse,
    "DiscreteStateSpace": _state_space,
    "DiscreteTransferFcn": _rational,
    "DiscreteZeroPole": _zero_pole,
    "Gain": _gain,
    "Ground": lambda d: Constant(d.name, value=0.0),
    "Integrator": lambda d: _sampled(d, control.tf([1.0], [1.0, 0.0])) if not _initial(d)
    else DiscreteIntegrator(d.name, gain=d.sample_time, method=IntegrationMethod.TUSTIN,
                            initial=_initial(d)),
    "Logic": _logic,
    "Lookup": _table,
    "Lookup_n-D": _table,
    "Memory": lambda d: UnitDelay(d.name, initial=_initial(d)),
    "MinMax": _minmax,
    "Product": _product,
    "Quantizer": lambda d: Quantiser(d.name, interval=d.number("QuantizationInterval", "0.5")),
    "RateLimiter": _rate_limit,
    "RateTransition": lambda d: ZeroOrderHold(d.name),
    "RelationalOperator": _relation,
    "Relay": _relay,
    "Saturate": _saturation,
    "SignalConversion": _same,
    "SignalSpecification": _same,
    "Signum": lambda d: _twin(
        d.name, lambda a: 1.0 if a > 0 else (-1.0 if a < 0 else 0.0),
        "return (a > 0.0F) ? 1.0F : ((a < 0.0F) ? -1.0F : 0.0F);",
        "return (if A > 0.0 then 1.0 elsif A < 0.0 then -1.0 else 0.0);",
    ),
    "Sin": _sine,
    "StateSpace": _state_space,
    "Step": _step,
    "Sum": _sum,
    "Switch": _switch,
    "TransferFcn": lambda d: _sampled(
        d, control.tf(d.numbers("Numerator", "[1]"), d.numbers("Denominator", "[1 1]"))
    ),
    "UnaryMinus": lambda d: Gain(d.name, gain=-1.0),
    "UnitDelay": lambda d: UnitDelay(d.name, initial=_initial(d)),
    "ZeroOrderHold": lambda d: ZeroOrderHold(d.name),
    "ZeroPole": _zero_pole,
}  # fmt: skip
