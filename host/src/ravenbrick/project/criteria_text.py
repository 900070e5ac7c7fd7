# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Expectations in words, one sentence each; the grammar is in docs/reference/trace.md."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from ravenbrick.project.criteria import (
    DeadlinesMet,
    Expectation,
    FaultExpected,
    LcdShows,
    MeasureBound,
    PathEnd,
    PoweredOff,
    ResponseBound,
    SignalBound,
    Window,
)
from ravenbrick.units import UNITS, signal_unit

__all__ = ["PIN", "ExpectationSyntaxError", "expected_pins", "parse_expectation"]

# A pin's level is the signal of this name and its number.
PIN = "pin."

MEASURES = (
    "cpu_utilization",
    "deadline_misses",
    "distance",
    "lateral_deviation",
    "overshoot",
    "settling_time",
    "steady_state_error",
)
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_UNIT = "|".join(sorted(map(re.escape, UNITS), key=len, reverse=True))
_TIME = rf"({_NUMBER}) ?(s|ms)"
_WINDOW = re.compile(
    rf"(?:^| )(?:from {_TIME} to {_TIME}|at {_TIME}|after {_TIME}|before {_TIME}|(at the end))$"
)
_BOUND = rf"(?:between ({_NUMBER}) and ({_NUMBER})|(at least|at most) ({_NUMBER}))(?: ?({_UNIT}))?"
_SIGNAL = re.compile(rf"([A-Za-z_][\w.]*?)( ever)? {_BOUND}")
_PIN = re.compile(r"pin ([12]?\d|3[01])( ever)? (high|low)")
_LCD = re.compile(r'lcd( never)? shows "([^"]+)"')
_DEADLINES = re.compile(r"deadlines met(?: for (\w+))?")
_RESPONSE = re.compile(rf"response time of (\w+) at most ({_NUMBER}) ?(s|ms|us|µs)")
_PATH = re.compile(
    rf"path ends within ({_NUMBER}) ?(m|cm|mm) of "
    rf"\( ?({_NUMBER}) ?, ?({_NUMBER}) ?\)(?: ?(m|cm|mm))?"
)
_FAULT = re.compile(r'(no|a) fault(?: saying "([^"]+)")?')
_POWER = re.compile(r"powered off")
FORMS = (
    "<signal> [ever] between 8 and 9 rad/s [from 3 s to 9 s], <signal> at least 2 m at the end, "
    'pin 17 [ever] high [after 2 s], lcd [never] shows "text" [at 5 s], deadlines met '
    "[for <task>], response time of <task> at most 2 ms, path ends within 10 cm of (3.2, 0.4), "
    'powered off [before 20 s], no fault, a fault [saying "text"]'
)


class ExpectationSyntaxError(ValueError):
    """A sentence that is not an expectation."""


def _seconds(number: str, unit: str) -> float:
    return float(number) * UNITS[unit][1]


def _window(text: str) -> tuple[str, Window]:
    """The sentence without its window, and the window."""
    match = _WINDOW.search(text)
    if match is None:
        return text, Window()
    times = [
        _seconds(match[i], match[i + 1]) if match[i] is not None else None for i in (1, 3, 5, 7, 9)
    ]
    rest = text[: match.start()]
    if match[11]:
        return rest, Window(at_end=True)
    begin, end, instant, after, before = times
    if begin is not None and end is not None and end <= begin:
        raise ExpectationSyntaxError(f"'{match[0].strip()}' is empty; name the earlier time first")
    if instant is not None:
        return rest, Window(instant, instant)
    return rest, Window(begin if begin is not None else after, end if end is not None else before)


def _si(signal: str, unit: str | None) -> float:
    """Size of the written unit in the unit of the signal."""
    if unit is None:
        return 1.0
    wanted, size = UNITS[unit]
    known = signal_unit(signal)
    if known != wanted and not (signal.startswith("probe.") and size == 1.0):
        raise ExpectationSyntaxError(
            f"'{signal}' is in {known or 'no unit'}, not {unit}; write the bound in "
            f"{known or 'plain numbers'}"
        )
    return size


