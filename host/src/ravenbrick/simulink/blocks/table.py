# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulink's block types and what they are in a diagram."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ravenbrick.control.synthesis.discretisation import DiscretisationMethod, discretise
from ravenbrick.model import (
    Abs,
    Backlash,
    Block,
    Constant,
    DeadZone,
    Delay,
    Gain,
    Pulse,
    Quantiser,
    Ramp,
    RateLimit,
    Relay,
    RoundingFunction,
    Sign,
    Sine,
    Step,
    Switch,
    Trigonometry,
    UnitDelay,
    ZeroOrderHold,
    ZeroPoleGain,
    state_space_block,
    transfer_function_block,
)
from ravenbrick.model.blocks import time_functions
from ravenbrick.model.blocks.continuous import ContinuousStateSpace
from ravenbrick.model.blocks.implicit import LateSignal
from ravenbrick.model.blocks.time_functions import TimeFunction
from ravenbrick.model.lazy import control
from ravenbrick.simulink.blocks.arithmetic import ARITHMETIC
from ravenbrick.simulink.blocks.conditions import CONDITIONS
from ravenbrick.simulink.blocks.elementary import ELEMENTARY
from ravenbrick.simulink.blocks.library import CLOCKS
from ravenbrick.simulink.blocks.lookup import LOOKUP
from ravenbrick.simulink.blocks.memory import MEMORY
from ravenbrick.simulink.blocks.noise import NOISE
from ravenbrick.simulink.blocks.programs import PROGRAMS
from ravenbrick.simulink.blocks.routing import ROUTING
from ravenbrick.simulink.blocks.sources import SOURCES
from ravenbrick.simulink.builder import Builder, ContinuousForm, Dialog
from ravenbrick.simulink.matlab.linear_systems import LTI, system_of
from ravenbrick.simulink.numbers import matrix, value_of
from ravenbrick.simulink.signals import Tap, Wire

__all__ = ["IGNORED", "IN_TIME", "MAKERS", "STRUCTURE"]

IGNORED = frozenset(
    """Scope Display ToWorkspace ToFile Terminator XYGraph FloatingScope Annotation
    Assertion DataTypeDuplicate DataTypePropagation MessageViewer SpectrumAnalyzer
    LampBlock GaugeBlock DisplayBlock EditField RadioButtonGroup SliderBlock SliderSwitchBlock
    KnobBlock RockerSwitchBlock ToggleSwitchBlock RotarySwitchBlock PushButtonBlock Checkbox
    ComboBox CircularGaugeBlock LinearGaugeBlock SemiCircularGaugeBlock QuarterGaugeBlock
    DashboardScope MultiStateImageBlock""".split()
)
STRUCTURE = frozenset(
    """Inport InportShadow Outport SubSystem Goto From GotoTagVisibility ActionPort EnablePort
    TriggerPort ModelReference""".split()
)
_WIDENING = {
    "Bias": ("Bias",), "DiscretePulseGenerator": ("Amplitude", "Period", "PulseWidth"),
    "Memory": ("InitialCondition", "X0"), "Sin": ("Amplitude", "Frequency",
    "Phase"), "Step": ("Before", "After"), "UnitDelay": ("InitialCondition", "X0"),
}  # fmt: skip

Maker = Callable[[Dialog], Block]
_SHORT = 1e-4


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
    if d.block.kind == "ZeroPole" and d.form is ContinuousForm.TUSTIN:
        roots = ZeroPoleGain(tuple(map(complex, zeros)), tuple(map(complex, poles)), gain)
        return transfer_function_block(d.name, roots, sample_time=d.sample_time)
    if d.block.kind == "ZeroPole":
        top, bottom = gain * np.atleast_1d(np.poly(zeros)), np.poly(poles)
        return _sampled(d, control.tf(top, bottom))
    moved = [tuple(complex(root - 1) for root in roots) for roots in (zeros, poles)]
    return transfer_function_block(d.name, ZeroPoleGain(moved[0], moved[1], gain, d.sample_time))


def _transfer_function(d: Dialog) -> Block:
    top, bottom = d.numbers("Numerator", "[1]"), d.numbers("Denominator", "[1 1]")
    if len(np.trim_zeros(top, "f")) > len(np.trim_zeros(bottom, "f")):
        raise ValueError(
            "its numerator is of a higher degree than its denominator, which Simulink refuses too; "
            "add a pole well above the bandwidth"
        )
    return _sampled(d, control.tf(top, bottom))


