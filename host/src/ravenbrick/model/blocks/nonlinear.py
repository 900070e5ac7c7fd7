# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks with thresholds, steps and tables."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Block, Inputs, Value, choose, number

__all__ = ["Backlash", "DeadZone", "LookupTable", "Quantiser", "RateLimit", "Relay", "Switch"]


@dataclass(frozen=True)
class DeadZone(Block):
    """0 between `start` and `end`; outside the distance to the nearer of them."""

    start: Value = -1.0
    end: Value = 1.0

    def __post_init__(self) -> None:
        if not number(self.start) <= number(self.end):
            raise ValueError(
                f"block '{self.name}': the dead zone must begin at or below its end, "
                f"not {number(self.start)} and {number(self.end)}"
            )

    def values(self) -> tuple[Value, ...]:
        """Both ends."""
        return self.start, self.end

    def output(self, inputs: Inputs) -> ir.Expression:
        """Two tests."""
        value, start, end = inputs[0], self._value(self.start), self._value(self.end)
        below = choose(value, "<", start, ir.Binary("-", value, start), self._literal(0.0))
        return choose(value, ">", end, ir.Binary("-", value, end), below)


class _WithMemory(Block):
    """A block whose only state is its last output."""

    def _first(self) -> float:
        return 0.0

    def states(self) -> tuple[ir.Slot, ...]:
        """The last output."""
        return (self._state("DSTATE", self._first()),)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """Store the output."""
        return ((self.states()[0], output),)


@dataclass(frozen=True)
class RateLimit(_WithMemory):
    """The input, moving by at most `rising` up and `falling` down per step.

    For rates per second multiply them by the sample time.
    """

    rising: Value = 1.0
    falling: Value = 1.0
    initial: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("rising", self.rising), ("falling", self.falling)):
            if not number(value) >= 0:
                raise ValueError(
                    f"block '{self.name}': {name} must be >= 0, not {number(value)}; it is a size"
                )

    def values(self) -> tuple[Value, ...]:
        """Both rates."""
        return self.rising, self.falling

    def _first(self) -> float:
        return self.initial

    def intermediates(self, inputs: Inputs) -> Assignments:
        """The change that the input asks for."""
        return ((self._local("change"), ir.Binary("-", inputs[0], ir.Read(self.states()[0]))),)

    def output(self, inputs: Inputs) -> ir.Expression:
        """The input itself if it can be reached."""
        change, last = ir.Read(self._local("change")), ir.Read(self.states()[0])
        rising, falling = self._value(self.rising), self._value(self.falling)
        down = ir.Binary("-", last, falling)
        fall = ir.Binary("-", self._literal(0.0), falling)
        slow = choose(change, "<", fall, down, inputs[0])
        return choose(change, ">", rising, ir.Binary("+", last, rising), slow)


@dataclass(frozen=True)
class Quantiser(Block):
    """The nearest multiple of `interval`, halves away from zero.

    Computed as interval * nearest(u * (1 / interval)).
    """

    interval: float = 1.0

    def __post_init__(self) -> None:
        if not self.interval > 0:
            raise ValueError(f"block '{self.name}': the interval must be > 0, not {self.interval}")

    def output(self, inputs: Inputs) -> ir.Expression:
        """Two products around a rounding."""
        steps = ir.Binary("*", self._literal(1.0 / self.interval), inputs[0])
        return ir.Binary("*", self._literal(self.interval), ir.Rounded(steps))


@dataclass(frozen=True)
class Relay(_WithMemory):
    """`on_value` once the input is >= `on_above`, `off_value` once it is <= `off_below`.

    Between them it stays as it is; it begins off.
    """

    on_above: Value = 0.0
    off_below: Value = 0.0
    on_value: Value = 1.0
    off_value: Value = 0.0

    def __post_init__(self) -> None:
        if not number(self.off_below) <= number(self.on_above):
            raise ValueError(
                f"block '{self.name}': off_below {number(self.off_below)} must not be above "
                f"on_above {number(self.on_above)}"
            )

    def values(self) -> tuple[Value, ...]:
        """Thresholds and outputs."""
        return self.on_above, self.off_below, self.on_value, self.off_value

    def _first(self) -> float:
        return number(self.off_value)

    def output(self, inputs: Inputs) -> ir.Expression:
        """Two tests, on first."""
        keep = ir.Read(self.states()[0])
        off = choose(
            inputs[0], "<=", self._value(self.off_below), self._value(self.off_value), keep
        )
        return choose(inputs[0], ">=", self._value(self.on_above), self._value(self.on_value), off)


