# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a simulation finds at each instant beside the states: algebraic loops and late signals."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Block
from ravenbrick.model.blocks.implicit import LateSignal, LoopSignal
from ravenbrick.model.blocks.time_functions import TICK
from ravenbrick.model.simulation.decided_text import read_by
from ravenbrick.model.simulation.python_text import Memory, PythonText

__all__ = ["Implicit"]

Floats = NDArray[np.float64]
_STARTS = (1.0, -1.0, 0.1, 10.0)  # of a loop that has no value at its first guess
_DISTANCES = (1e-6, 1e-3, 1.0, 1e3, 1e6)
_MOST_STEPS = 60
_CLOSE = 1e-13  # relative to the value, of a loop's mismatch
_CLOSE_ENOUGH = 1e-8  # where it does not come closer
_SLOW = 0.1  # of the last mismatch, above which the derivatives are taken anew
_LEAST_SHARE = 2.0**-20  # of a Newton step
_NUDGE = 1e-7
_MOST_ECHOES = 200
_SHARES = (0.25, 0.5, 0.75, 1.0)  # of a solver's step, at which late signals are noted


def _function(
    kept: Sequence[ir.Slot], inputs: Sequence[ir.Slot],
    statements: Sequence[ir.Statement], wanted: Sequence[ir.Statement],
) -> Callable[..., tuple[Any, ...]]:  # fmt: skip
    """What some statements give, and of the others before them only those that they read."""
    whole = [*statements, *wanted]
    read = read_by(whole, [place >= len(statements) for place in range(len(whole))])
    text = PythonText(kept, float)
    text.instructions(one for one, own in zip(statements, read, strict=False) if own)
    return text.function(inputs, [text.expression(s.expression) for s in wanted], keeps=False)


def _is_close_enough(size: float, z: Floats) -> bool:
    """A mismatch of a loop's values from which it does not come closer."""
    return size <= _CLOSE_ENOUGH * max(1.0, float(np.max(np.abs(z))))


class _Mismatch:
    """The loops of some statements, as an equation: what they give, less what was assumed."""

    def __init__(
        self, kept: Sequence[ir.Slot], inputs: Sequence[ir.Slot],
        statements: Sequence[ir.Statement], loops: Sequence[ir.Statement],
    ) -> None:  # fmt: skip
        names = {(slot.kind, slot.name): place for place, slot in enumerate(kept)}
        self.places = [names[one.target.kind, one.target.name] for one in loops]
        self.blocks = [one.block for one in loops]
        self._run = _function(kept, inputs, statements, loops)
        self._inverse: Floats | None = None

    def _of(self, z: Floats, memory: Memory, given: Sequence[float]) -> Floats:
        for place, value in zip(self.places, z, strict=True):
            memory[place] = float(value)
        with np.errstate(all="ignore"):
            try:
                return np.array(self._run(memory, given, None), float) - z
            except (ArithmeticError, ValueError):
                return np.full(len(z), np.nan)

    def close(self, memory: Memory, given: Sequence[float]) -> None:
        """Newton's method from the last values, and halving; raises `DesignError` if both fail."""
        z = np.array([memory[place] for place in self.places])
        for start in (z, *(np.full(len(z), value) for value in _STARTS)):
            found = self._solved(start, memory, given)
            if found is not None:
                return
        if len(z) == 1 and self._between(float(z[0]), memory, given):
            return
        raise DesignError(
            f"the algebraic loop through '{self.blocks[0]}' has no solution that is found at "
            f"{given[-1]:.6g} s; put a delay or a state into it"
        )

    def _between(self, middle: float, memory: Memory, given: Sequence[float]) -> bool:
        """The value of a single loop between two where its mismatch has different signs."""
        from scipy.optimize import brentq  # slow to load

        def mismatch(value: float) -> float:
            return float(self._of(np.array([value]), memory, given)[0])

        for far in _DISTANCES:
            low, high = middle - far, middle + far
            sides = mismatch(low), mismatch(high)
            if np.all(np.isfinite(sides)) and sides[0] * sides[1] < 0:
                found = brentq(mismatch, low, high, xtol=1e-15, rtol=1e-14)
                return _is_close_enough(abs(mismatch(found)), np.array([found]))
        return False

    def _solved(self, z: Floats, memory: Memory, given: Sequence[float]) -> Floats | None:
        rest = self._of(z, memory, given)
        size = float(np.max(np.abs(rest)))
        fresh = False
        for _ in range(_MOST_STEPS):
            if not np.isfinite(size):
                return None
            if size <= _CLOSE * max(1.0, float(np.max(np.abs(z)))):
                return z
            if self._inverse is None:
                self._inverse = self._slopes(z, rest, memory, given)
                fresh = True
                if self._inverse is None:
                    return None
            following, rest_there, size_there = self._step(z, rest, size, memory, given)
            if size_there < size:
                slow = size_there > _SLOW * size
                z, rest, size = following, rest_there, size_there
                if slow:
                    self._inverse, fresh = None, False
            elif fresh:
                break
            else:
                self._inverse = None
        return z if _is_close_enough(size, z) else None

    def _step(
        self, z: Floats, rest: Floats, size: float, memory: Memory, given: Sequence[float]
    ) -> tuple[Floats, Floats, float]:
        """A step of Newton, shortened until the mismatch shrinks."""
        assert self._inverse is not None
        step, share = self._inverse @ rest, 1.0
        while True:
            following = z - share * step
            found = self._of(following, memory, given)
            there = float(np.max(np.abs(found)))
            if there < size or share < _LEAST_SHARE:
                return following, found, there
            share /= 2

    def _slopes(
        self, z: Floats, rest: Floats, memory: Memory, given: Sequence[float]
    ) -> Floats | None:
        """The inverse of the derivatives, by differences; None if it has none."""
        columns = []
        for place, value in enumerate(z):
            moved = z.copy()
            nudge = _NUDGE * max(1.0, abs(value))
            moved[place] += nudge
            columns.append((self._of(moved, memory, given) - rest) / nudge)
        try:
            inverse: Floats = np.linalg.inv(np.array(columns).T)
        except np.linalg.LinAlgError:
            return None
        return inverse if np.all(np.isfinite(inverse)) else None