def _sampled(d: Dialog, system: control.TransferFunction) -> Block:
    """A continuous block at the diagram's rate, or as it is in a simulation."""
    if len(np.trim_zeros(system.den[0][0], "f")) == 1:
        return Gain(d.name, gain=float(system.num[0][0][-1] / system.den[0][0][-1]))
    if d.form is ContinuousForm.SOLVED:
        return ContinuousStateSpace.of(d.name, system)
    if d.form is ContinuousForm.HELD:
        system = discretise(system, d.sample_time, DiscretisationMethod.ZERO_ORDER_HOLD)
    return transfer_function_block(d.name, system, sample_time=d.sample_time)


def _fir(d: Dialog) -> Block:
    top = d.numbers("Coefficients", "[0.5 0.5]")
    if len(top) == 1:
        return Gain(d.name, gain=top[0])
    bottom = (1.0, *(0.0,) * (len(top) - 1))
    return transfer_function_block(d.name, control.tf(top, bottom, d.sample_time))


def _state_space(b: Builder) -> None:
    """One vector in, one vector out."""
    d = b.dialog("B")
    parts = [matrix(d.text(part, "1") or "1", d.variables) for part in "ABCD"]
    _linear(b, parts, d.numbers("X0", "0") if d.text("X0") else ())


def _transfer_functions(b: Builder) -> None:
    """Of one number or element by element; with a matrix of numerators one output for each row."""
    d = b.dialog("B")
    rows = value_of(d.text("Numerator", "[1]") or "[1]", d.variables)
    if len(rows) == 1 or (1 in rows.shape and d.guesses("Numerator")):
        _each(_transfer_function)(b)
        return
    bottom = np.trim_zeros(np.array(d.numbers("Denominator", "[1 1]")), "f")
    order, top = len(bottom) - 1, rows / bottom[0]
    bottom = bottom / bottom[0]
    if rows.shape[1] > order + 1 or order == 0:
        raise ValueError("its numerators are of a higher degree than its denominator")
    top = np.pad(top, ((0, 0), (order + 1 - top.shape[1], 0)))
    direct = top[:, :1]
    states = np.vstack([-bottom[1:], np.eye(order - 1, order)])
    _linear(b, [states.tolist(), np.eye(order, 1).tolist(),
                (top[:, 1:] - direct * bottom[1:]).tolist(), direct.tolist()], ())  # fmt: skip


def _lti_system(b: Builder) -> None:
    """A system of the workspace, or as an expression such as `tf(1, [1 1])`."""
    d = b.dialog("B")
    system = system_of(d.text("sys", "1"), d.variables)
    start = d.numbers("IC", "[]") if d.text("IC", "[]") != "[]" else ()
    if isinstance(system, np.ndarray):
        if system.size != 1:
            raise ValueError("a matrix in place of a system")
        b.out([b.scaled_block(float(system[0, 0]), wire) for wire in b.inputs()])
    elif isinstance(system, control.TransferFunction) and not start:
        sampled = control.isdtime(system, strict=True)
        block = transfer_function_block("B", system) if sampled else _sampled(d, system)
        b.out([b.add(block, wire) for wire in b.inputs()])
    else:
        whole = control.ss(system)
        parts = [part.tolist() for part in (whole.A, whole.B, whole.C, whole.D)]
        _linear(b, parts, start, discrete=control.isdtime(system, strict=True))


def _linear(
    b: Builder, parts: list[list[list[float]]], start: tuple[float, ...], *, discrete: bool = False
) -> None:
    """A linear system with its matrices A, B, C, D."""
    discrete = discrete or b.site.kind == "DiscreteStateSpace"
    system = control.ss(*parts, b.sample_time) if discrete else control.ss(*parts)
    if not discrete and b.form is ContinuousForm.SOLVED:
        block: Block = ContinuousStateSpace.of("B", system, start)
    else:
        if not discrete:
            held = b.form is ContinuousForm.HELD
            system = control.sample_system(system, b.sample_time, "zoh" if held else "bilinear")
        if any(start) and not discrete:
            raise ValueError("an initial state of a continuous state space")
        sampled = state_space_block("B", system)
        whole = start * len(parts[0]) if len(start) == 1 else start
        block = replace(sampled, initial=tuple(whole)) if any(start) else sampled
    node = b.add(block, *b.inputs(1, len(block.input_types)))
    count = block.output_count
    b.out([node] if count == 1 else [Tap(node, output) for output in range(count)])


def _switch(d: Dialog) -> Block:
    criteria = d.text("Criteria", "u2 >= Threshold").replace(" ", "")
    criterion = {"u2>=Threshold": ">=", "u2>Threshold": ">", "u2~=0": "~="}.get(criteria)
    if criterion is None:
        raise ValueError(f"Criteria '{criteria}' is not supported")
    threshold = 0.0 if criterion == "~=" else d.number("Threshold", "0")
    return Switch(d.name, threshold=threshold, criterion=criterion)


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


