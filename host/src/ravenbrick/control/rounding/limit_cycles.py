# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Oscillations that rounding keeps alive: looked for from many starts with constant inputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ravenbrick.control.rounding.rounding_error import PlantInLoop
from ravenbrick.errors import DesignError
from ravenbrick.model import Execution
from ravenbrick.model.fixed_point import FixedPoint
from ravenbrick.model.number_format import FixedFormat
from ravenbrick.model.program import Slot

__all__ = ["LimitCycle", "LimitCycleSearch", "search_limit_cycles"]

STARTS = 12
STEPS = 1500
_LONGEST = 64

Row = tuple[int, ...]


@dataclass(frozen=True)
class LimitCycle:
    """Outputs that repeat after `period` samples; a period of 0: they do not repeat.

    `inputs` are the raw constants, `peak_to_peak` (LSB) that of the outport named `output`.
    """

    inputs: Mapping[str, int]
    period: int
    output: str
    peak_to_peak: int


@dataclass(frozen=True)
class LimitCycleSearch:
    """`runs` from random states with constant inputs, `steps` each; `cycles` of those not at rest.

    With a plant the loop is closed. A search is not a proof that there are no others.
    """

    runs: int
    steps: int
    closed_loop: bool
    cycles: tuple[LimitCycle, ...]

    @property
    def largest_lsb(self) -> int:
        """The largest oscillation of an outport, peak to peak in LSB."""
        return max((cycle.peak_to_peak for cycle in self.cycles), default=0)

    def sentence(self) -> str:
        """What was found, for reading."""
        where = "in the loop with the plant" if self.closed_loop else "without a plant"
        head = f"{self.runs} runs of {self.steps} steps {where}, constant inputs, random states: "
        if not self.cycles:
            return f"{head}all come to rest."
        periods = sorted({cycle.period for cycle in self.cycles})
        names = ", ".join("none" if p == 0 else str(p) for p in periods)
        return (
            f"{head}{len(self.cycles)} oscillate, at most {self.largest_lsb} LSB peak to peak "
            f"(periods in samples: {names})."
        )


def search_limit_cycles(
    fixed: FixedPoint,
    plant: PlantInLoop | None = None,
    *,
    starts: int = STARTS,
    steps: int = STEPS,
    seed: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> LimitCycleSearch:
    """Runs with inputs at zero, at small and at random constants, from random states.

    Without a plant all inports are constant: right for filters. With one, the measured inports
    come from it, which is right for controllers.
    """
    if starts < 1 or steps < 4 * _LONGEST:
        raise DesignError(f"a search needs a start and at least {4 * _LONGEST} steps")
    random = np.random.default_rng(seed)
    cycles = []
    for number in range(starts):
        run = _Run(fixed, plant, random, number)
        cycle = run.look(steps)
        if cycle is not None:
            cycles.append(cycle)
        if progress is not None:
            progress(number + 1, starts)
    return LimitCycleSearch(starts, steps, plant is not None, tuple(cycles))


class _Run:
    def __init__(
        self,
        fixed: FixedPoint,
        plant: PlantInLoop | None,
        random: np.random.Generator,
        number: int,
    ) -> None:
        self._fixed, self._plant = fixed, plant
        self._execution = Execution(fixed.program)
        measured = plant.measured if plant else ()
        self._constants = {
            slot.name: self._constant(slot, random, number)
            for slot in fixed.program.inputs
            if slot.name not in measured
        }
        self._scatter(random)
        order = plant.system.nstates if plant else 0
        self._state = random.uniform(-1.0, 1.0, order)

    def _constant(self, slot: Slot, random: np.random.Generator, number: int) -> int:
        """Zero, then a few LSB, then anything within the declared range."""
        if number == 0:
            return 0
        assert isinstance(slot.data_type, FixedFormat)
        found = self._fixed.ranges[slot.kind, slot.name]
        low, high = (0.5 * limit for limit in (found.low, found.high))
        if number % 2:
            return int(random.integers(-8, 9))
        return slot.data_type.raw(float(random.uniform(low, high)))

    def _scatter(self, random: np.random.Generator) -> None:
        for slot in self._fixed.program.states:
            found = self._fixed.raw_ranges[slot.kind, slot.name]
            value = int(random.integers(int(found.low), int(found.high), endpoint=True))
            self._execution.set_state(slot.name, value)

    def look(self, steps: int) -> LimitCycle | None:
        """The oscillation that is left at the end of the run, if any."""
        tail = [self._step() for _ in range(steps)][-4 * _LONGEST :]
        if len(set(tail)) == 1:
            return None
        spread = [max(column) - min(column) for column in zip(*tail, strict=True)]
        worst = int(np.argmax(spread))
        output = self._fixed.program.outputs[worst]
        return LimitCycle(self._constants, _period(tail), output.name, spread[worst])

    def _step(self) -> Row:
        given = dict(self._constants)
        if self._plant is not None:
            given |= self._measure(self._plant)
        found = self._execution.step(given)
        outputs = self._fixed.program.outputs
        if self._plant is not None:
            system = self._plant.system
            drive = [_real(slot, int(found[slot.name])) for slot in outputs]
            self._state = system.A @ self._state + system.B @ np.array(drive)
        return tuple(int(found[slot.name]) for slot in outputs)

    def _measure(self, plant: PlantInLoop) -> dict[str, int]:
        seen = plant.system.C @ self._state
        slots = {slot.name: slot for slot in self._fixed.program.inputs}
        measured = {}
        for name, value in zip(plant.measured, seen, strict=True):
            form = slots[name].data_type
            assert isinstance(form, FixedFormat)
            low, high = form.limits
            measured[name] = min(max(round(float(value) * 2**form.fraction), low), high)
        return measured


def _real(slot: Slot, raw: int) -> float:
    assert isinstance(slot.data_type, FixedFormat)
    return slot.data_type.real(raw)


def _period(rows: Sequence[Row]) -> int:
    """The shortest period of the rows, 0 if there is none up to a quarter of them."""
    for period in range(1, _LONGEST + 1):
        if all(rows[k] == rows[k - period] for k in range(period, len(rows))):
            return period
    return 0