class _History:
    """A late signal's input over time: points, and cubics between them where it does not jump."""

    def __init__(self, block: LateSignal, place: int) -> None:
        self.block, self.place = block, place
        self._times: list[float] = []
        self._values: list[float] = []

    def note(self, time: float, value: float) -> None:
        """A point; at a jump there are two at one time."""
        self._times.append(time)
        self._values.append(value)

    def at(self, time: float) -> float:
        """The value of `delay` before, at a jump the one after it."""
        then = time - self.block.delay + TICK / 4
        if then < 0 or not self._times:
            return self.block.initial
        place = bisect_right(self._times, then)
        if place == len(self._times):
            return self._values[-1]
        low, high = place - 1, place + 1
        near = self._times[max(low - 1, 0) : high + 1]
        if 0 < low and high < len(self._times) and len(set(near)) == len(near):
            low, high = low - 1, high + 1
        return _through(self._times[low:high], self._values[low:high], then)


def _through(times: Sequence[float], values: Sequence[float], time: float) -> float:
    """The polynomial through some points."""
    total = 0.0
    for own, value in zip(times, values, strict=True):
        for other in times:
            if other != own:
                value *= (time - other) / (own - other)
        total += value
    return total


class Implicit:
    """The implicit signals of a program: their values in the memory belong to the other values.

    `always` are the statements that hold at every instant, `at_samples` those at samples; a loop of
    blocks in `sampled` is closed at samples only.
    """

    def __init__(
        self, kept: Sequence[ir.Slot], inputs: Sequence[ir.Slot],
        always: Sequence[ir.Statement], at_samples: Sequence[ir.Statement],
        own: Sequence[ir.Statement], blocks: Mapping[str, Block], sampled: set[str],
    ) -> None:  # fmt: skip
        loops = [s for s in own if isinstance(blocks[s.block], LoopSignal)]
        late = [s for s in own if isinstance(blocks[s.block], LateSignal)]
        flowing = [s for s in loops if s.block not in sampled]
        signals = [s for s in at_samples if s.target.kind is not ir.Kind.STATE]
        self._loops = _Mismatch(kept, inputs, always, flowing) if flowing else None
        self._whole = _Mismatch(kept, inputs, signals, loops) if loops else None
        places = {(slot.kind, slot.name): place for place, slot in enumerate(kept)}
        self._histories = [
            _History(block, places[s.target.kind, s.target.name])
            for s in late if isinstance(block := blocks[s.block], LateSignal)
        ]  # fmt: skip
        self._inputs = _function(kept, inputs, always, late)

    def __bool__(self) -> bool:
        return bool(self._whole) or bool(self._histories)

    @property
    def longest_step(self) -> float | None:
        """Of a solver (s), so that late signals are known in time; None without any."""
        delays = [history.block.delay for history in self._histories]
        return min(delays) / 2 if delays else None

    def put(self, memory: Memory, given: Sequence[float], *, at_sample: bool = False) -> None:
        """Their values at an instant, the last of the values `given`, into the memory."""
        for history in self._histories:
            memory[history.place] = history.at(given[-1])
        loops = self._whole if at_sample else self._loops
        if loops is not None:
            loops.close(memory, given)

    def note(self, memory: Memory, given: Sequence[float]) -> None:
        """Remember the inputs of late signals at an instant."""
        if self._histories:
            values = self._inputs(memory, given, None)
            for history, value in zip(self._histories, values, strict=True):
                history.note(given[-1], value)

    def shares(self) -> tuple[float, ...]:
        """Of a solver's step, where the inputs of late signals are to be noted."""
        return _SHARES if self._histories else ()

    def echoes(self, instants: Sequence[float], stop: float) -> list[float]:
        """When jumps at these instants come out of late signals, again and again."""
        found: set[int] = set()
        waiting = [0.0, *instants]
        while waiting and self._histories:
            begin = waiting.pop()
            for history in self._histories:
                later = begin + history.block.delay
                if later <= stop and round(later / TICK) not in found and history.block.delay > 0:
                    found.add(round(later / TICK))
                    waiting.append(later)
            if len(found) > _MOST_ECHOES:
                break
        return [tick * TICK for tick in sorted(found)]
