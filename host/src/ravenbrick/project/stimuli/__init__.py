# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Inputs with exact instants, and how they are read from files.

A stimulus file holds values over time. Only changes become inputs: every switch, angle and torque
starts at 0, and a value equal to the one before is not applied again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from ravenbrick.clock import Clock
from ravenbrick.errors import ProjectFileError, ScenarioError

__all__ = ["Channels", "InputCheck", "Sequence", "TimedInput", "read_stimulus"]

InputCheck = Callable[[str], str | None]
# Before the first value; the battery's voltage is what robot.toml says.
START: Mapping[str, float] = {"touch": 0.0, "button": 0.0, "motor": 0.0}


@dataclass(frozen=True)
class TimedInput:
    """An input at a cycle of the run; `place` says where it was written down."""

    at_cycles: int
    name: str
    value: float
    place: str = ""


@dataclass(frozen=True)
class Channels:
    """Which column or variable is which input; without `names`, they are called like the inputs."""

    check: InputCheck
    names: Mapping[str, str] = field(default_factory=dict)

    def input_of(self, path: Path, line: int, channel: str) -> str | None:
        """Name of the input; None when the channel is not to be used.

        Raises `ProjectFileError` for an input that the robot does not have.
        """
        if self.names and channel not in self.names:
            return None
        name = self.names.get(channel, channel)
        problem = self.check(name)
        if problem:
            raise ProjectFileError(path, line, channel, problem)
        return name

    def require(self, path: Path, line: int, found: set[str]) -> None:
        """Raise `ProjectFileError` for the first wanted channel that the file does not have."""
        for channel in self.names:
            if channel not in found:
                known = ", ".join(sorted(found)) or "none"
                raise ProjectFileError(
                    path, line, channel, f"there is no such column or variable; it has: {known}"
                )


class Sequence:
    """Collects changes in the order of time; `delay` (s) comes before the file's instant 0."""

    def __init__(self, path: Path, clock: Clock, delay: Fraction = Fraction(0)) -> None:
        self.path = path
        self.clock = clock
        self._delay = delay
        self._last: dict[str, float] = {}
        self._now = Fraction(0)
        self._cycle = 0
        self.inputs: list[TimedInput] = []

    def at(self, line: int, seconds: Fraction) -> None:
        """Go on to an instant of the file (s); the cycle is rounded up, as for scenarios."""
        if seconds < self._now:
            raise ProjectFileError(
                self.path,
                line,
                "time",
                f"{float(seconds):g} s comes after {float(self._now):g} s; sort the file by time",
            )
        self._now = seconds
        self._cycle = math.ceil((seconds + self._delay) * self.clock.hertz)

    def set(self, line: int, name: str, value: float) -> None:
        """Apply a value at the present instant when it differs from the one before."""
        if not math.isfinite(value):
            raise ProjectFileError(self.path, line, name, f"is {value}; expected a finite number")
        before = self._last.get(name, START.get(name.split(".")[0]))
        self._last[name] = value
        if before is None or value != before:
            self.inputs.append(TimedInput(self._cycle, name, value, f"{self.path}:{line}"))


def read_stimulus(
    path: Path, clock: Clock, channels: Channels, delay_ms: int = 0
) -> tuple[TimedInput, ...]:
    """Read a .csv or .vcd file, or a run that the page saved (.json).

    Raises `ScenarioError` for a missing file, `ProjectFileError` with file and line for a wrong
    one, `ToolMissingError` when the library for the format is not installed.
    """
    from ravenbrick.project.stimuli import csv_file as stimulus_csv
    from ravenbrick.project.stimuli import run_file as stimulus_run
    from ravenbrick.project.stimuli import vcd_file as stimulus_vcd

    readers = {
        ".csv": stimulus_csv.read,
        ".json": stimulus_run.read,
        ".vcd": stimulus_vcd.read,
    }
    reader = readers.get(path.suffix.lower())
    if reader is None:
        known = ", ".join(readers)
        raise ProjectFileError(path, 1, "", f"is none of {known}; convert it to one of them")
    if not path.is_file():
        raise ScenarioError(f"{path}: there is no such stimulus file; correct its name")
    sequence = Sequence(path, clock, Fraction(delay_ms, 1000))
    reader(sequence, channels)
    return tuple(sequence.inputs)
