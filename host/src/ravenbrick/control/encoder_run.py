# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulation of the sampled loop as it will run: encoder counts, float32 controller, limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ravenbrick.control.flow import Array
from ravenbrick.control.metrics import SETTLING_BAND
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, Encoder, Execution, SpeedLoop, SpeedWindow

__all__ = ["EncoderRun", "RunMeasures", "encoder_run", "measure_runs"]


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
) -> EncoderRun:
    """Step of `set_point` (V) at time 0 from rest, for `duration` (s).

    `window` in samples (None: ideal speed sample), `delay` (s) from sampling to the motor's new
    voltage, `phase` of the encoder in counts. `supply_voltage` replaces the diagram's parameter
    Saturation; `voltage_step` (V) is the resolution of the motor voltage, such as one percent of
    duty cycle. The controller is executed in its own number format.
    """
    sample_time = controller.sample_time
    execution = Execution(controller)
    if supply_voltage is not None:
        execution.set_parameter("Saturation", supply_voltage)
    encoder = Encoder(phase=phase)
    estimator = SpeedWindow(encoder, window or 1, sample_time)
    motor = _Motor(loop)
    whole = math.floor(delay / sample_time + 1e-9)
    pending = [0.0] * (whole + 1)
    samples: list[tuple[float, float, int]] = []
    speeds: list[float] = []
    for _ in range(math.ceil(duration / sample_time - 1e-9)):
        count = encoder.count(motor.angle)
        estimate = estimator.sample(count)
        signal = (motor.speed if window is None else estimate) * loop.feedback_gain
        output = execution.step({"Input_Voltage": set_point, "Real_Voltage": signal})
        command = float(output["correctedvoltage"])
        if voltage_step is not None:
            command = round(command / voltage_step) * voltage_step
        samples.append((signal, command, count))
        pending.append(command)
        previous, present = pending.pop(0), pending[0]
        change = delay - whole * sample_time
        _one_sample(motor, (previous, present), change, sample_time, points_per_sample, speeds)
    columns = np.array(samples)
    fine = np.arange(len(speeds), dtype=np.float64) * sample_time / points_per_sample
    return EncoderRun(
        set_point=set_point,
        time=np.arange(len(samples), dtype=np.float64) * sample_time,
        measured=columns[:, 0],
        control=columns[:, 1],
        count=columns[:, 2],
        fine_time=fine,
        speed=np.array(speeds) * loop.feedback_gain,
    )


def _one_sample(
    motor: _Motor,
    voltages: tuple[float, float],
    change: float,
    sample_time: float,
    points: int,
    speeds: list[float],
) -> None:
    """Move the motor over one sample whose voltage changes at `change` (s); append true speeds."""
    previous, present = voltages
    cell = sample_time / points
    for index in range(points):
        speeds.append(motor.speed)
        before = min(max(change - index * cell, 0.0), cell)
        motor.advance(previous, before)
        motor.advance(present, cell - before)


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