@dataclass(frozen=True)
class Backlash(_WithMemory):
    """A gear with play: the output follows when the input has crossed the gap of `width`."""

    width: float = 1.0
    initial: float = 0.0

    def __post_init__(self) -> None:
        if not self.width >= 0:
            raise ValueError(f"block '{self.name}': the width must be >= 0, not {self.width}")

    def _first(self) -> float:
        return self.initial

    def intermediates(self, inputs: Inputs) -> Assignments:
        """The outputs at which the input touches either side."""
        half = self._literal(self.width / 2)
        return (
            (self._local("lower"), ir.Binary("-", inputs[0], half)),
            (self._local("upper"), ir.Binary("+", inputs[0], half)),
        )

    def output(self, inputs: Inputs) -> ir.Expression:
        """The last output, pushed into the gap's new place."""
        last = ir.Read(self.states()[0])
        lower, upper = ir.Read(self._local("lower")), ir.Read(self._local("upper"))
        return choose(last, "<", lower, lower, choose(last, ">", upper, upper, last))


@dataclass(frozen=True)
class Switch(Block):
    """Input 0 while input 1 is >= `threshold`, else input 2; the `criterion` may be > or ~=."""

    threshold: Value = 0.0
    criterion: str = ">="

    def __post_init__(self) -> None:
        if self.criterion not in (">=", ">", "~="):
            raise ValueError(
                f"block '{self.name}': the criterion must be one of >= > ~=, not '{self.criterion}'"
            )

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """First value, control, second value."""
        return (self.data_type,) * 3

    def values(self) -> tuple[Value, ...]:
        """The threshold."""
        return (self.threshold,)

    def output(self, inputs: Inputs) -> ir.Expression:
        """One test, two for ~=."""
        control, threshold = inputs[1], self._value(self.threshold)
        if self.criterion != "~=":
            return choose(control, self.criterion, threshold, inputs[0], inputs[2])
        below = choose(control, "<", threshold, inputs[0], inputs[2])
        return choose(control, ">", threshold, inputs[0], below)


@dataclass(frozen=True)
class LookupTable(Block):
    """Straight lines through the points (`breakpoints`, `table`).

    Outside the outer points the outer values hold, or with `extrapolate` the outer lines go on.
    Without `interpolate` it is a staircase: the value of the last breakpoint reached.
    """

    breakpoints: tuple[float, ...] = (0.0, 1.0)
    table: tuple[float, ...] = (0.0, 1.0)
    extrapolate: bool = False
    interpolate: bool = True

    def __post_init__(self) -> None:
        if len(self.breakpoints) != len(self.table) or len(self.table) < 2:
            raise ValueError(
                f"block '{self.name}': the table needs as many values as breakpoints, at least 2, "
                f"not {len(self.table)} and {len(self.breakpoints)}"
            )
        rounded = [self.data_type.scalar(point) for point in self.breakpoints]
        for left, right in pairwise(rounded):
            if not left < right:
                raise ValueError(
                    f"block '{self.name}': the breakpoints must rise, but {right} follows {left}"
                )

    def output(self, inputs: Inputs) -> ir.Expression:
        """A search and one line."""
        points, table = self.breakpoints, self.table
        slopes = [
            (high - low) / (right - left)
            for (left, right), (low, high) in zip(pairwise(points), pairwise(table), strict=True)
        ]
        if not self.interpolate:
            slopes = [0.0] * len(slopes)
        lines = ir.Table(inputs[0], self.name, points, table, (*slopes, slopes[-1]))
        if self.extrapolate and self.interpolate:
            return lines
        first, last = self._literal(points[0]), self._literal(points[-1])
        upper = choose(inputs[0], ">=", last, self._literal(table[-1]), lines)
        return choose(inputs[0], "<=", first, self._literal(table[0]), upper)
