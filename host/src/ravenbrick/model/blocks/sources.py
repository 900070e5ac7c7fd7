# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Signals made inside a diagram, timed in samples: exact, without drift."""

from __future__ import annotations

from dataclasses import dataclass

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Block, Inputs, Value
from ravenbrick.model.blocks.trigonometry import sine_of_turns

__all__ = ["Pulse", "Ramp", "Sine", "Step"]

_MOST_SAMPLES = 1 << 22


class _Counter(Block):
    """A block with the number of the step as its state; counts are exact in both formats."""

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """No input port."""
        return ()

    def _last(self) -> int:
        """The highest count."""
        raise NotImplementedError

    def _repeats(self) -> bool:
        """Whether 0 follows the highest count; else it stays there."""
        return True

    def _check_samples(self, least: int, **counts: int) -> None:
        for name, count in counts.items():
            if not least <= count <= _MOST_SAMPLES:
                raise ValueError(
                    f"block '{self.name}': {name} must lie between {least} and {_MOST_SAMPLES} "
                    f"samples, not {count}"
                )

    def states(self) -> tuple[ir.Slot, ...]:
        """The count."""
        return (self._state("DSTATE", 0.0),)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """Count on."""
        state = self.states()[0]
        last = self._literal(float(self._last()))
        after = self._literal(0.0) if self._repeats() else last
        following = ir.Binary("+", ir.Read(state), self._literal(1.0))
        return ((state, ir.Select(ir.Comparison(">=", ir.Read(state), last), after, following)),)


@dataclass(frozen=True)
class Step(_Counter):
    """`before` until step `at_sample` (from 0), `after` from then on."""

    at_sample: int = 0
    before: Value = 0.0
    after: Value = 1.0

    def __post_init__(self) -> None:
        self._check_samples(0, at_sample=self.at_sample)

    def values(self) -> tuple[Value, ...]:
        """Both levels."""
        return self.before, self.after

    def _last(self) -> int:
        return self.at_sample

    def _repeats(self) -> bool:
        return False

    def output(self, inputs: Inputs) -> ir.Expression:
        """One test."""
        reached = ir.Comparison(
            ">=", ir.Read(self.states()[0]), self._literal(float(self.at_sample))
        )
        return ir.Select(reached, self._value(self.after), self._value(self.before))


@dataclass(frozen=True)
class Ramp(_Counter):
    """`initial` until step `at_sample`, from then on rising by `slope` per step.

    It ends after `last_sample` steps, at most 4,194,304. In fixed point it needs an end early
    enough that the height keeps the accuracy wanted.
    """

    slope: Value = 1.0
    at_sample: int = 0
    initial: Value = 0.0
    last_sample: int = _MOST_SAMPLES

    def __post_init__(self) -> None:
        self._check_samples(0, at_sample=self.at_sample, last_sample=self.last_sample)

    def values(self) -> tuple[Value, ...]:
        """Slope and initial value."""
        return self.slope, self.initial

    def _last(self) -> int:
        return self.last_sample

    def _repeats(self) -> bool:
        return False

    def output(self, inputs: Inputs) -> ir.Expression:
        """The count since the start times the slope: no sum of rounding errors."""
        count, start = ir.Read(self.states()[0]), self._literal(float(self.at_sample))
        since = ir.Select(
            ir.Comparison(">", count, start), ir.Binary("-", count, start), self._literal(0.0)
        )
        return ir.Binary(
            "+", self._value(self.initial), ir.Binary("*", self._value(self.slope), since)
        )


@dataclass(frozen=True)
class Pulse(_Counter):
    """`amplitude` for the first `width` of every `period` samples, else 0."""

    amplitude: Value = 1.0
    period: int = 2
    width: int = 1

    def __post_init__(self) -> None:
        self._check_samples(2, period=self.period)
        if not 0 < self.width < self.period:
            raise ValueError(
                f"block '{self.name}': the width must lie between 1 and {self.period - 1} samples, "
                f"not {self.width}"
            )

    def values(self) -> tuple[Value, ...]:
        """The amplitude."""
        return (self.amplitude,)

    def _last(self) -> int:
        return self.period - 1

    def output(self, inputs: Inputs) -> ir.Expression:
        """One test."""
        on = ir.Comparison("<", ir.Read(self.states()[0]), self._literal(float(self.width)))
        return ir.Select(on, self._value(self.amplitude), self._literal(0.0))


@dataclass(frozen=True)
class Sine(_Counter):
    """`amplitude` sin(2 pi k / `period`), k the step from 0, `period` in samples.

    By folding into a quarter period and a Taylor polynomial of degree 11 (single precision, error
    below 3e-7 of the amplitude) or 21 (double precision, below 1e-15). Needs no C library.
    """

    amplitude: Value = 1.0
    period: int = 100

    def __post_init__(self) -> None:
        self._check_samples(2, period=self.period)

    def values(self) -> tuple[Value, ...]:
        """The amplitude."""
        return (self.amplitude,)

    def _last(self) -> int:
        return self.period - 1

    def intermediates(self, inputs: Inputs) -> Assignments:
        """Turns minus one half, folded into a quarter turn around 0, and their square."""
        turns, angle, square = (self._local(name) for name in ("turns", "angle", "square"))
        share = ir.Binary("*", self._literal(1.0 / self.period), ir.Read(self.states()[0]))
        half, value = self._literal(0.5), ir.Read(turns)
        low = ir.Select(
            ir.Comparison("<", value, self._literal(-0.25)),
            ir.Binary("-", self._literal(-0.5), value),
            value,
        )
        folded = ir.Select(
            ir.Comparison(">", value, self._literal(0.25)), ir.Binary("-", half, value), low
        )
        return (
            (turns, ir.Binary("-", share, half)),
            (angle, folded),
            (square, ir.Binary("*", ir.Read(angle), ir.Read(angle))),
        )

    def output(self, inputs: Inputs) -> ir.Expression:
        """Minus the sine of the folded angle, by Horner's rule."""
        angle, square = ir.Read(self._local("angle")), ir.Read(self._local("square"))
        wave = sine_of_turns(self, angle, square, sign=-1.0)
        return ir.Binary("*", self._value(self.amplitude), wave)
