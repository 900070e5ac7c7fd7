# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Integrators and delays with resets, limits and initial values from outside; PID controllers."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ravenbrick.model import Delay, DiscreteIntegrator, IntegrationMethod, Saturation, UnitDelay
from ravenbrick.simulink.blocks.conditions import triggered
from ravenbrick.simulink.builder import Builder, ContinuousForm
from ravenbrick.simulink.signals import Wire

__all__ = ["MEMORY"]

_METHODS = {
    "ForwardEuler": IntegrationMethod.FORWARD_EULER,
    "Forward Euler": IntegrationMethod.FORWARD_EULER,
    "BackwardEuler": IntegrationMethod.BACKWARD_EULER,
    "Backward Euler": IntegrationMethod.BACKWARD_EULER,
    "Trapezoidal": IntegrationMethod.TUSTIN,
}
_FORWARD = IntegrationMethod.FORWARD_EULER
_CONTINUOUS = {ContinuousForm.TUSTIN: IntegrationMethod.TUSTIN, ContinuousForm.HELD: _FORWARD}
_EDGES = ("rising", "falling", "either")


def _reset(b: Builder, kind: str, port: int) -> Wire:
    """1 in the steps that begin anew."""
    if kind in _EDGES:
        return triggered(b, b.inputs(port)[:1], kind)
    return b.compare(b.inputs(port)[0], "~=", 0.0)


def _first_step(b: Builder, count: int = 1) -> Wire:
    """1 in the first steps."""
    return b.add(Delay("B", length=count, initial=1.0), b.constant(0.0), ending="_first")


def _solved_integrator(b: Builder) -> None:
    """In continuous time; one with limits stops at them while its input points outwards."""
    d = b.dialog()
    if d.text("ExternalReset", "none") != "none":
        raise ValueError("an integrator with a reset in continuous time")
    outside = d.text("InitialConditionSource", "internal") == "external"
    wires = b.inputs(1, b.width("InitialCondition"))
    found: list[Wire] = []
    for element, wire in enumerate(wires):
        d = b.dialog(element=element)
        first = 0.0 if outside else d.number("InitialCondition", "0")
        if d.text("LimitOutput", "off") != "on":
            state: Wire = b.integral(wire, first)
        else:
            node = b.integral(initial=first)
            low, high = (d.number(f"{side}SaturationLimit", f"{sign}inf")
                         for side, sign in (("Lower", "-"), ("Upper", "")))  # fmt: skip
            state = b.add(Saturation("B", limit=high, lower=low), node, ending="_limit")
            up = b.logic("AND", b.compare(node, ">=", high), b.compare(wire, ">", 0.0))
            down = b.logic("AND", b.compare(node, "<=", low), b.compare(wire, "<", 0.0))
            node.inputs = [b.choose(b.logic("OR", up, down), b.constant(0.0), wire)]
        found.append(b.sum(state, b.inputs(2, len(wires))[element]) if outside else state)
    b.out(found)


def _integrator(b: Builder) -> None:
    if b.solved and b.site.kind == "Integrator":
        _solved_integrator(b)
        return
    d = b.dialog()
    way, _, method = d.text("IntegratorMethod", "Integration: Forward Euler").partition(": ")
    continuous = b.site.kind == "Integrator"
    step = 1.0 if way == "Accumulation" else b.sample_time
    wires = b.inputs(1, b.width("InitialCondition"))
    reset, outside = d.text("ExternalReset", "none"), d.text("InitialConditionSource", "internal")
    limited = d.text("LimitOutput", "off") == "on"
    found: list[Wire] = []
    for element, wire in enumerate(wires):
        d = b.dialog(element=element)
        gain = step * (1.0 if continuous else d.number("gainval", "1.0"))
        rule = _CONTINUOUS[b.form] if continuous else _METHODS[method]
        initial = d.number("InitialCondition", "0") if outside == "internal" else 0.0
        if (reset, outside, limited) == ("none", "internal", False):
            block = DiscreteIntegrator("B", gain=gain, method=rule, initial=initial)
            found.append(b.add(block, wire))
        else:
            found.append(_steered_integrator(b, element, b.scaled(gain, wire), rule, initial))
    b.out(found)


def _double_integrator(b: Builder) -> None:
    """Position and speed of an acceleration."""
    d = b.dialog()
    for name in ("LimitX", "LimitDXDT"):
        d.refuse(name, ("off",))
    d.refuse("ExternalReset", ("none",))
    for name in ("ICSourceX", "ICSourceDXDT"):
        d.refuse(name, ("internal",))
    places: list[Wire] = []
    speeds: list[Wire] = []
    for element, wire in enumerate(b.inputs(1, b.width("ICX", "ICDXDT"))):
        d = b.dialog(element=element)
        first, pace = d.number("ICX", "0"), d.number("ICDXDT", "0")
        if b.solved:
            speed: Wire = b.integral(wire, pace)
            place: Wire = b.integral(speed, first)
        else:
            rule, step = _CONTINUOUS[b.form], b.sample_time
            block = DiscreteIntegrator("B", gain=step, method=rule, initial=pace)
            speed = b.add(block, wire, ending="_speed")
            block = DiscreteIntegrator("B", gain=step, method=rule, initial=first)
            place = b.add(block, speed)
        places.append(place)
        speeds.append(speed)
    b.out(places)
    b.out(speeds, 2)


