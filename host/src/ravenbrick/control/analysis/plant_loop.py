# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A sampled controller in a loop with any linear plant that has one input."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ravenbrick.control.analysis.flow import Array
from ravenbrick.control.analysis.metrics import Margins, StepMetrics, margins, step_metrics
from ravenbrick.control.analysis.sampled import StepResponse
from ravenbrick.errors import DesignError
from ravenbrick.model import LinearSystem
from ravenbrick.model.lazy import control

__all__ = ["PlantLoop"]


@dataclass(frozen=True, eq=False)
class PlantLoop:
    """A continuous `plant` with held inputs under a discrete `controller` with one output.

    `ports` has, for each input of the controller, the number of the plant's output that it
    measures, or None for the set-point; the first output of the plant follows the set-point.
    """

    plant: Any
    controller: LinearSystem
    ports: Sequence[int | None]

    def __post_init__(self) -> None:
        plant, own = LinearSystem.of(self.plant), self.controller
        if plant.isdtime() or plant.ninputs != 1 or np.any(plant.D):
            raise DesignError(
                "the plant of a loop is a continuous system with one input and no direct path"
            )
        if len(own.D) != 1 or list(self.ports).count(None) != 1:
            raise DesignError("the controller of a loop has one output, and one set-point")

    @property
    def sample_time(self) -> float:
        """Sample time of the controller in s."""
        return self.controller.dt

    @cached_property
    def _sampled(self) -> LinearSystem:
        continuous = LinearSystem.of(self.plant).for_control()
        return LinearSystem.of(control.sample_system(continuous, self.sample_time, "zoh"))

    @cached_property
    def _parts(self) -> tuple[Array, Array, Array, Array]:
        """What the controller makes of the measured outputs and of the set-point."""
        own = self.controller
        chosen = np.zeros((len(self.ports), len(self._sampled.C)))
        for port, output in enumerate(self.ports):
            if output is not None:
                chosen[port, output] = 1.0
        seen, wanted = chosen @ self._sampled.C, list(self.ports).index(None)
        return own.B @ seen, own.D @ seen, own.B[:, [wanted]], own.D[:, [wanted]]

    @cached_property
    def closed(self) -> LinearSystem:
        """From the set-point to the plant's first output, at the samples."""
        plant, own = self._sampled, self.controller
        entry, through, wanted, passed = self._parts
        matrix = np.block([[plant.A + plant.B @ through, plant.B @ own.C], [entry, own.A]])
        output = np.hstack([plant.C[:1], np.zeros((1, own.nstates))])
        return LinearSystem(
            matrix, np.vstack([plant.B @ passed, wanted]), output, np.zeros((1, 1)), own.dt
        )

    def open_loop(self) -> control.StateSpace:
        """The loop cut at the plant's input, with the sign of a unit negative feedback."""
        plant, own = self._sampled, self.controller
        entry, through, wanted, _ = self._parts
        matrix = np.block([[plant.A, np.zeros((plant.nstates, own.nstates))], [entry, own.A]])
        cut = np.vstack([plant.B, 0 * wanted])
        return control.ss(matrix, cut, -np.hstack([through, own.C]), 0.0, own.dt)

    def poles(self) -> Array:
        """Closed-loop poles in z."""
        return np.asarray(np.linalg.eigvals(self.closed.A))

    def margins(self) -> Margins:
        """Gain and phase margin at the plant's input."""
        return margins(self.open_loop())

    def step_metrics(self) -> StepMetrics:
        """Of a unit step of the set-point, at the samples."""
        return step_metrics(self.closed)

    def step_response(self, duration: float, points_per_sample: int = 1) -> StepResponse:
        """The plant's first output after a unit step, at the samples over `duration` (s)."""
        times = np.arange(0.0, duration, self.sample_time)
        found = control.step_response(self.closed.for_control(), times)
        return StepResponse(times, np.ravel(found.outputs))
