# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sources in continuous time: functions of the time with jumps at known instants."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Inputs
from ravenbrick.model.blocks.continuous import ContinuousBlock

__all__ = ["TICK", "TIME", "TimeFunction", "pulse", "ramp", "sine", "step", "white_noise"]

TICK = 1e-9
"""Two instants closer than this (s) are one."""

TIME = ir.Slot(ir.Kind.INPUT, "the time", ir.DataType.REAL64, "")
"""The time (s), which the simulation gives to the program."""


@dataclass(frozen=True)
class TimeFunction(ContinuousBlock):
    """A function of the time in seconds; `breaks` gives the instants of its jumps up to one.

    `derivative` gives the function's derivative, if it is known.
    """

    function: Callable[[float], float] = field(default=float, repr=False, compare=False)
    breaks: Callable[[float], list[float]] = field(default=lambda _: [], repr=False, compare=False)
    derivative: Callable[[], TimeFunction] | None = field(default=None, repr=False, compare=False)

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """No input port."""
        return ()

    def output(self, inputs: Inputs) -> ir.Expression:
        """One call."""
        time = ir.Read(TIME)
        return ir.Call(self.name, ("t",), (time,), ir.DataType.REAL64, "", "", self.function)


def step(name: str, at: float, before: float = 0.0, after: float = 1.0) -> TimeFunction:
    """A jump at an instant (s)."""
    return TimeFunction(
        name, function=lambda t: after if t >= at - TICK / 2 else before, breaks=lambda _: [at]
    )


def sine(
    name: str, amplitude: float, frequency: float, phase: float = 0.0, bias: float = 0.0
) -> TimeFunction:
    """`frequency` in rad/s, `phase` in rad."""
    return TimeFunction(
        name,
        function=lambda t: amplitude * math.sin(frequency * t + phase) + bias,
        derivative=lambda: sine(name, amplitude * frequency, frequency, phase + math.pi / 2),
    )


def ramp(name: str, slope: float = 1.0) -> TimeFunction:
    """A line from 0."""
    return TimeFunction(
        name,
        function=lambda t: slope * t,
        derivative=lambda: TimeFunction(
            name, function=lambda _: slope, derivative=lambda: ramp(name, 0.0)
        ),
    )


def pulse(
    name: str, amplitude: float, period: float, width: float, delay: float = 0.0
) -> TimeFunction:
    """`amplitude` for `width` s of each `period` (s), the first after `delay` (s)."""

    def function(t: float) -> float:
        place = (t - delay + TICK / 2) % period
        return amplitude if t >= delay - TICK / 2 and place < width else 0.0

    def breaks(until: float) -> list[float]:
        count = max(math.floor((until - delay) / period), 0) + 1
        begins = [delay + number * period for number in range(count)]
        return begins + [begin + width for begin in begins]

    return TimeFunction(name, function=function, breaks=breaks)


def white_noise(name: str, deviation: float, sample_time: float, seed: int) -> TimeFunction:
    """Normal random numbers with mean 0, a new one every `sample_time` (s); same seed, same run.

    Held for a time h, numbers of deviation s have the spectral density s**2 h at low frequencies.
    """
    generator = np.random.default_rng(seed)
    numbers: list[float] = []

    def function(t: float) -> float:
        place = max(math.floor(t / sample_time + TICK / sample_time), 0)
        while place >= len(numbers):
            numbers.extend(float(value) for value in generator.normal(0.0, deviation, 256))
        return numbers[place]

    def breaks(until: float) -> list[float]:
        return [number * sample_time for number in range(math.floor(until / sample_time) + 1)]

    return TimeFunction(name, function=function, breaks=breaks)
