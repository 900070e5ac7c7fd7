# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks of Simulink's own library that a model file only names."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

from ravenbrick.model import CustomFunction, Merge, Ramp
from ravenbrick.simulink.blocks.arithmetic import ARITHMETIC
from ravenbrick.simulink.blocks.elementary import ONE
from ravenbrick.simulink.blocks.memory import MEMORY
from ravenbrick.simulink.blocks.noise import NOISE
from ravenbrick.simulink.blocks.sources import SOURCES, sequence
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.libraries import tight
from ravenbrick.simulink.signals import Wire

__all__ = ["CLOCKS", "library_maker", "library_name", "only_checks", "own_library"]

_BITS = 24
_OWN = ("simulink", "simulink_extras", "simulink_need_slupdate", "slpidlib", "pid_lib", "cstblocks")


def _three(b: Builder) -> list[tuple[Wire, ...]]:
    """Upper, value, lower: the ports of the dynamic blocks."""
    width = b.width()
    return list(zip(*(b.inputs(port, width) for port in (1, 2, 3)), strict=True))


def _saturation(b: Builder) -> None:
    b.out([b.limited(wire, low, high) for high, wire, low in _three(b)])


def _dead_zone(b: Builder) -> None:
    b.out([b.sum(wire, b.limited(wire, low, high), signs="+-") for high, wire, low in _three(b)])


def _rate_limit(b: Builder) -> None:
    """Rates per second from outside; begins at 0."""
    found: list[Wire] = []
    for high, wire, low in _three(b):
        state = b.add(Merge("B", ports=2), b.constant(1.0), ending="_rate")
        last = b.last(state)
        change = b.sum(wire, last, signs="+-")
        bounds = (b.scaled(b.sample_time, low), b.scaled(b.sample_time, high))
        state.inputs.append(b.sum(last, b.limited(change, *bounds)))
        found.append(state)
    b.out(found)


def _changes(operator: str) -> Callable[[Builder], None]:
    """Detect Change, Increase, Decrease: beside the value of the step before."""

    def make(b: Builder) -> None:
        initial = b.dialog().number("vinit", "0")
        b.out([b.compare(wire, operator, b.last(wire, initial)) for wire in b.inputs()])

    return make


def _crossing(operator: str) -> Callable[[Builder], None]:
    """Detect Rise and Fall: a condition that holds now and did not before."""

    def make(b: Builder) -> None:
        initial = b.dialog().number("vinit", "0")
        found: list[Wire] = []
        for wire in b.inputs():
            now = b.compare(wire, operator, 0.0)
            before = b.logic("NOT", b.last(now, initial))
            found.append(b.logic("AND", now, before))
        b.out(found)

    return make


def _interval_test(b: Builder) -> None:
    d = b.dialog()
    high = "<=" if d.text("IntervalClosedRight", "on") == "on" else "<"
    low = ">=" if d.text("IntervalClosedLeft", "on") == "on" else ">"
    b.out([b.logic("AND", b.compare(wire, high, d.number("uplimit", "0.5")),
                   b.compare(wire, low, d.number("lowlimit", "-0.5")))
           for wire in b.inputs()])  # fmt: skip


def _difference(b: Builder) -> None:
    initial = b.dialog().number("ICPrevInput", "0")
    b.out([b.sum(wire, b.last(wire, initial), signs="+-") for wire in b.inputs()])


def _friction(b: Builder) -> None:
    """sign(u) (gain |u| + offset)."""
    found: list[Wire] = []
    for element, wire in enumerate(b.inputs(1, b.width("offset", "gain"))):
        d = b.dialog(element=element)
        viscous, offset = b.scaled(d.number("gain", "1"), wire), d.number("offset", "[1 3 2 0]")
        dry = [b.scaled(offset, ONE["sign"](b, wire))] if offset else []
        found.append(b.sum(viscous, *dry))
    b.out(found)


def _slider_gain(b: Builder) -> None:
    gain = b.dialog().number("gain", b.dialog().text("Gain", "1"))
    b.out([b.scaled_block(gain, wire) for wire in b.inputs()])


def _flip_flop(b: Builder) -> None:
    """Set before reset; both at once reset it, as in the library's table of states."""
    initial = b.dialog().number("initial_condition", "0")
    one, zero = b.constant(1.0), b.constant(0.0)
    on = b.logic("OR", b.inputs(1)[0])
    off = b.logic("OR", b.inputs(2)[0])
    state = b.add(Merge("B", ports=4, initial=initial), off, zero, on, one)
    b.out([state])
    b.out([b.logic("AND", b.logic("NOT", state), b.logic("NOT", b.logic("AND", on, off)))], 2)


def _counter(b: Builder) -> Wire:
    """Time in seconds, from 0."""
    return b.add(Ramp("B", slope=b.sample_time), ending="_time")


