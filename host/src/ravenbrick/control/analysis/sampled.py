# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The sampled loop as a linear system: continuous plant, discrete controller, estimator, delay."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ravenbrick.control.analysis.flow import (
    Array,
    FlowMatrix,
    Segment,
    largest_value,
    settling_time,
)
from ravenbrick.control.analysis.metrics import SETTLING_BAND, Margins, StepMetrics, margins
from ravenbrick.errors import DesignError
from ravenbrick.model import LinearSystem, SpeedLoop
from ravenbrick.model.lazy import control

__all__ = ["SampledLoop", "StepResponse"]

_REMAINDER = 1e-9
_MOST_SAMPLES = 20_000


@dataclass(frozen=True, eq=False)
class StepResponse:
    """Arrays of equal length: `time` in s, `output` (fed-back volts per volt of set-point)."""

    time: Array
    output: Array


@dataclass(frozen=True, eq=False)
class SampledLoop:
    """Speed loop with a discrete controller.

    `controller` is a system from (set-point, fed-back signal), both V, to control input (V), or
    from their difference. `window` is the number of samples that the speed estimate spans; None is
    an ideal speed sample. `delay` (s) lies between sampling and the motor's new voltage. Encoder
    quantisation is left out: see `encoder_run`.
    """

    loop: SpeedLoop
    controller: control.lti.LTI | LinearSystem
    window: int | None = None
    delay: float = 0.0

    @property
    def sample_time(self) -> float:
        """Sample time of the controller in s."""
        return float(self.controller.dt)

    @cached_property
    def _controller(self) -> LinearSystem:
        system = LinearSystem.of(self.controller)
        if system.ninputs == 2:
            return system
        gain = np.array([[1.0, -1.0]])
        return LinearSystem(system.A, system.B @ gain, system.C, system.D @ gain, system.dt)

    @cached_property
    def _delay(self) -> tuple[int, float]:
        """Whole samples and the rest in s."""
        whole = math.floor(self.delay / self.sample_time + 1e-9)
        return whole, max(self.delay - whole * self.sample_time, 0.0)

    @cached_property
    def _flow_matrix(self) -> Array:
        """Flow of (fed-back speed, its integral, control input, set-point)."""
        tau, gain = self.loop.time_constant, self.loop.loop_gain
        flow = np.zeros((4, 4))
        flow[0, 0], flow[0, 2], flow[1, 0] = -1 / tau, gain / tau, 1.0
        return flow

    @cached_property
    def _flows(self) -> tuple[FlowMatrix, ...]:
        """The parts of a sample: before and after the control input changes."""
        rest = self._delay[1]
        parts = [rest, self.sample_time - rest] if rest > 1e-12 else [self.sample_time]
        return tuple(FlowMatrix(self._flow_matrix, part) for part in parts)

    @property
    def _sizes(self) -> tuple[int, int, int]:
        """Numbers of controller states, of stored integrals and of stored control inputs."""
        whole, rest = self._delay
        return self._controller.nstates, self.window or 0, whole + (1 if rest > 1e-12 else 0)

    def _parts(self, state: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Plant (2), controller, stored integrals, stored inputs, set-point (1)."""
        orders = np.cumsum([2, *self._sizes])
        return tuple(np.split(state, orders))  # type: ignore[return-value]

    def _advance(self, state: Array) -> tuple[Array, list[Array]]:
        """One sample on state vectors (columns): the next state and each part's flow state."""
        plant, controller, angles, inputs, set_point = self._parts(state)
        if self.window is None:
            measured = plant[0]
        else:
            measured = (plant[1] - angles[-1]) / (self.window * self.sample_time)
        signals = np.stack([set_point[0], measured])
        system = self._controller
        command = (system.C @ controller + system.D @ signals)[0]
        following = system.A @ controller + system.B @ signals
        queue = np.concatenate([command[np.newaxis], inputs])
        active = [queue[-1], queue[-2]] if len(self._flows) == 2 else [queue[-1]]
        starts, moving = [], plant
        for flow, value in zip(self._flows, active, strict=True):
            start = np.concatenate([moving, value[np.newaxis], set_point])
            starts.append(start)
            moving = (flow.transition @ start)[:2]
        if self.window is not None:
            angles = np.concatenate([plant[1:2], angles[:-1]])
        kept = queue[: len(inputs)]
        return np.concatenate([moving, following, angles, kept, set_point]), starts

    @cached_property
    def _maps(self) -> tuple[Array, list[Array]]:
        """Matrices from the state at a sample to the next and to each part's flow state."""
        return self._advance(np.eye(3 + sum(self._sizes)))

    @property
    def transition(self) -> Array:
        """State transition over one sample; the last state is the set-point."""
        return self._maps[0]

    def poles(self) -> Array:
        """Closed-loop poles in z without the integral of the speed and the set-point."""
        matrix = self.transition[:-1, :-1]
        if self.window is None:
            matrix = np.delete(np.delete(matrix, 1, 0), 1, 1)
            return np.asarray(np.linalg.eigvals(matrix))
        values = np.linalg.eigvals(matrix)
        return np.asarray(np.delete(values, np.abs(values - 1.0).argmin()))

    def _sample_count(self) -> int:
        radius = float(np.abs(self.poles()).max())
        if radius >= 1.0:
            raise DesignError(
                f"the sampled loop is not stable: a pole at distance {radius:.4f} from 0; "
                "lower the gains, the window or the delay"
            )
        count = math.ceil(math.log(_REMAINDER) / math.log(radius)) + sum(self._sizes)
        if count > _MOST_SAMPLES:
            raise DesignError(
                f"the sampled loop needs {count} samples to settle (a pole at distance "
                f"{radius:.6f} from 0); change the gains, the window or the delay"
            )
        return count

    def _segments(self, count: int) -> list[Segment]:
        """The error (fed-back speed minus set-point) after a unit step at time 0."""
        row = np.array([1.0, 0.0, 0.0, -1.0])
        state = np.zeros(3 + sum(self._sizes))
        state[-1] = 1.0
        transition, starts = self._maps
        segments = []
        for index in range(count):
            time = index * self.sample_time
            for flow, start in zip(self._flows, starts, strict=True):
                segments.append(Segment(flow, time, start @ state, row))
                time += flow.duration
            state = transition @ state
        return segments

    def settling_time(self, band: float = SETTLING_BAND) -> float:
        """Exact settling time (s) of the true speed between the samples."""
        return settling_time(self._segments(self._sample_count()), band)

    def step_metrics(self, band: float = SETTLING_BAND) -> StepMetrics:
        """Exact metrics of the true speed between the samples and at the samples."""
        segments = self._segments(self._sample_count())
        at_samples = [abs(float(s.row @ s.state)) for s in segments[:: len(self._flows)]]
        outside = [index for index, error in enumerate(at_samples) if error > band + _REMAINDER]
        first_inside = (outside[-1] + 1 if outside else 0) * self.sample_time
        excess = largest_value(segments)
        return StepMetrics(
            settling_time=settling_time(segments, band),
            overshoot=excess if excess > _REMAINDER * 10 else 0.0,
            final_value=1.0 + float(segments[-1].row @ segments[-1].state),
            settling_time_at_samples=first_inside,
        )

    def step_response(self, duration: float, points_per_sample: int = 4) -> StepResponse:
        """True speed after a unit step of the set-point, on an even grid over `duration` (s)."""
        count = math.ceil(duration / self.sample_time)
        offsets = np.arange(points_per_sample) * self.sample_time / points_per_sample
        segments = self._segments(count)
        width = len(self._flows)
        times, outputs = [], []
        for index in range(count):
            own = segments[index * width : (index + 1) * width]
            for offset in offsets:
                part = own[-1] if offset >= own[0].flow.duration else own[0]
                elapsed = index * self.sample_time + offset - part.start
                times.append(index * self.sample_time + offset)
                outputs.append(1.0 + part.value(max(elapsed, 0.0)))
        return StepResponse(np.array(times), np.array(outputs))

    def open_loop(self) -> control.StateSpace:
        """The loop cut at the error: discrete system from error to fed-back signal."""
        return self.open_loop_system().for_control()

    def open_loop_system(self) -> LinearSystem:
        """The matrices of `open_loop`."""
        length = self.window or 0
        plant = SampledLoop(self.loop, self._unit(), self.window, self.delay)
        matrix = plant.transition
        keep = [i for i in range(len(matrix) - 1) if self.window is not None or i != 1]
        output = np.zeros((1, len(matrix)))
        if self.window is None:
            output[0, 0] = 1.0
        else:
            output[0, 1] = 1.0 / (self.window * self.sample_time)
            output[0, 1 + length] = -output[0, 1]
        entry, through = matrix[keep, -1:], np.zeros((1, 1))
        motor = LinearSystem(
            matrix[np.ix_(keep, keep)], entry, output[:, keep], through, self.sample_time
        )
        own = self._controller
        error = LinearSystem(own.A, own.B[:, :1], own.C, own.D[:, :1], own.dt)
        return motor * error

    def _unit(self) -> LinearSystem:
        """A controller that passes the set-point on and ignores the fed-back signal."""
        passed = np.array([[1.0, 0.0]])
        return LinearSystem(
            np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((1, 0)), passed, self.sample_time
        )

    def margins(self) -> Margins:
        """Gain and phase margin with estimator and delay in the loop."""
        return margins(self.open_loop_system())
