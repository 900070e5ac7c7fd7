# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Judging expectations: the value that a run gave, and whether it is what was expected."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import ScenarioError
from ravenbrick.project import criteria
from ravenbrick.trace.recording import Recording, Screen
from ravenbrick.trace.schedule import TaskMeasures
from ravenbrick.units import UNITS, signal_unit

__all__ = ["ALIVE", "Measured", "Verdict", "expects_fault", "judge"]

ALIVE = ("reached", "power_off")


class Measured(Protocol):
    """What a run was measured to be, as far as expectations ask for it."""

    @property
    def tasks(self) -> tuple[TaskMeasures, ...]:
        """Its tasks."""

    def value(self, measure: str) -> float | None:
        """A measure by its name; None when the run did not reach it."""


@dataclass(frozen=True)
class Verdict:
    """The value that decided (SI, or a text), when it was seen (s), and the judgement."""

    expectation: criteria.Expectation
    value: float | str | None
    unit: str
    at: float | None
    met: bool

    @property
    def label(self) -> str:
        """The expectation as it was written."""
        return self.expectation.text

    @property
    def shown(self) -> str:
        """The value for people."""
        if isinstance(self.value, float):
            return f"{self.value:.4g} {self.unit}".rstrip()
        return self.value if self.value is not None else "none"

    @property
    def sentence(self) -> str:
        """What is wrong, with file and line where there is one."""
        when = f" at {self.at:.6f} s" if self.at is not None else ""
        return f"{self.expectation.place}: expected {self.label}, found {self.shown}{when}"

    def as_json(self) -> dict[str, object]:
        """With plain types."""
        return {
            "expectation": self.label,
            "value": self.value,
            "unit": self.unit,
            "at": self.at,
            "met": self.met,
        }


def expects_fault(expectations: Sequence[criteria.Expectation]) -> bool:
    """Whether faults are judged by an expectation instead of ending the command."""
    return any(isinstance(e, criteria.FaultExpected) for e in expectations)


def _unreachable(expectation: criteria.Expectation, problem: str) -> ScenarioError:
    return ScenarioError(f"{expectation.place}: '{expectation.text}': {problem}")


def _span(expectation: criteria.Expectation, recording: Recording) -> tuple[float, float]:
    """Begin and end of the window in s; raises `ScenarioError` when the run ended before."""
    window: criteria.Window = expectation.window
    end = recording.clock.seconds(recording.stop.at_cycles)
    if window.at_end:
        return end, end
    if window.last_named > end:
        raise _unreachable(
            expectation,
            f"{window.last_named:g} s never comes: the run ended after {end:.6f} s "
            f"({recording.stop.reason.replace('_', ' ')}); name an earlier time",
        )
    return (window.begin or 0.0), (end if window.end is None else window.end)


def _within(values: NDArray[np.float64], bound: criteria.SignalBound) -> NDArray[np.bool_]:
    good = np.ones(values.shape, dtype=bool)
    if bound.minimum is not None:
        good &= values >= bound.minimum
    if bound.maximum is not None:
        good &= values <= bound.maximum
    return good


def _distance(values: NDArray[np.float64], bound: criteria.SignalBound) -> NDArray[np.float64]:
    """How far values lie outside of the bounds; negative inside."""
    below = -np.inf if bound.minimum is None else bound.minimum - values
    above = -np.inf if bound.maximum is None else values - bound.maximum
    return np.maximum(below, above) * np.ones(values.shape)


@functools.singledispatch
def judge(expectation: criteria.Expectation, recording: Recording, measures: Measured) -> Verdict:
    """Judge one expectation; raises `ScenarioError` when the run can never show it."""
    raise TypeError(f"no judgement for {type(expectation).__name__}")


@judge.register(criteria.SignalBound)
def _signal(expectation: criteria.SignalBound, recording: Recording, measures: Measured) -> Verdict:
    if expectation.signal not in recording.signals:
        known = ", ".join(sorted(recording.signals))
        raise _unreachable(
            expectation, f"the signal '{expectation.signal}' was not recorded; recorded: {known}"
        )
    begin, end = _span(expectation, recording)
    times, values = recording.signal(expectation.signal)
    # A sample holds until the next one, so the window begins with the sample in force.
    first = max(int(np.searchsorted(times, begin, side="right")) - 1, 0)
    last = int(np.searchsorted(times, end, side="right"))
    seen = values[first : max(last, first + 1)]
    if not seen.size:
        raise _unreachable(expectation, "there is no sample in this time; lengthen it")
    distance = _distance(seen, expectation)
    index = int(np.argmin(distance) if expectation.ever else np.argmax(distance))
    good = _within(seen, expectation)
    size = UNITS[expectation.unit][1] if expectation.unit else 1.0
    unit = expectation.unit or signal_unit(expectation.signal)
    at = float(times[first + index])
    met = bool(np.any(good) if expectation.ever else np.all(good))
    return Verdict(expectation, float(seen[index]) / size, unit, at, met)


