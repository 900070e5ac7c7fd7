# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Signals made inside a diagram, timed in samples: exact, without drift."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ravenbrick.model.blocks.basic import Block, Value
from ravenbrick.model.blocks.trigonometry import sine_of_turns
from ravenbrick.model.program import (
    Binary,
    Comparison,
    DataType,
    Expression,
    Read,
    Select,
    Slot,
)

__all__ = ["Pulse", "Ramp", "Sine", "Step"]

_MOST_SAMPLES = 1 << 22


class _Counter(Block):
    """A block with the number of the step as its state; counts are exact in both formats."""

    @property
    def input_types(self) -> tuple[DataType, ...]:
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

    def states(self) -> tuple[Slot, ...]:
        """The count."""
        return (self._state("DSTATE", 0.0),)

    def updates(
        self, inputs: Sequence[Expression], output: Expression
    ) -> tuple[tuple[Slot, Expression], ...]:
        """Count on."""
        state = self.states()[0]
        last = self._literal(float(self._last()))
        after = self._literal(0.0) if self._repeats() else last
        following = Binary("+", Read(state), self._literal(1.0))
        return ((state, Select(Comparison(">=", Read(state), last), after, following)),)


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

    def output(self, inputs: Sequence[Expression]) -> Expression:
        """One test."""
        reached = Comparison(">=", Read(self.states()[0]), self._literal(float(self.at_sample)))
        return Select(reached, self._value(self.after), self._value(self.before))


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

    def output(self, inputs: Sequence[Expression]) -> Expression:
        """The count since the start times the slope: no sum of rounding errors."""
        count, start = Read(self.states()[0]), self._literal(float(self.at_sample))
        since = Select(Comparison(">", count, start), Binary("-", count, start), self._literal(0.0))
        return Binary("+", self._value(self.initial), Binary("*", self._value(self.slope), since))


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

    def output(self, inputs: Sequence[Expression]) -> Expression:
        """One test."""
        on = Comparison("<", Read(self.states()[0]), self._literal(float(self.width)))
        return Select(on, self._value(self.amplitude), self._literal(0.0))


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

    def intermediates(self, inputs: Sequence[Expression]) -> tuple[tuple[Slot, Expression], ...]:
        """Turns minus one half, folded into a quarter turn around 0, and their square."""
        turns, angle, square = (self._local(name) for name in ("turns", "angle", "square"))
        share = Binary("*", self._literal(1.0 / self.period), Read(self.states()[0]))
        half, value = self._literal(0.5), Read(turns)
        low = Select(
            Comparison("<", value, self._literal(-0.25)),
            Binary("-", self._literal(-0.5), value),
            value,
        )
        folded = Select(Comparison(">", value, self._literal(0.25)), Binary("-", half, value), low)
        return (
            (turns, Binary("-", share, half)),
            (angle, folded),
            (square, Binary("*", Read(angle), Read(angle))),
        )

    def output(self, inputs: Sequence[Expression]) -> Expression:
        """Minus the sine of the folded angle, by Horner's rule."""
        angle, square = Read(self._local("angle")), Read(self._local("square"))
        wave = sine_of_turns(self, angle, square, sign=-1.0)
        return Binary("*", self._value(self.amplitude), wave)