def _pulse(b: Builder) -> None:
    """After a phase delay, which is a delay of the samples."""
    found: list[Wire] = []
    for element in range(b.width(*_WIDENING["DiscretePulseGenerator"])):
        d = b.dialog(element=element)
        counts = d.text("PulseType", "Sample based") == "Sample based"
        late = d.number("PhaseDelay", "0")
        wire: Wire = b.add(_pulses(d))
        length = (int(late) if counts else d.samples(late)) if late else 0
        if length < 0:
            raise ValueError("a pulse with a negative phase delay")
        if length:
            wire = b.add(Delay("B", length=length), wire, ending="_late")
        found.append(wire)
    b.out(found)


def _pulses(d: Dialog) -> Block:
    amplitude = d.number("Amplitude", "1")
    if d.text("PulseType", "Sample based") == "Sample based":
        period, width = d.number("Period", "2"), d.number("PulseWidth", "1")
        return Pulse(d.name, amplitude=amplitude, period=int(period), width=int(width))
    period = d.number("Period", "2")
    count = d.samples(period)
    width = d.samples(period * d.number("PulseWidth", "5") / 100)
    if d.variables.guess:
        count = max(count, 2)
        width = min(max(width, 1), count - 1)
    return Pulse(d.name, amplitude=amplitude, period=count, width=width)


def _sine(b: Builder) -> None:
    found: list[Wire] = []
    for element in range(b.width(*_WIDENING["Sin"])):
        d = b.dialog(element=element)
        amplitude, bias = d.number("Amplitude", "1"), d.number("Bias", "0")
        if d.text("SineType", "Time based") == "Sample based":
            step = math.tau / d.number("Samples", "10")
            phase = step * d.number("Offset", "0")
        else:
            step = d.number("Frequency", "1") * b.sample_time
            phase = d.number("Phase", "0")
        period = math.tau / step if step else 0.0
        if (
            phase == 0
            and bias == 0
            and 2 <= round(period)
            and math.isclose(round(period), period, rel_tol=1e-9)
        ):
            found.append(b.add(Sine("B", amplitude=amplitude, period=round(period))))
            continue
        angle = b.add(Ramp("B", slope=step, initial=phase), ending="_angle")
        wave = b.scaled(amplitude, b.add(Trigonometry("B"), angle))
        found.append(b.sum(wave, b.constant(bias)) if bias else wave)
    b.out(found)


def _step_in_time(d: Dialog) -> TimeFunction:
    return time_functions.step(
        "B", d.number("Time", "1"), d.number("Before", "0"), d.number("After", "1")
    )


def _pulse_in_time(d: Dialog) -> TimeFunction:
    if d.text("PulseType", "Sample based") == "Sample based":
        raise ValueError("a pulse that counts samples, without a sample time; make it time based")
    period = d.number("Period", "2")
    width = period * d.number("PulseWidth", "5") / 100
    return time_functions.pulse(
        "B", d.number("Amplitude", "1"), period, width, d.number("PhaseDelay", "0")
    )


def _sine_in_time(d: Dialog) -> TimeFunction:
    if d.text("SineType", "Time based") == "Sample based":
        raise ValueError("a sine that counts samples; make it time based")
    return time_functions.sine("B", d.number("Amplitude", "1"), d.number("Frequency", "1"),
                           d.number("Phase", "0"), d.number("Bias", "0"))  # fmt: skip


def _in_time(maker: Callable[[Dialog], TimeFunction]) -> Callable[[Builder], None]:
    """A source, element by element, as a function of the time."""

    def make(b: Builder) -> None:
        width = b.width(*_WIDENING.get(b.site.kind, ()))
        b.out([b.add(maker(b.dialog("B", e))) for e in range(width)])

    return make


def _late(d: Dialog) -> Block:
    delay, initial = d.number("DelayTime", "1"), d.number("InitialOutput", "0")
    if delay <= 0:
        return Gain(d.name, gain=1.0)
    return LateSignal(d.name, initial=initial, delay=delay)


def _derivative_in_time(b: Builder) -> None:
    """s / (T s + 1), T a 10,000th of the sample time or of the whole time; 0 for the first 10 T.

    Of a smooth signal `Differentiation` replaces it.
    """
    short = _SHORT * b.sample_time
    found: list[Wire] = []
    for wire in b.inputs():
        filtered = b.integral()
        rate = b.scaled(1 / short, b.sum(wire, filtered, signs="+-"))
        filtered.inputs = [rate]
        found.append(b.choose(b.compare(b.time(), ">=", 10 * short), rate, b.constant(0.0)))
    b.out(found)