@judge.register(criteria.MeasureBound)
def _measure(
    expectation: criteria.MeasureBound, recording: Recording, measures: Measured
) -> Verdict:
    value = measures.value(expectation.measure)
    if value is None:
        raise _unreachable(
            expectation,
            f"'{expectation.measure}' was never reached in the run; check the inputs and the "
            "scenario's tables, or lengthen the run",
        )
    low, high = expectation.minimum, expectation.maximum
    met = (low is None or value >= low) and (high is None or value <= high)
    return Verdict(expectation, value, "", None, met)


def _words(text: str) -> str:
    return " ".join(text.split())


def _screens(expectation: criteria.Expectation, recording: Recording) -> list[tuple[float, Screen]]:
    """The screens of the window with their instants; the one in force at its begin too."""
    begin, end = _span(expectation, recording)
    if not any(screen.text for screen in recording.screens):
        raise _unreachable(
            expectation,
            "the LCD cannot be read: the image lacks the project's letters; use package NXT.LCD",
        )
    timed = [(recording.clock.seconds(s.at_cycles), s) for s in recording.screens]
    before = [item for item in timed if item[0] <= begin]
    return [*before[-1:], *(item for item in timed if begin < item[0] <= end)]


@judge.register(criteria.LcdShows)
def _lcd(expectation: criteria.LcdShows, recording: Recording, measures: Measured) -> Verdict:
    wanted = _words(expectation.wanted)
    seen = _screens(expectation, recording)
    for at, screen in seen:
        lines = [_words(line) for line in screen.text if wanted in _words(line)]
        if lines:
            return Verdict(expectation, lines[0], "", at, not expectation.never)
    if expectation.never or not seen:
        return Verdict(expectation, None, "", None, expectation.never)
    return Verdict(expectation, _text(seen[-1][1]), "", seen[-1][0], False)


def _text(screen: Screen) -> str:
    return " / ".join(_words(line) for line in screen.text if line.strip()) or "(empty)"


def _tasks(
    expectation: criteria.Expectation, name: str | None, measures: Measured
) -> list[TaskMeasures]:
    found = [t for t in measures.tasks if name is None or t.name.lower() == name.lower()]
    if not found:
        known = ", ".join(task.name for task in measures.tasks) or "none"
        raise _unreachable(expectation, f"there is no task '{name}'; the image has: {known}")
    return found


@judge.register(criteria.DeadlinesMet)
def _deadlines(
    expectation: criteria.DeadlinesMet, recording: Recording, measures: Measured
) -> Verdict:
    tasks = _tasks(expectation, expectation.task, measures)
    bounded = [task for task in tasks if task.deadline_cycles is not None]
    if not bounded:
        raise _unreachable(expectation, "no deadline is known; give one in robot.toml, [[tasks]]")
    missed = sum(task.deadline_misses for task in bounded)
    return Verdict(expectation, float(missed), "missed", None, missed == 0)


@judge.register(criteria.ResponseBound)
def _response(
    expectation: criteria.ResponseBound, recording: Recording, measures: Measured
) -> Verdict:
    (task,) = _tasks(expectation, expectation.task, measures)[:1]
    if task.response_time_cycles_max is None:
        raise _unreachable(expectation, "no job of the task completed; lengthen the run")
    longest = recording.clock.seconds(task.response_time_cycles_max)
    return Verdict(expectation, longest, "s", None, longest <= expectation.limit)


@judge.register(criteria.PathEnd)
def _path(expectation: criteria.PathEnd, recording: Recording, measures: Measured) -> Verdict:
    if "body.x" not in recording.signals:
        raise _unreachable(expectation, "no vehicle drives: the scenario uses the bench")
    _, x = recording.signal("body.x")
    times, y = recording.signal("body.y")
    off = math.hypot(float(x[-1]) - expectation.x, float(y[-1]) - expectation.y)
    value = f"({x[-1]:.4f}, {y[-1]:.4f}) m, {off:.4f} m off"
    return Verdict(expectation, value, "", float(times[-1]), off <= expectation.radius)


@judge.register(criteria.PoweredOff)
def _power(expectation: criteria.PoweredOff, recording: Recording, measures: Measured) -> Verdict:
    end = recording.clock.seconds(recording.stop.at_cycles)
    off = recording.stop.reason == "power_off"
    window = expectation.window
    after = window.begin is None or end >= window.begin
    met = off and after and (window.end is None or end <= window.end)
    return Verdict(expectation, recording.stop.reason.replace("_", " "), "", end, met)


@judge.register(criteria.FaultExpected)
def _fault(
    expectation: criteria.FaultExpected, recording: Recording, measures: Measured
) -> Verdict:
    stop = recording.stop
    alive = stop.reason in ALIVE
    end: Any = None if alive else recording.clock.seconds(stop.at_cycles)
    if alive:
        return Verdict(expectation, "no fault", "", None, not expectation.wanted)
    said = [stop.message, *(recording.screens[-1].text if recording.screens else ())]
    value = " / ".join(_words(text) for text in said if text.strip()) or stop.reason
    met = expectation.wanted and _words(expectation.saying) in value
    return Verdict(expectation, value, "", end, met)