def _steered_integrator(
    b: Builder, element: int, step: Wire, rule: IntegrationMethod, initial: float
) -> Wire:
    """A sum with reset, initial value from outside, and limits; `step` is what a sample adds."""
    d = b.dialog(element=element)
    kind, port = d.text("ExternalReset", "none").lower().replace("sampled ", ""), 2
    anew: list[Wire] = []
    if kind != "none":
        anew.append(_reset(b, kind, port))
        port += 1
    start: Wire = b.constant(initial)
    if d.text("InitialConditionSource", "internal") == "external":
        start = b.inputs(port)[min(element, len(b.inputs(port)) - 1)]
        anew.append(_first_step(b))
    limits = None
    if d.text("LimitOutput", "off") == "on":
        low = d.number("LowerSaturationLimit", "-inf")
        limits = Saturation("B", limit=d.number("UpperSaturationLimit", "inf"), lower=low)

    def kept(wire: Wire) -> Wire:
        return wire if limits is None else b.add(limits, wire, ending="_limit")

    state = b.add(UnitDelay("B", initial=initial))
    begun = state if not anew else b.choose(_any(b, anew), start, state)
    half = b.scaled(0.5, step) if rule is IntegrationMethod.TUSTIN else step
    if rule is _FORWARD:
        output, following = kept(begun), None
    else:
        moved = b.sum(begun, half)
        output = kept(moved if not anew else b.choose(_any(b, anew), start, moved))
        following = output if rule is IntegrationMethod.BACKWARD_EULER else None
    state.inputs = [kept(b.sum(output, half)) if following is None else following]
    return output


def _any(b: Builder, tests: list[Wire]) -> Wire:
    return tests[0] if len(tests) == 1 else b.logic("OR", *tests)


def _delay(b: Builder) -> None:
    d = b.dialog()
    d.refuse("DelayLengthSource", ("Dialog",))
    d.refuse("ShowEnablePort", ("off",))
    name = "DelayLength" if b.site.kind == "Delay" else "NumDelays"
    length = int(d.number(name, "2" if name == "DelayLength" else "4"))
    if d.variables.guess:
        length = min(max(length, 1), 10)
    reset = d.text("ExternalReset", "None").lower()
    outside = d.text("InitialConditionSource", "Dialog") != "Dialog"
    wires = b.inputs(1, b.width() if outside else b.width("InitialCondition"))
    if length == 0:
        b.out(wires)
        return
    anew, port = [], 2
    if reset != "none":
        anew.append(_reset(b, reset.replace(" hold", ""), port))
        port += 1
    if (anew or outside) and length > 1 and reset != "none":
        raise ValueError("a delay of several samples with a reset")
    if outside:
        anew.append(_first_step(b, length))
    found: list[Wire] = []
    for element, wire in enumerate(wires):
        one = b.dialog(element=element)
        initial = one.number("InitialCondition", "0.0") if not outside else 0.0
        block = UnitDelay("B", initial=initial)
        last = b.add(block if length == 1 else Delay("B", length=length, initial=initial), wire)
        start: Wire = b.inputs(port, len(wires))[element] if outside else b.constant(initial)
        found.append(b.choose(_any(b, anew), start, last) if anew else last)
    b.out(found)


def _derivative(b: Builder) -> None:
    """The difference from the step before over the sample time."""
    d = b.dialog()
    gain = d.number("gainval", "1.0") / b.sample_time
    found: list[Wire] = []
    for wire in b.inputs():
        scaled = b.scaled(gain, wire)
        found.append(b.sum(scaled, b.last(scaled), signs="+-"))
    b.out(found)


