# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The menu of speed estimators, and the loop with delays that are not constant."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import linalg

from ravenbrick.control import pi_by_lambda, pi_diagram
from ravenbrick.control.estimation.encoder_run import SampleTiming, encoder_run
from ravenbrick.control.estimation.estimator_menu import (
    compare_speed_estimators,
    plot_speed_estimators,
    standard_menu,
)
from ravenbrick.control.estimation.speed_estimators import (
    EdgeTimes,
    FilteredDifference,
    Measurement,
    MotorObserver,
    SpeedEstimator,
    TrackingLoop,
    WindowEstimator,
)
from ravenbrick.errors import DesignError
from ravenbrick.model import Encoder, IntegrationMethod, SpeedLoop

LOOP = SpeedLoop(2.029, 0.037, 116.0)
SAMPLE_TIME = 0.004
PI = pi_by_lambda(LOOP, 0.4).discretised(IntegrationMethod.FORWARD_EULER, SAMPLE_TIME)
ENCODER = Encoder()


def steady(estimator: SpeedEstimator, speed: float, samples: int = 600) -> np.ndarray:
    """Estimates of the last half while the shaft turns evenly at `speed` (rad/s)."""
    estimates = []
    for index in range(samples):
        instant = index * SAMPLE_TIME
        count = ENCODER.count(speed * instant)
        edge = ENCODER.angle(count) / speed
        seen = Measurement(instant, count, edge, speed)
        estimates.append(estimator.estimate(seen, speed / LOOP.gain))
    return np.array(estimates[samples // 2 :])


@pytest.mark.parametrize(
    ("estimator", "scatter"),
    [
        (WindowEstimator(ENCODER, 1, SAMPLE_TIME), 4.4),
        (WindowEstimator(ENCODER, 16, SAMPLE_TIME), 0.28),
        (FilteredDifference(ENCODER, 5.0, SAMPLE_TIME), 0.6),
        (EdgeTimes(ENCODER, 1e-6), 0.01),
        (TrackingLoop(ENCODER, 5.0, SAMPLE_TIME), 0.2),
        (MotorObserver(ENCODER, LOOP, SAMPLE_TIME), 0.05),
    ],
)
def test_each_estimator_finds_an_even_speed(estimator: SpeedEstimator, scatter: float) -> None:
    """Without bias; the peak-to-peak scatter is what the method promises."""
    estimates = steady(estimator, 7.3)
    assert estimates.mean() == pytest.approx(7.3, rel=0.005)
    assert np.ptp(estimates) <= scatter


def test_the_tracking_loop_is_critically_damped() -> None:
    """A shaft that begins to turn at v: its speed comes as v (1 - (1 + w t) exp(-w t))."""
    speed, frequency = 100.0, math.tau * 5.0
    loop = TrackingLoop(ENCODER, 5.0, 1e-4)
    time = 1e-4 * np.arange(1, 3000)
    counts = [ENCODER.count(speed * instant) for instant in time]
    found = [
        loop.estimate(Measurement(t, n, 0.0, 0.0), 0.0) for t, n in zip(time, counts, strict=True)
    ]
    expected = speed * (1 - (1 + frequency * time) * np.exp(-frequency * time))
    assert np.abs(found - expected).max() < 0.01 * speed


def test_the_observer_is_the_steady_kalman_filter_of_its_noise() -> None:
    """The first count moves the speed by the filter's gain, P C' / (C P C' + R), times the angle at
    its middle; P by SciPy from Riccati's equation, for the noises as stated."""
    rate, gain, count = 1 / LOOP.time_constant, LOOP.gain / LOOP.time_constant, math.radians(1)
    continuous = np.array([[0.0, 1.0, 0.0], [0.0, -rate, gain], [0.0, 0.0, 0.0]])
    matrix, row = linalg.expm(continuous * SAMPLE_TIME), np.array([[1.0, 0.0, 0.0]])
    process, rounding = np.diag([0.0, 0.3**2, 0.02**2]), count**2 / 12
    spread = linalg.solve_discrete_are(matrix.T, row.T, process, [[rounding]])
    expected = spread[1, 0] / (spread[0, 0] + rounding) * 1.5 * count
    observer = MotorObserver(ENCODER, LOOP, SAMPLE_TIME, disturbance=0.02, speed_noise=0.3)
    assert observer.estimate(Measurement(0.0, 1, 0.0, 0.0), 0.0) == pytest.approx(expected)


def test_coarse_time_stamps_read_in_steps() -> None:
    """One millisecond on some 2.4 ms between edges."""
    assert np.ptp(steady(EdgeTimes(ENCODER, 1e-3), 7.3)) > 1.0


def test_without_edges_the_speed_falls_to_what_is_possible() -> None:
    """A shaft that stops: at most one count in the time since the last edge."""
    estimator = EdgeTimes(ENCODER, 1e-6)
    for index in range(10):
        estimator.estimate(Measurement(0.01 * index, index, 0.01 * index, 1.0), 0.0)
    last = estimator.estimate(Measurement(1.09, 9, 0.09, 0.0), 0.0)
    assert last == pytest.approx(math.radians(1), rel=1e-6)


def test_the_observer_keeps_the_designed_loop_and_a_quiet_actuator() -> None:
    """Settling as with the ideal speed; the plain difference moves the voltage 40 times more."""
    names = ("ideal speed", "difference", "observer with motor model")
    menu = {name: standard_menu(LOOP, SAMPLE_TIME)[name] for name in names}
    rows = compare_speed_estimators(LOOP, PI, 9.0, [4.0], menu, duration=1.0)
    ideal, plain, observed = (row.measures for row in rows)
    assert observed.settling_time == pytest.approx(ideal.settling_time, abs=0.01)
    assert plain.control_peak_to_peak == pytest.approx(0.78, abs=0.01)
    assert plain.control_peak_to_peak > 40 * observed.control_peak_to_peak


def test_the_picture_names_axes_and_units(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """An SVG with both axes."""
    menu = {"difference": standard_menu(LOOP, SAMPLE_TIME)["difference"]}
    rows = compare_speed_estimators(LOOP, PI, 9.0, [4.0], menu, duration=0.1)
    plot_speed_estimators(rows, tmp_path / "menu.svg")
    text = (tmp_path / "menu.svg").read_text()
    assert text.startswith("<?xml")
    for label in ("true speed / set-point", "motor voltage (V)", "time (s)", "difference"):
        assert f"<!-- {label} -->" in text


def test_a_constant_timing_is_the_constant_delay() -> None:
    """Two ways to say the same; jitter says something else."""
    diagram = pi_diagram(PI, 9.0, LOOP.time_constant)
    run = encoder_run(LOOP, diagram, 4.0, 0.4, 1, delay=0.0023)
    same = encoder_run(LOOP, diagram, 4.0, 0.4, 1, timing=SampleTiming.constant(0.0023))
    assert np.array_equal(run.control, same.control)
    jitter = SampleTiming(np.array([0.0, 0.0015]), np.array([0.002, 0.001]))
    other = encoder_run(LOOP, diagram, 4.0, 0.4, 1, timing=jitter)
    assert not np.array_equal(run.control, other.control)


def test_a_timing_that_cannot_be_is_refused() -> None:
    """Lengths and signs."""
    with pytest.raises(DesignError, match="same number of samples"):
        SampleTiming(np.zeros(2), np.zeros(3))
    with pytest.raises(DesignError, match="must not be negative"):
        SampleTiming(np.zeros(1), np.full(1, -1.0))
