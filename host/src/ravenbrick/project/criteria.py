# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a run is expected to show; `expectation_text` reads them, `verdict` judges them."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "DeadlinesMet",
    "Expectation",
    "FaultExpected",
    "LcdShows",
    "MeasureBound",
    "PathEnd",
    "PoweredOff",
    "ResponseBound",
    "SignalBound",
    "Window",
]


@dataclass(frozen=True)
class Window:
    """A part of a run, in s; None where nothing was named. `instant`: begin and end are one."""

    begin: float | None = None
    end: float | None = None
    at_end: bool = False

    @property
    def instant(self) -> bool:
        """Whether the window is one instant."""
        return self.at_end or (self.begin is not None and self.begin == self.end)

    @property
    def last_named(self) -> float:
        """The latest instant that was named; 0 when there is none."""
        return max(self.begin or 0.0, self.end or 0.0)


@dataclass(frozen=True)
class Expectation:
    """`text` as it was written, `place` where; `window` limits what is looked at."""

    text: str
    place: str
    window: Window


@dataclass(frozen=True)
class SignalBound(Expectation):
    """A signal stays within bounds (SI) throughout the window, or is at least once (`ever`)."""

    signal: str
    minimum: float | None
    maximum: float | None
    unit: str | None
    ever: bool


@dataclass(frozen=True)
class MeasureBound(Expectation):
    """A measure of the whole run, such as `distance`, lies within bounds."""

    measure: str
    minimum: float | None
    maximum: float | None


@dataclass(frozen=True)
class LcdShows(Expectation):
    """A line of the LCD contains a text at some time in the window, or (`never`) at none."""

    wanted: str
    never: bool


@dataclass(frozen=True)
class DeadlinesMet(Expectation):
    """No job of a task, or of any task (None), misses its deadline."""

    task: str | None


@dataclass(frozen=True)
class ResponseBound(Expectation):
    """The longest response time of a task is at most `limit` (s)."""

    task: str
    limit: float


@dataclass(frozen=True)
class PathEnd(Expectation):
    """The vehicle ends within a circle; m."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class PoweredOff(Expectation):
    """The program switches the brick off, within the window."""


@dataclass(frozen=True)
class FaultExpected(Expectation):
    """The program survives, or (`wanted`) stops with a fault, whose text or LCD says `saying`."""

    wanted: bool
    saying: str
