# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulation of the sampled loop as it will run: encoder counts, float32 controller, limits."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ravenbrick.control.analysis.flow import Array
from ravenbrick.control.analysis.metrics import SETTLING_BAND
from ravenbrick.control.estimation.speed_estimators import (
    Measurement,
    SpeedEstimator,
    WindowEstimator,
)
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, Encoder, Execution, SpeedLoop

__all__ = ["EncoderRun", "RunMeasures", "SampleTiming", "encoder_run", "measure_runs"]


@dataclass(frozen=True, eq=False)
class EncoderRun:
    """Arrays over the samples: `time` (s), `measured` and `control` (V), `count`;

    over the finer grid `fine_time` (s): `speed`, the true speed in V of the fed-back signal.
    `set_point` in V.
    """

    set_point: float
    time: Array
    measured: Array
    control: Array
    count: Array
    fine_time: Array
    speed: Array


@dataclass(frozen=True)
class RunMeasures:
    """Means over runs that differ in the encoder's phase.

    `settling_time` (s) and `overshoot` (share) of the true speed's moving mean; `ripple` the root
    mean square deviation of the true speed as a share of the set-point, `control_peak_to_peak` and
    `measured_peak_to_peak` (V) in steady state, `bias` the mean error as a share of the set-point.
    """

    settling_time: float
    overshoot: float
    ripple: float
    control_peak_to_peak: float
    measured_peak_to_peak: float
    bias: float


@dataclass
class _Motor:
    """Exact motion of the first-order motor under constant voltage; rad/s and rad."""

    loop: SpeedLoop
    speed: float = 0.0
    angle: float = 0.0

    def advance(self, voltage: float, duration: float) -> None:
        final = self.loop.gain * voltage
        decay = math.exp(-duration / self.loop.time_constant)
        share = self.loop.time_constant * (1 - decay)
        self.angle += final * duration + (self.speed - final) * share
        self.speed = final + (self.speed - final) * decay


@dataclass(frozen=True, eq=False)
class SampleTiming:
    """When things happen, sample by sample: `release` (s) after the period's begin, `delay` (s)

    from there to the motor's new voltage. Shorter sequences than the run are repeated.
    """

    release: Array
    delay: Array

    def __post_init__(self) -> None:
        if not len(self.release) or len(self.release) != len(self.delay):
            raise DesignError("release and delay need the same number of samples, at least one")
        if min(self.release.min(), self.delay.min()) < 0:
            raise DesignError("release and delay must not be negative")

    @classmethod
    def constant(cls, delay: float) -> SampleTiming:
        """No jitter."""
        return cls(np.zeros(1), np.full(1, delay))

    def of_sample(self, index: int) -> tuple[float, float]:
        """Release and delay of a sample."""
        place = index % len(self.release)
        return float(self.release[place]), float(self.delay[place])


class _Bench:
    """The motor in time, with voltages that arrive at their instants."""

    def __init__(self, loop: SpeedLoop, encoder: Encoder) -> None:
        self._motor = _Motor(loop)
        self._encoder = encoder
        self._now = 0.0
        self._voltage = 0.0
        self._arriving: deque[tuple[float, float]] = deque()
        self._count = encoder.count(0.0)
        self._last_edge = 0.0

    def send(self, instant: float, voltage: float) -> None:
        """A voltage that the motor gets at `instant`; an earlier one still under way is late."""
        if self._arriving:
            instant = max(instant, self._arriving[-1][0])
        self._arriving.append((instant, voltage))

    def advance_to(self, instant: float) -> None:
        """Move on; edges are timed exactly."""
        while self._arriving and self._arriving[0][0] <= instant:
            at, voltage = self._arriving.popleft()
            self._move(at)
            self._voltage = voltage
        self._move(instant)

    def _move(self, instant: float) -> None:
        duration = instant - self._now
        if duration <= 0:
            return
        before = _Motor(self._motor.loop, self._motor.speed, self._motor.angle)
        self._motor.advance(self._voltage, duration)
        count = self._encoder.count(self._motor.angle)
        if count != self._count:
            newest = count if count > self._count else count + 1
            self._last_edge = self._now + self._crossing(before, newest, duration)
            self._count = count
        self._now = instant

    def _crossing(self, start: _Motor, count: int, duration: float) -> float:
        """When the angle passes the edge to `count`, by bisection to a nanosecond."""
        edge = self._encoder.angle(1) * (count - self._encoder.phase)
        early, late = 0.0, duration
        rising = self._motor.angle > start.angle
        while late - early > 1e-9:
            middle = (early + late) / 2
            moved = _Motor(start.loop, start.speed, start.angle)
            moved.advance(self._voltage, middle)
            if (moved.angle >= edge) == rising:
                late = middle
            else:
                early = middle
        return late

    def measurement(self) -> Measurement:
        """What a sample sees now."""
        return Measurement(self._now, self._count, self._last_edge, self._motor.speed)


