# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ramps, counters and the signal generator, sampled and as functions of the time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ravenbrick.model import LookupTable, Merge, Ramp, RoundingFunction, Trigonometry
from ravenbrick.model.blocks.time_functions import TimeFunction
from ravenbrick.simulink.builder import Builder, ContinuousForm
from ravenbrick.simulink.signals import Wire

__all__ = ["SOURCES", "recorded", "sequence"]


def sequence(b: Builder, values: tuple[float, ...]) -> Wire:
    """Values one per sample, again and again."""
    if len(values) == 1:
        return b.constant(values[0])
    numbers = tuple(float(number) for number in range(len(values)))
    place = _place(b, len(values) - 1)
    return b.add(LookupTable("B", breakpoints=numbers, table=values, interpolate=False), place)


def _place(b: Builder, last: int) -> Wire:
    """0, 1, 2 ... `last`, again and again."""
    state = b.add(Merge("B", ports=4), ending="_place")
    before = b.last(state, -1.0)
    again = b.compare(before, ">", last - 0.5)
    following = b.sum(before, b.constant(1.0))
    state.inputs = [again, b.constant(0.0), b.constant(1.0), following]
    return state


def _limited_counter(b: Builder) -> None:
    last = int(b.dialog().number("uplimit", "7"))
    b.out([_place(b, last) if last > 0 else b.constant(0.0)])


def _free_counter(b: Builder) -> None:
    bits = int(b.dialog().number("NumBits", "16"))
    if bits > 22:
        raise ValueError(f"a counter of {bits} bits")
    b.out([_place(b, 2**bits - 1)])


def _ramp(b: Builder) -> None:
    names = ("slope", "start", "InitialOutput")
    found: list[Wire] = []
    for element in range(b.width(*names)):
        d = b.dialog(element=element)
        slope, start = d.number("slope", "1"), d.number("start", "0")
        first = d.number("InitialOutput", d.text("X0", "0"))
        if b.form is ContinuousForm.SOLVED:
            found.append(_in_time(b, _line(slope, start, first), _once(start)))
        else:
            at = d.samples(start) if start else 0
            step = slope * b.sample_time
            found.append(b.add(Ramp("B", slope=step, at_sample=at, initial=first)))
    b.out(found)


def recorded(b: Builder, rows: np.ndarray) -> None:
    """Straight lines between rows of time and values; the last value stays."""
    times = rows[:, 0]
    found = []
    for column in rows.T[1:]:
        values = np.array(column)
        found.append(_in_time(b, _interpolated(times, values), lambda _: times.tolist()))
    b.out(found)


def _interpolated(times: np.ndarray, values: np.ndarray) -> Callable[[float], float]:
    return lambda t: float(np.interp(t, times, values))


def _repeating(b: Builder) -> None:
    """Lines through points in time, again and again."""
    d = b.dialog()
    times, values = d.numbers("rep_seq_t", "[0 2]"), d.numbers("rep_seq_y", "[0 2]")
    period = times[-1] - times[0]
    if len(times) != len(values) or not period > 0:
        raise ValueError("its times do not fit its values")
    lines = _interpolated(np.array(times), np.array(values))
    if b.form is ContinuousForm.SOLVED:
        wave = _repeated(lines, times[0], period)
        b.out([_in_time(b, wave, _multiples(period, times))])
        return
    count = d.samples(period)
    if not 2 <= count <= _LONGEST:
        raise ValueError(f"a period of {count} samples")
    b.out([sequence(b, tuple(lines(times[0] + k * b.sample_time) for k in range(count)))])


def _repeated(
    lines: Callable[[float], float], first: float, period: float
) -> Callable[[float], float]:
    return lambda t: lines(first + (t + _EARLY * period) % period)


def _multiples(period: float, times: tuple[float, ...]) -> Callable[[float], list[float]]:
    """The corners of all periods."""
    corners = [time - times[0] for time in times[:-1]]
    return lambda until: [
        turn * period + corner for turn in range(int(until / period) + 1) for corner in corners
    ]