def _bias(b: Builder) -> None:
    wires = b.inputs(1, b.width("Bias"))
    b.out([b.sum(wire, b.constant(b.dialog(element=e).number("Bias", "0.0")))
           for e, wire in enumerate(wires)])  # fmt: skip


def _derivative(b: Builder) -> None:
    """The difference from the step before over the step."""
    b.out([b.scaled(1 / b.sample_time, b.sum(wire, b.last(wire), signs="+-"))
           for wire in b.inputs()])  # fmt: skip


def _transport_delay(d: Dialog) -> Block:
    length = d.samples(d.number("DelayTime", "1"))
    if length == 0:
        return Gain(d.name, gain=1.0)
    return Delay(d.name, length=length, initial=d.number("InitialOutput", "0"))


def _rounding(d: Dialog) -> Block:
    return RoundingFunction(d.name, function=d.text("Operator", "floor"))


def _initial(d: Dialog) -> float:
    for name in ("InitialCondition", "X0"):
        if d.text(name):
            return d.number(name, "0")
    return 0.0


def _each(maker: Maker) -> Callable[[Builder], None]:
    """Element by element."""

    def make(b: Builder) -> None:
        width = b.width(*_WIDENING.get(b.site.kind, ()))
        found = []
        for element in range(width):
            block = maker(b.dialog("B", element))
            ports = range(1, len(block.input_types) + 1)
            found.append(b.add(block, *(b.inputs(port, width)[element] for port in ports)))
        b.out(found)

    return make


_SINGLE: Mapping[str, Maker] = {
    "Abs": lambda d: Abs(d.name),
    "Backlash": lambda d: Backlash(
        d.name, width=d.number("BacklashWidth", "1"), initial=d.number("InitialOutput", "0")
    ),
    "DeadZone": lambda d: DeadZone(
        d.name, start=d.number("LowerValue", "-0.5"), end=d.number("UpperValue", "0.5")
    ),
    "DiscreteFilter": _rational,
    "DiscreteFir": _fir,
    "DiscreteTransferFcn": _rational,
    "DiscreteZeroPole": _zero_pole,
    "Ground": lambda d: Constant(d.name, value=0.0),
    "Memory": lambda d: UnitDelay(d.name, initial=_initial(d)),
    "Quantizer": lambda d: Quantiser(d.name, interval=d.number("QuantizationInterval", "0.5")),
    "RateLimiter": _rate_limit,
    "RateTransition": lambda d: ZeroOrderHold(d.name),
    "Relay": _relay,
    "Rounding": _rounding,
    "SignalSpecification": lambda d: Gain(d.name, gain=1.0),
    "Signum": lambda d: Sign(d.name),
    "Step": _step,
    "Switch": _switch,
    "TransportDelay": _transport_delay,
    "UnaryMinus": lambda d: Gain(d.name, gain=-1.0),
    "UnitDelay": lambda d: UnitDelay(d.name, initial=_initial(d)),
    "ZeroOrderHold": lambda d: ZeroOrderHold(d.name),
    "ZeroPole": _zero_pole,
}


def _initial_condition(b: Builder) -> None:
    """A number at the beginning, then the input."""
    wires = b.inputs(1, b.width("Value"))
    begins: Wire = b.add(Step("B", at_sample=1, before=1.0, after=0.0), ending="_begins")
    if b.form is ContinuousForm.SOLVED:
        begins = b.compare(b.time(), "<=", 0.0)
    b.out([b.choose(begins, b.constant(b.dialog(element=e).number("Value", "1")), wire)
           for e, wire in enumerate(wires)])  # fmt: skip


MAKERS: Mapping[str, Callable[[Builder], None]] = {
    **{kind: _each(maker) for kind, maker in _SINGLE.items()},
    **ROUTING,
    **CONDITIONS,
    **ELEMENTARY,
    **PROGRAMS,
    **ARITHMETIC,
    **MEMORY,
    **LOOKUP,
    **NOISE,
    **SOURCES,
    **CLOCKS,
    "Bias": _bias,
    "Derivative": _derivative,
    "DiscretePulseGenerator": _pulse,
    "DiscreteStateSpace": _state_space,
    "InitialCondition": _initial_condition,
    LTI: _lti_system,
    "Sin": _sine,
    "StateSpace": _state_space,
    "TransferFcn": _transfer_functions,
}

# Makers of a simulation in continuous time, in place of those above.
IN_TIME: Mapping[str, Callable[[Builder], None]] = {
    "Clock": lambda b: b.out([b.add(time_functions.ramp("B"))]),
    "Derivative": _derivative_in_time,
    "DiscretePulseGenerator": _in_time(_pulse_in_time),
    "Sin": _in_time(_sine_in_time),
    "Step": _in_time(_step_in_time),
    "TransportDelay": _each(_late),
}