def _pid(b: Builder) -> None:
    """Parallel or ideal form, filtered derivative, limits, clamping or back-calculation."""
    d = b.dialog()
    kind, ideal = d.text("Controller", "PID"), d.text("Form", "Parallel") == "Ideal"
    outside = d.text("SatLimitsSource", "internal") == "external"
    two = "2DOF" in d.text("SourceBlock") or "2dof" in d.text("SourceType")
    most = 2 if two else 3 if outside else 1
    if b.ports() > most:
        raise ValueError("a PID controller with a reset, tracking or gains from outside")
    errors = _errors(b) if two else [b.inputs()[0]] * 3
    gain = b.tunable("P", "1") if "P" in kind or ideal else 1.0
    product = b.scaled(gain, errors[0], "_P")
    terms: list[Wire] = [product] if "P" in kind else []

    def base(place: int) -> Wire:
        if not ideal:
            return errors[place]
        return b.scaled(gain, errors[place], "_P") if two else product

    if "D" in kind:
        terms.append(_rate(b, b.scaled(b.tunable("D", "0"), base(2), "_D")))
    if "I" not in kind:
        b.out([_pid_limited(b, b.sum(*terms))])
        return
    step = 1.0 if b.solved else b.sample_time
    drive = b.scaled(step, b.scaled(b.tunable("I", "1"), base(1), "_I"))
    first = d.number("InitialConditionForIntegrator", "0")
    state = b.integral(initial=first) if b.solved else b.add(UnitDelay("B", initial=first))
    rule = _pid_method(b, "IntegratorMethod")
    present = [] if rule is _FORWARD else [b.scaled(rule.present_share, drive)]
    total = b.sum(*terms, state, *present)
    output = _pid_limited(b, total)
    mode = d.text("AntiWindupMode", "none") if output is not total else "none"
    if rule is not _FORWARD and mode != "none":
        raise ValueError(
            f"anti-windup around an integrator by {rule.value} (an algebraic loop); choose the "
            "integrator method Forward Euler"
        )
    if mode == "back-calculation":
        back = b.scaled(b.tunable("Kb", "1"), b.sum(output, total, signs="+-"))
        drive = b.sum(drive, b.scaled(step, back))
    elif mode == "clamping":
        beyond = b.sum(total, output, signs="+-")
        wound = b.compare(b.product(beyond, drive), ">", 0.0)
        drive = b.choose(wound, b.constant(0.0), drive)
    state.inputs = [drive if b.solved else b.sum(state, drive)]
    b.out([output])


def _errors(b: Builder) -> list[Wire]:
    """Set-point with its weight less the measured value: for P, I and D."""
    d = b.dialog()
    target, measured = b.inputs(1)[0], b.inputs(2)[0]
    weights = (d.number("b", "1"), 1.0, d.number("c", "1"))
    return [b.sum(b.scaled(weight, target, "_weight"), measured, signs="+-") for weight in weights]


def _pid_limited(b: Builder, total: Wire) -> Wire:
    """The output within its limits: of the dialog, or from the ports `up` and `lo`."""
    d = b.dialog()
    if d.text("SatLimitsSource", "internal") == "external":
        high, low = b.inputs(2)[0], b.inputs(3)[0]
        return b.limited(total, low, high)
    if d.text("LimitOutput", "off") != "on":
        return total
    limits = b.limits("UpperSaturationLimit", "LowerSaturationLimit", "inf", "-inf")
    return b.add(limits, total) if limits.values() else total


def _is_discrete(b: Builder) -> bool:
    return b.dialog().text("TimeDomain", "Continuous-time").startswith("Discrete")


def _pid_method(b: Builder, parameter: str) -> IntegrationMethod:
    """The dialog's method; a continuous controller is integrated by forward Euler."""
    name = b.dialog().text(parameter, "Forward Euler") if _is_discrete(b) else "Forward Euler"
    if name not in _METHODS:
        raise ValueError(f"{parameter} '{name}'")
    return _METHODS[name]


def _rate(b: Builder, wire: Wire) -> Wire:
    """N s / (s + N) by the filter's method, by Tustin in continuous time; or the difference."""
    d, step = b.dialog(), b.sample_time
    if _is_discrete(b) and d.text("UseFilter", "on") == "off":
        rate = b.scaled(1 / step, wire)
        return b.sum(rate, b.last(rate), signs="+-")
    pole = d.number("N", "100")
    if b.solved:
        filtered = b.integral()
        rate = b.scaled(pole, b.sum(wire, filtered, signs="+-"))
        filtered.inputs = [rate]
        return rate
    rule = _pid_method(b, "FilterMethod") if _is_discrete(b) else IntegrationMethod.TUSTIN
    state = b.add(UnitDelay("B"), ending="_filter")
    share = pole / (1 + pole * step * rule.present_share)
    output = b.scaled(share, b.sum(wire, state, signs="+-"))
    state.inputs = [b.sum(state, b.scaled(step, output))]
    return output


MEMORY: Mapping[str, Callable[[Builder], None]] = {
    "Delay": _delay,
    "DiscreteIntegrator": _integrator,
    "Integrator": _integrator,
    "IntegerDelay": _delay,
    "SecondOrderIntegrator": _double_integrator,
    "simulink/Integer Delay": _delay,
    "simulink/Discrete Derivative": _derivative,
    "simulink/PID Controller": _pid,
    "simulink/PID Controller (2DOF)": _pid,
    "simulink/Discrete PID Controller": _pid,
    "simulink/Discrete PID Controller (2DOF)": _pid,
}