def _clock(b: Builder) -> None:
    b.out([_counter(b)])


def _stairs(b: Builder) -> None:
    """A sequence of values, one per sample, again and again."""
    values = b.dialog().numbers("OutValues", "[3 1 4 2 1]")
    b.out([sequence(b, values)])


def _always(b: Builder) -> None:
    """A call in every step of its own rate."""
    b.out([b.constant(1.0)])


def _bitwise(b: Builder) -> None:
    """Bits of whole numbers from 0 to 2^24 - 1, with a mask."""
    d = b.dialog()
    kind = d.text("logicop", "AND")
    signs = {"AND": "&", "OR": "|", "XOR": "^"}
    if kind not in signs or d.text("UseBitMask", "on") != "on" or b.ports() != 1:
        raise ValueError(f"the operation {kind} of {b.ports()} signals, bit by bit")
    text = re.sub(r"(?:hex2dec|bin2dec)\('([0-9A-Fa-f]+)'\)",
                  lambda m: str(int(m[1], 16 if m[0].startswith("hex") else 2)),
                  d.text("BitMask", "bin2dec('11011001')"))  # fmt: skip
    mask = int(d.number_of(text))
    if not 0 <= mask < 1 << _BITS:
        raise ValueError(f"a mask of more than {_BITS} bits")
    b.out([b.add(_bits(signs[kind], mask), wire) for wire in b.inputs()])


def _bits(sign: str, mask: int) -> CustomFunction:
    most = (1 << _BITS) - 1

    def function(a: float) -> float:
        whole = int(min(max(a, 0.0), most))
        return float({"&": whole & mask, "|": whole | mask, "^": whole ^ mask}[sign])

    word = {"&": "and", "|": "or", "^": "xor"}[sign]
    return CustomFunction(
        "B",
        function=function,
        c=f"const real32_T b = (a > 0.0F) ? ((a < {most}.0F) ? a : {most}.0F) : 0.0F;\n"
        f"return (real32_T)((uint32_T)b {sign} {mask}U);",
        ada="declare\n   type Word is mod 2 ** 32;\n"
        f"   B : constant Float := Float'Max (0.0, Float'Min (A, {most}.0));\n"
        f"begin\n   return Float (Word (Float'Truncation (B)) {word} {mask});\nend;",
    )


def _converted(factor: float, offset: float = 0.0) -> Callable[[Builder], None]:
    """Another unit of the same quantity."""

    def make(b: Builder) -> None:
        scaled = [b.scaled(factor, wire) for wire in b.inputs()]
        b.out([b.sum(one, b.constant(offset)) if offset else one for one in scaled])

    return make


_LIBRARY: Mapping[str, Callable[[Builder], None]] = {
    "Bitwise Operator": _bitwise,
    "Coulomb & Viscous Friction": _friction,
    "Celsius to Fahrenheit": _converted(1.8, 32.0),
    "Dead Zone Dynamic": _dead_zone,
    "Degrees to Radians": _converted(math.pi / 180),
    "Detect Change": _changes("~="),
    "Detect Decrease": _changes("<"),
    "Detect Increase": _changes(">"),
    "Detect Fall Negative": _crossing("<"),
    "Detect Fall Nonpositive": _crossing("<="),
    "Detect Rise Nonnegative": _crossing(">="),
    "Detect Rise Positive": _crossing(">"),
    "Difference": _difference,
    "Fahrenheit to Celsius": _converted(1 / 1.8, -32 / 1.8),
    "Function-Call Generator": _always,
    "Interval Test": _interval_test,
    "Radians to Degrees": _converted(180 / math.pi),
    "Rate Limiter Dynamic": _rate_limit,
    "Repeating Sequence Stair": _stairs,
    "S-R Flip-Flop": _flip_flop,
    "Saturation Dynamic": _saturation,
    "Slider Gain": _slider_gain,
}
CLOCKS: Mapping[str, Callable[[Builder], None]] = {"Clock": _clock, "DigitalClock": _clock}


def own_library(source: str) -> bool:
    """Whether a link leads into Simulink's own library of mathematical blocks."""
    return source.partition("/")[0] in _OWN


def only_checks(source: str) -> bool:
    """Whether a link leads to a block that only checks signals or the linearised model."""
    return tight(source.split("/")[1] if "/" in source else "") == "Model Verification"


def library_maker(source: str) -> Callable[[Builder], None] | None:
    """What makes a block that a link of Simulink's own library names."""
    if not own_library(source):
        return None
    name = library_name(source)
    short = f"simulink/{name}"
    for table in (ARITHMETIC, MEMORY, NOISE, SOURCES):
        if short in table:
            return table[short]
    return _LIBRARY.get(name)


def library_name(source: str) -> str:
    """The name of a block in a library, without line breaks."""
    return tight(source.replace("//", "\0").rpartition("/")[2].replace("\0", "/"))