def _chirp(b: Builder) -> None:
    """A sine whose frequency goes from f1 to f2 (Hz) in T seconds, and on."""
    d = b.dialog()
    first, time, last = d.number("f1", "0.1"), d.number("T", "100"), d.number("f2", "1")
    rise = (last - first) / (2 * time)
    if b.form is ContinuousForm.SOLVED:
        b.out([_in_time(b, lambda t: math.sin(math.tau * (first + rise * t) * t), lambda _: [])])
        return
    t = b.add(Ramp("B", slope=b.sample_time), ending="_time")
    pace = b.sum(b.constant(first), b.scaled(rise, t))
    b.out([b.add(Trigonometry("B"), b.scaled(math.tau, b.product(pace, t)))])


def _line(slope: float, start: float, first: float) -> Callable[[float], float]:
    return lambda t: first + slope * max(t - start, 0.0)


def _once(instant: float) -> Callable[[float], list[float]]:
    return lambda _: [instant]


def _in_time(
    b: Builder, function: Callable[[float], float], breaks: Callable[[float], list[float]]
) -> Wire:
    return b.add(TimeFunction("B", function=function, breaks=breaks))


def _generator(b: Builder) -> None:
    """Sine, square (first +) or falling sawtooth."""
    found: list[Wire] = []
    for element in range(b.width("Amplitude", "Frequency")):
        d = b.dialog(element=element)
        kind = d.text("WaveForm", "sine")
        hertz = d.number("Frequency", "1")
        hertz /= math.tau if d.text("Units", "Hertz").startswith("rad") else 1.0
        if kind not in _WAVES:
            raise ValueError(f"the wave form '{kind}'")
        amplitude = d.number("Amplitude", "1")
        if b.form is ContinuousForm.SOLVED:
            found.append(_in_time(b, _wave(kind, amplitude, hertz), _turns(kind, hertz)))
        else:
            turns = b.add(Ramp("B", slope=hertz * b.sample_time), ending="_turns")
            found.append(b.scaled(amplitude, _sampled_wave(b, kind, turns)))
    b.out(found)


_WAVES: Mapping[str, Callable[[float], float]] = {
    "sine": lambda turn: math.sin(math.tau * turn),
    "square": lambda turn: 1.0 if turn % 1.0 < 0.5 else -1.0,
    "sawtooth": lambda turn: 1.0 - 2.0 * (turn % 1.0),
}
_LONGEST = 1000
_EARLY = 1e-9  # of a turn: an instant just before a jump belongs to it


def _wave(kind: str, amplitude: float, hertz: float) -> Callable[[float], float]:
    if kind == "sine":
        return lambda t: amplitude * _WAVES["sine"](hertz * t)
    return lambda t: amplitude * _WAVES[kind](hertz * t + _EARLY)


def _turns(kind: str, hertz: float) -> Callable[[float], list[float]]:
    """The instants of the jumps."""
    share = {"sine": 0.0, "square": 0.5, "sawtooth": 1.0}[kind]

    def breaks(until: float) -> list[float]:
        if not share or not hertz:
            return []
        return [share * place / abs(hertz) for place in range(int(until * abs(hertz) / share) + 1)]

    return breaks


def _sampled_wave(b: Builder, kind: str, turns: Wire) -> Wire:
    if kind == "sine":
        return b.add(Trigonometry("B"), b.scaled(math.tau, turns))
    whole = b.add(RoundingFunction("B", function="floor"), turns, ending="_whole")
    rest = b.sum(turns, whole, signs="+-")
    if kind == "sawtooth":
        return b.sum(b.constant(1.0), b.scaled(2.0, rest), signs="+-")
    return b.choose(b.compare(rest, "<", 0.5), b.constant(1.0), b.constant(-1.0))


SOURCES: Mapping[str, Callable[[Builder], None]] = {
    "SignalGenerator": _generator,
    "simulink/Counter Free-Running": _free_counter,
    "simulink/Counter Limited": _limited_counter,
    "simulink/Chirp Signal": _chirp,
    "simulink/Ramp": _ramp,
    "simulink/Repeating Sequence": _repeating,
}
