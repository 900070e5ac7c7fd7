# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A sampled controller in a loop with any linear plant: several inputs, several rates."""

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

__all__ = ["PlantLoop", "Wiring"]


@dataclass(frozen=True)
class Wiring:
    """How a controller and a plant are joined, and what is looked at.

    `measured` has, for each input of the controller, the number of the plant's output that it
    reads, or None for a set-point; `driven` for each output of the controller the number of the
    plant's input, or None. `set_point` is the input that steps, `followed` the plant's output that
    is shown, `cut` the controller's output at which the open loop is cut; the others stay closed.
    """

    measured: Sequence[int | None]
    driven: Sequence[int | None]
    set_point: int
    followed: int = 0
    cut: int = 0


@dataclass(frozen=True, eq=False)
class PlantLoop:
    """A continuous `plant` with held inputs under a discrete controller.

    `steps` are the controller's systems in the steps of a period, one if it has one rate. Raises
    `DesignError` for a plant that is sampled or has a direct path.
    """

    plant: Any
    steps: Sequence[LinearSystem]
    wiring: Wiring

    def __post_init__(self) -> None:
        plant = LinearSystem.of(self.plant)
        if plant.isdtime() or np.any(plant.D):
            raise DesignError("the plant of a loop is a continuous system with no direct path")
        outputs, inputs = plant.D.shape
        wiring = self.wiring
        read = (*wiring.measured, wiring.followed)
        for what, places, count in (("outputs", read, outputs), ("inputs", wiring.driven, inputs)):
            for place in places:
                if place is not None and not 0 <= place < count:
                    raise DesignError(
                        f"the plant's {what} have the numbers 0 to {count - 1}, so none has {place}"
                    )

    @property
    def sample_time(self) -> float:
        """Time between two steps of the controller in s."""
        return self.steps[0].dt

    @cached_property
    def _sampled(self) -> LinearSystem:
        continuous = LinearSystem.of(self.plant).for_control()
        return LinearSystem.of(control.sample_system(continuous, self.sample_time, "zoh"))

    def _joined(self, own: LinearSystem, driven: Array) -> tuple[Array, Array, Array]:
        """Matrix and set-point column of a step, and the row of each of the controller's outputs.

        `driven` makes inputs of the plant from outputs of the controller. States are the plant's,
        then the controller's.
        """
        plant, ports = self._sampled, self.wiring.measured
        seen = np.zeros((len(ports), len(plant.C)))
        for port, output in enumerate(ports):
            if output is not None:
                seen[port, output] = 1.0
        measured, force = seen @ plant.C, plant.B @ driven
        rows = np.hstack([own.D @ measured, own.C])
        following = np.hstack([own.B @ measured, own.A])
        alone = np.hstack([plant.A, np.zeros((plant.nstates, own.nstates))])
        at = self.wiring.set_point
        column = np.vstack([force @ own.D[:, [at]], own.B[:, [at]]])
        return np.vstack([alone + force @ rows, following]), column, rows

    @cached_property
    def _driven(self) -> Array:
        matrix = np.zeros((self._sampled.ninputs, len(self.steps[0].D)))
        for output, place in enumerate(self.wiring.driven):
            if place is not None:
                matrix[place, output] = 1.0
        return matrix

    @cached_property
    def _output(self) -> Array:
        own = self._sampled.C[[self.wiring.followed]]
        return np.hstack([own, np.zeros((1, self.steps[0].nstates))])

    @cached_property
    def closed_at(self) -> tuple[LinearSystem, ...]:
        """From the set-point to the output that is shown, at each step of the period."""
        order = self._output.shape[1]
        power, column = np.eye(order), np.zeros((order, 1))
        outputs, period = [], self.sample_time * len(self.steps)
        for own in self.steps:
            outputs.append((self._output @ power, self._output @ column))
            matrix, entry, _ = self._joined(own, self._driven)
            power, column = matrix @ power, matrix @ column + entry
        return tuple(LinearSystem(power, column, c, d, period) for c, d in outputs)

    def open_loop(self) -> control.StateSpace:
        """The loop cut at one of the plant's inputs, with the sign of a unit negative feedback.

        Raises `DesignError` for several rates, whose answer to a sine is no single sine.
        """
        if len(self.steps) > 1:
            raise DesignError("a loop with several rates has no frequency response")
        kept, cut = self._driven.copy(), self.wiring.cut
        kept[:, cut] = 0.0
        matrix, _, rows = self._joined(self.steps[0], kept)
        states = self.steps[0].nstates
        entry = np.vstack([self._sampled.B @ self._driven[:, [cut]], np.zeros((states, 1))])
        return control.ss(matrix, entry, -rows[[cut]], 0.0, self.sample_time)

    def poles(self) -> Array:
        """Closed-loop poles in z, of one period."""
        return np.asarray(np.linalg.eigvals(self.closed_at[0].A))

    def margins(self) -> Margins:
        """Gain and phase margin at the plant's input; `DesignError` as for `open_loop`."""
        return margins(self.open_loop())

    def step_metrics(self) -> StepMetrics:
        """Of a unit step of the set-point when all rates run, at all samples."""
        each = [step_metrics(one) for one in self.closed_at]
        # The samples of a step of the period are `period` apart; those of the others lie between.
        early = [(len(each) - 1 - step) * self.sample_time for step in range(len(each))]
        settled = max(
            max(one.settling_time - before, 0.0) for one, before in zip(each, early, strict=True)
        )
        overshoot = max(one.overshoot for one in each)
        return StepMetrics(settled, overshoot, each[0].final_value, settled)

    def step_response(self, duration: float, points_per_sample: int = 1) -> StepResponse:
        """The output that is shown after a unit step, at the samples over `duration` (s)."""
        times = np.arange(0.0, duration, self.sample_time)
        systems = self.closed_at
        outputs, state = np.zeros(len(times)), np.zeros((len(systems[0].A), 1))
        for index in range(len(times)):
            own = systems[index % len(systems)]
            outputs[index] = (own.C @ state + own.D).item()
            if own is systems[-1]:
                state = own.A @ state + own.B
        return StepResponse(times, outputs)