def encoder_run(
    loop: SpeedLoop,
    controller: Diagram,
    set_point: float,
    duration: float,
    window: int | None,
    *,
    delay: float = 0.0,
    phase: float = 0.0,
    supply_voltage: float | None = None,
    voltage_step: float | None = None,
    points_per_sample: int = 4,
    estimator: SpeedEstimator | None = None,
    timing: SampleTiming | None = None,
) -> EncoderRun:
    """Step of `set_point` (V) at time 0 from rest, for `duration` (s).

    `window` in samples (None: ideal speed sample), `delay` (s) from sampling to the motor's new
    voltage, `phase` of the encoder in counts. `supply_voltage` replaces the diagram's parameter
    Saturation; `voltage_step` (V) is the resolution of the motor voltage, such as one percent of
    duty cycle. `estimator` replaces the window; `timing` replaces the constant delay by instants,
    such as those of a recorded run. The controller is executed in its own number format.
    """
    sample_time = controller.sample_time
    execution = Execution(controller)
    if supply_voltage is not None:
        execution.set_parameter("Saturation", supply_voltage)
    bench = _Bench(loop, Encoder(phase=phase))
    if estimator is None and window is not None:
        estimator = WindowEstimator(Encoder(phase=phase), window, sample_time)
    timing = timing or SampleTiming.constant(delay)
    grid = np.arange(math.ceil(duration / sample_time - 1e-9) * points_per_sample)
    fine = grid * sample_time / points_per_sample
    speeds: list[float] = []
    samples: list[tuple[float, float, int]] = []
    command = 0.0
    for index in range(len(fine) // points_per_sample):
        release, until = timing.of_sample(index)
        instant = index * sample_time + release
        _record(bench, fine, speeds, instant)
        seen = bench.measurement()
        speed = seen.true_speed if estimator is None else estimator.estimate(seen, command)
        signal = speed * loop.feedback_gain
        output = execution.step({"Input_Voltage": set_point, "Real_Voltage": signal})
        command = float(output["correctedvoltage"])
        if voltage_step is not None:
            command = round(command / voltage_step) * voltage_step
        samples.append((signal, command, seen.count))
        bench.send(instant + until, command)
    _record(bench, fine, speeds, math.inf)
    columns = np.array(samples)
    return EncoderRun(
        set_point=set_point,
        time=np.arange(len(samples), dtype=np.float64) * sample_time,
        measured=columns[:, 0],
        control=columns[:, 1],
        count=columns[:, 2],
        fine_time=fine,
        speed=np.array(speeds) * loop.feedback_gain,
    )


def _record(bench: _Bench, fine: Array, speeds: list[float], instant: float) -> None:
    """True speeds at the points of the fine grid up to the instant; then go there."""
    while len(speeds) < len(fine) and fine[len(speeds)] <= instant:
        bench.advance_to(float(fine[len(speeds)]))
        speeds.append(bench.measurement().true_speed)
    if math.isfinite(instant):
        bench.advance_to(instant)


def measure_runs(runs: Sequence[EncoderRun], mean_over: float = 0.02) -> RunMeasures:
    """Measures of runs with the same set-point; `mean_over` (s) is the length of the moving mean.

    The second half of each run counts as steady state.
    """
    if not runs:
        raise DesignError("there is no run to measure")
    rows = np.array([_measure(run, mean_over) for run in runs])
    return RunMeasures(*(float(value) for value in rows.mean(axis=0)))


def _measure(run: EncoderRun, mean_over: float) -> tuple[float, ...]:
    relative = run.speed / run.set_point
    step = float(run.fine_time[1])
    width = max(round(mean_over / step), 1)
    smooth = np.convolve(relative, np.ones(width) / width, mode="valid")
    centre = run.fine_time[: len(smooth)] + (width - 1) * step / 2
    outside = np.flatnonzero(np.abs(smooth - 1) > SETTLING_BAND)
    settled = float(centre[min(outside[-1] + 1, len(centre) - 1)]) if len(outside) else 0.0
    steady = relative[len(relative) // 2 :]
    half = len(run.control) // 2
    return (
        settled,
        max(float(smooth.max()) - 1.0, 0.0),
        float(steady.std()),
        float(np.ptp(run.control[half:])),
        float(np.ptp(run.measured[half:])),
        float(steady.mean() - 1.0),
    )
