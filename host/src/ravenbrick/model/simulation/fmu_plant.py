# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A model of another tool as the plant of a simulation: it steps from sample to sample."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model.blocks.time_functions import TICK
from ravenbrick.model.simulation.recording import Recording, Signal

if TYPE_CHECKING:
    from ravenbrick.fmu import FmuUnit

__all__ = ["FmuPlant", "FmuPlantRun"]

_ALMOST = 1e-6  # of a step


@dataclass(frozen=True)
class FmuPlant:
    """A co-simulation unit of FMI 2 or 3, with its real inputs and outputs as ports.

    `inputs` and `outputs` choose some of its variables, `values` are set before the initialisation.
    Steps are at most `step` long (s), without it what the unit proposes; its inputs are held within
    each, and its outputs are those after the latest. Each run begins with a new instance.
    """

    path: Path | str
    inputs: Sequence[str] = ()
    outputs: Sequence[str] = ()
    values: Mapping[str, float] = field(default_factory=dict)
    step: float | None = None
    name: str = "plant"

    def __post_init__(self) -> None:
        if self.step is not None and not self.step > 0:
            raise DesignError(f"plant '{self.name}': the step must be > 0 s, not {self.step}")


class FmuPlantRun:
    """One run of it, with what was recorded."""

    period = None
    """Nothing of it is sampled by the simulation."""

    def __init__(self, plant: FmuPlant) -> None:
        from ravenbrick import fmu  # a notebook in a browser has none

        self._plant, self._begin = plant, fmu.FmuUnit
        self._file = fmu.FmuFile(Path(plant.path))
        self.inputs = tuple(plant.inputs or self._file.inputs)
        self.outputs = tuple(plant.outputs or self._file.outputs)
        self._step = plant.step or self._file.step
        self._given: dict[str, float | Callable[[float], float]] = dict.fromkeys(self.inputs, 0.0)
        self._unit: FmuUnit | None = None
        self._found: list[float] = []
        self._times: list[float] = []
        self._rows: list[list[float]] = []

    def instants(self, stop: float, hits: Sequence[float]) -> list[float]:
        """Begin; samples in order, each once."""
        self._unit = self._begin(self._file, self.inputs, self.outputs, self._plant.values)
        self._found = self._unit.outputs()
        ticks = {round(hit / TICK): hit for hit in hits}
        return [ticks[tick] for tick in sorted(ticks)]

    def give(self, name: str, value: float | Callable[[float], float]) -> None:
        """A new value at an input, or a function of the time in s."""
        self._given[name] = value

    def sample(self, time: float) -> None:
        """Nothing is sampled."""

    def values(self, time: float) -> dict[str, float]:
        """The outputs after the latest step."""
        return dict(zip(self.outputs, self._found, strict=True))

    def record(self, time: float) -> None:
        """Note inputs and outputs."""
        self._times.append(time)
        self._rows.append([*self._at(time), *self._found])

    def advance(self, begin: float, end: float) -> None:
        """Step until `end`, and note each step."""
        if self._unit is None or end <= begin:
            return
        steps = (end - begin) / self._step
        count = max(math.ceil(steps - _ALMOST), 1)
        if not self._file.any_step and abs(steps - count) > _ALMOST * count:
            raise DesignError(
                f"{self._plant.path}: makes steps of one length only, and {self._step:g} s do not "
                f"divide the time from {begin:g} to {end:g} s; give a `step` that divides the "
                "sample times and the latency"
            )
        points = np.linspace(begin, end, count + 1).tolist()
        for before, after in pairwise(points):
            self._found = self._unit.step(before, after - before, self._at(before))
            self.record(after)

    def _at(self, time: float) -> list[float]:
        return [given(time) if callable(given) else given for given in self._given.values()]

    def recording(self) -> Recording:
        """All inputs and outputs; events inside of the unit are not seen."""
        times, table = np.array(self._times), np.array(self._rows)
        signals = {}
        for place, name in enumerate((*self.inputs, *self.outputs)):
            path, held = f"{self._plant.name}/{name}", place < len(self.inputs)
            signals[path] = Signal(path, times, table[:, place], self._file.unit(name), held)
        return Recording(signals)

    def close(self) -> None:
        """End the unit."""
        if self._unit is not None:
            self._unit.close()