def _bounds(match: re.Match[str], size: float) -> tuple[float | None, float | None]:
    if match[3] is not None:
        low, high = float(match[3]) * size, float(match[4]) * size
        if low > high:
            raise ExpectationSyntaxError(
                f"nothing lies between {match[3]} and {match[4]}; the smaller bound comes first"
            )
        return low, high
    bound = float(match[6]) * size
    return (bound, None) if match[5] == "at least" else (None, bound)


def _signal(match: re.Match[str], text: str, place: str, window: Window) -> Expectation:
    name = match[1]
    if name in MEASURES:
        _whole(window, name)
        size = UNITS[match[7]][1] if match[7] else 1.0
        return MeasureBound(text, place, window, name, *_bounds(match, size))
    size = _si(name, match[7])
    low, high = _bounds(match, size)
    return SignalBound(text, place, window, name, low, high, match[7], match[2] is not None)


def _pin(match: re.Match[str], text: str, place: str, window: Window) -> Expectation:
    low, high = (0.5, None) if match[3] == "high" else (None, 0.5)
    return SignalBound(text, place, window, f"{PIN}{match[1]}", low, high, None, bool(match[2]))


def _whole(window: Window, what: str) -> None:
    if window != Window():
        raise ExpectationSyntaxError(f"'{what}' is of the whole run; leave the time out")


def _lcd(match: re.Match[str], text: str, place: str, window: Window) -> Expectation:
    return LcdShows(text, place, window, match[2], match[1] is not None)


def _deadlines(match: re.Match[str], text: str, place: str, window: Window) -> Expectation:
    _whole(window, "deadlines met")
    return DeadlinesMet(text, place, window, match[1])


def _response(match: re.Match[str], text: str, place: str, window: Window) -> Expectation:
    _whole(window, "response time")
    return ResponseBound(text, place, window, match[1], float(match[2]) * UNITS[match[3]][1])


def _path(match: re.Match[str], text: str, place: str, window: Window) -> Expectation:
    _whole(window, "path ends")
    size = UNITS[match[5] or "m"][1]
    radius = float(match[1]) * UNITS[match[2]][1]
    return PathEnd(text, place, window, float(match[3]) * size, float(match[4]) * size, radius)


def _fault(match: re.Match[str], text: str, place: str, window: Window) -> Expectation:
    _whole(window, "fault")
    if match[1] == "no" and match[2]:
        raise ExpectationSyntaxError("no fault says nothing; leave 'saying' out")
    return FaultExpected(text, place, window, match[1] == "a", match[2] or "")


def _power(match: re.Match[str], text: str, place: str, window: Window) -> Expectation:
    return PoweredOff(text, place, window)


_FORMS: tuple[tuple[re.Pattern[str], Callable[..., Expectation]], ...] = (
    (_PIN, _pin),
    (_LCD, _lcd),
    (_DEADLINES, _deadlines),
    (_RESPONSE, _response),
    (_PATH, _path),
    (_FAULT, _fault),
    (_POWER, _power),
    (_SIGNAL, _signal),
)


def _plain(text: str) -> str:
    """One blank between words, but texts in quotes as they are."""
    pieces = re.split(r'("[^"]*")', text.strip())
    return "".join(p if p.startswith('"') else re.sub(r"\s+", " ", p) for p in pieces)


def parse_expectation(text: str, place: str) -> Expectation:
    """Read one sentence; raises `ExpectationSyntaxError`, which says what the forms are."""
    written = _plain(text)
    sentence, window = _window(written)
    for pattern, build in _FORMS:
        match = pattern.fullmatch(sentence)
        if match:
            return build(match, written, place, window)
    raise ExpectationSyntaxError(f"'{written}' is not an expectation; the forms are: {FORMS}")


def expected_pins(expectations: Iterable[Expectation]) -> list[int]:
    """Pins that expectations speak of: 0 to 31."""
    bounds = (e.signal for e in expectations if isinstance(e, SignalBound))
    numbers = {name.removeprefix(PIN) for name in bounds if name.startswith(PIN)}
    return sorted(int(number) for number in numbers if number in map(str, range(32)))
