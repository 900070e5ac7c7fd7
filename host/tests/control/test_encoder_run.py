# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulation with encoder counts, limits and anti-windup."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ravenbrick.control import (
    RunMeasures,
    SampledLoop,
    encoder_run,
    measure_runs,
    pi_by_lambda,
    pi_diagram,
)
from ravenbrick.control.estimation.encoder_run import EncoderRun
from ravenbrick.control.estimation.speed_estimators import EdgeTimes
from ravenbrick.model import Encoder, Execution, IntegrationMethod, SpeedLoop

LOOP = SpeedLoop(2.029, 0.037, 116.0)
PI = pi_by_lambda(LOOP, 0.4).discretised(IntegrationMethod.FORWARD_EULER, 0.004)
CONTROLLER = pi_diagram(PI, 9.0, 0.037)


def measured(set_point: float, window: int | None) -> RunMeasures:
    """Mean over four phases of the encoder, 3 s each."""
    return measure_runs(
        [
            encoder_run(LOOP, CONTROLLER, set_point, 3.0, window, phase=phase / 4)
            for phase in range(4)
        ]
    )


# set-point, window, settling time, ripple, control peak to peak; None: not stated
KNOWN = [
    (1.0, 1, None, 0.0164, 0.78),
    (4.0, 1, 0.380, 0.0050, 0.78),
    (1.0, 4, 0.400, 0.0089, 0.21),
    (4.0, 4, 0.354, 0.0026, 0.23),
    (1.0, 8, 0.319, 0.0055, 0.11),
    (4.0, 8, 0.312, 0.0011, 0.11),
    (1.0, 16, 0.214, 0.0022, 0.06),
    (4.0, 16, 0.217, 0.0009, 0.06),
]


@pytest.mark.parametrize(("set_point", "window", "settling", "ripple", "control"), KNOWN)
def test_the_quantised_loop_does_what_was_computed_elsewhere(
    set_point: float, window: int, settling: float | None, ripple: float, control: float
) -> None:
    """Ripple within 5 %, control within 6.5 mV, settling within 12 ms (a moving mean's choice)."""
    found = measured(set_point, window)
    assert found.ripple == pytest.approx(ripple, rel=0.05)
    assert found.control_peak_to_peak == pytest.approx(control, abs=0.0065)
    if settling is not None:
        assert found.settling_time == pytest.approx(settling, abs=0.012)
    assert abs(found.bias) < 5e-4


def test_runs_are_measured_by_what_they_are() -> None:
    """By hand: a speed that is the set-point; one that never settles; one that rises in a line to
    1.1 at 0.5 s and stays: its mean over 0.02 s leaves the band for good at 1.02 and 0.46 s."""
    fine, coarse = np.linspace(0.0, 1.0, 4001)[:-1], np.linspace(0.0, 1.0, 251)[:-1]

    def measures(speed: np.ndarray) -> RunMeasures:
        flat = np.full(250, 2.0)
        return measure_runs([EncoderRun(2.0, coarse, flat, flat, flat, fine, 2.0 * speed)])

    still = measures(np.ones(4000))
    assert list(vars(still).values()) == pytest.approx([0.0] * 6, abs=1e-12)
    never = measures(np.minimum(2.2 * fine, 1.1))
    assert never.settling_time == pytest.approx(1.0 - 0.01, abs=3e-4)
    assert (never.overshoot, never.bias) == pytest.approx((0.1, 0.1))
    late = measures(np.where(fine < 0.3, 0.5 + fine / 0.3 * 0.55, 1.0))
    assert 0.28 < late.settling_time < 0.31


def test_the_plain_difference_shows_two_values_only() -> None:
    """At 4 V the measured speed is 2.155 or 4.310 V, never near the set-point."""
    run = encoder_run(LOOP, CONTROLLER, 4.0, 3.0, 1)
    steady = np.unique(np.round(run.measured[len(run.measured) // 2 :], 3))
    assert steady.tolist() == [2.155, 4.31]


def test_without_counts_the_simulation_is_the_linear_loop() -> None:
    """With an ideal speed sample it follows the linear response to single precision."""
    for delay in (0.0, 0.0015, 0.004, 0.0055):
        run = encoder_run(LOOP, CONTROLLER, 1.0, 0.6, None, delay=delay)
        linear = SampledLoop(LOOP, PI.controller(), None, delay).step_response(0.6)
        np.testing.assert_allclose(run.speed, linear.output, atol=2e-6)


def drive(supply_voltage: float, set_points: Sequence[float], tracking_time: float) -> np.ndarray:
    """Speeds (V) under a limited supply for a set-point per sample."""
    execution = Execution(pi_diagram(PI, supply_voltage, tracking_time))
    speed, speeds = 0.0, []
    decay = np.exp(-0.004 / LOOP.time_constant)
    for set_point in set_points:
        speeds.append(speed)
        output = execution.step({"Input_Voltage": set_point, "Real_Voltage": speed})
        assert abs(output["correctedvoltage"]) <= np.float32(supply_voltage)
        final = LOOP.loop_gain * float(output["correctedvoltage"])
        speed = final + (speed - final) * decay
    return np.array(speeds)


def test_anti_windup_frees_the_motor_as_soon_as_the_set_point_returns() -> None:
    """After 2 s of a set-point beyond the supply the speed follows a new one at once.

    With a tracking time of 1000 s, which is as good as none, it hangs on for seconds.
    """
    set_points = [9.0] * 500 + [2.0] * 500
    tracked = drive(5.0, set_points, 0.037)[500:]
    without = drive(5.0, set_points, 1000.0)[500:]
    settled = np.flatnonzero(np.abs(tracked / 2.0 - 1) > 0.02)[-1] * 0.004
    assert settled < 0.6
    assert without[100] > 1.5 * 2.0
    assert tracked[100] < 1.1 * 2.0


def test_a_coarse_motor_voltage_moves_in_its_steps() -> None:
    """With one percent of 8 V as resolution every control input is a multiple of 0.08 V."""
    run = encoder_run(LOOP, CONTROLLER, 4.0, 1.0, 8, voltage_step=0.08)
    np.testing.assert_allclose(run.control / 0.08, np.round(run.control / 0.08), atol=1e-9)


def test_a_motor_that_turns_backwards_is_seen_as_one_that_turns_forwards() -> None:
    """By the instants of its edges, to a microsecond; with half a count of phase they mirror."""
    forwards, backwards = (
        encoder_run(
            LOOP, CONTROLLER, sign * 2.0, 1.0, None, phase=0.5,
            estimator=EdgeTimes(Encoder(phase=0.5), 1e-6),
        )
        for sign in (1, -1)
    )  # fmt: skip
    assert np.abs(forwards.speed[-100:] - 2.0).max() < 0.1
    assert backwards.count.tolist() == (-forwards.count).tolist()
    assert backwards.measured == pytest.approx(-forwards.measured, abs=2e-3)
