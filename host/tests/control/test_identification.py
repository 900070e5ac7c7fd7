# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Identification of a motor from voltages and counts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ravenbrick.catalogue import part_values
from ravenbrick.control.estimation.identification import (
    MotorData,
    fit_motor,
    predict_counts,
    simulate_counts,
    validate_motor,
)
from ravenbrick.errors import DesignError

TRUE = {"gain": 2.03, "time_constant": 0.037, "friction_voltage": 0.25}


def experiment(seed: int, true: dict[str, float] = TRUE, lowest: float = 1.5) -> MotorData:
    """Two seconds of voltages between `lowest` and 6 V, counted as an encoder does."""
    random = np.random.default_rng(seed)
    change = np.sort(random.uniform(0.1, 2.0, 14))
    voltage = random.uniform(lowest, 6.0, 14)
    time = np.arange(0.0, 2.2, 0.002)
    blank = MotorData(time, np.zeros(len(time)), change, voltage)
    count = np.floor(simulate_counts(blank, true, phase=float(random.uniform())))
    return MotorData(time, count, change, voltage)


def test_the_model_is_the_differential_equation() -> None:
    """Against numerical integration, through reversals and a stand-still."""
    change, voltage = np.array([0.1, 0.4, 0.7, 1.2]), np.array([4.0, -3.0, 0.1, 2.0])
    time = np.arange(0.0, 1.5, 0.005)
    data = MotorData(time, np.zeros(len(time)), change, voltage)
    counts = simulate_counts(data, TRUE)

    def slope(instant: float, state: np.ndarray) -> list[float]:
        place = int(np.searchsorted(change, instant, side="right")) - 1
        volts = voltage[place] if place >= 0 else 0.0
        friction = TRUE["friction_voltage"] * math.tanh(state[1] / 1e-3)
        return [state[1], (TRUE["gain"] * (volts - friction) - state[1]) / TRUE["time_constant"]]

    exact = solve_ivp(
        slope, (0, 1.5), [0.0, 0.0], t_eval=time, max_step=1e-3, method="LSODA", rtol=1e-8
    )
    assert np.abs(np.degrees(exact.y[0]) - counts).max() < 0.3


def test_the_intervals_hold_the_true_values() -> None:
    """Six seeds; with 95 % for all parameters together at most one may miss."""
    missed = 0
    for seed in range(6):
        found = fit_motor(experiment(seed))
        missed += not all(one.holds(TRUE[one.name]) for one in found.parameters)
        assert found.error == pytest.approx(12**-0.5, abs=0.02)
    assert missed <= 1


def test_the_identified_motor_foretells_other_data() -> None:
    """Half a count on voltages that it was not fitted to; a wrong motor is far off."""
    found = fit_motor(experiment(1))
    assert validate_motor(found, experiment(2)).error < 0.8
    assert validate_motor(found, experiment(2)).share > 0.99999
    other = experiment(3, {**TRUE, "gain": 1.8})
    assert validate_motor(found, other).error > 20


def test_a_motor_without_friction_has_an_interval_that_begins_at_zero() -> None:
    """It was refused as if the experiment did not tell the parameters apart."""
    found = fit_motor(experiment(4, {**TRUE, "friction_voltage": 0.0}))
    friction = found.parameters[2]
    assert friction.low == 0.0
    assert friction.value < friction.high < 0.05


def test_the_band_of_a_prediction_covers_other_data_and_not_that_of_another_motor() -> None:
    """All counts of 30 manoeuvres but a few; two counts wide, and too narrow for a wrong motor."""
    found = fit_motor(experiment(1))
    bands = [(predict_counts(found, data), data) for data in map(experiment, range(2, 32))]
    assert sum(band.covers(data.count) for band, data in bands) >= 28
    assert all(1.0 < band.half_width < 2.5 for band, _ in bands)
    for name, factor in (("gain", 1.01), ("time_constant", 1.2), ("friction_voltage", 1.5)):
        other = experiment(3, {**TRUE, name: factor * TRUE[name]})
        assert not predict_counts(found, other).covers(other.count), name


def test_friction_and_inertia_follow_with_what_a_meter_shows() -> None:
    """The plant's constants of the paper's Table 1 come back."""
    motor = part_values("motors", "nxt")
    resistance, torque = motor["resistance"], motor["torque_constant"]
    electric, viscous = motor["electric_constant"], motor["viscous_friction"]
    inertia, coulomb = motor["inertia"], motor["coulomb_friction"]
    damping = viscous * resistance + torque * electric
    true = {
        "gain": torque / damping,
        "time_constant": resistance * inertia / damping,
        "friction_voltage": coulomb * resistance / torque,
    }
    found = fit_motor(experiment(5, true))
    known = {"resistance": resistance, "torque_constant": torque, "electric_constant": electric}
    constants = found.constants(known)
    assert constants["inertia"] == pytest.approx(inertia, rel=0.02)
    assert constants["viscous_friction"] == pytest.approx(viscous, rel=0.1)
    assert constants["coulomb_friction"] == pytest.approx(coulomb, rel=0.1)
    with pytest.raises(DesignError, match="needs an electric_constant below"):
        found.constants({**known, "electric_constant": 0.6})


def test_one_level_does_not_tell_gain_from_friction() -> None:
    """A single step: the message says what the experiment lacks."""
    time = np.arange(0.0, 2.0, 0.002)
    data = MotorData(time, np.zeros(len(time)), np.array([0.1]), np.array([4.0]))
    count = np.floor(simulate_counts(data, TRUE))
    with pytest.raises(DesignError, match="between several levels"):
        fit_motor(MotorData(time, count, data.change, data.voltage))


def test_a_motor_that_hardly_turns_is_refused() -> None:
    """Less than a turn."""
    data = experiment(1)
    with pytest.raises(DesignError, match="turned by 0 degrees"):
        fit_motor(MotorData(data.time, np.zeros(len(data.time)), data.change, data.voltage))
    with pytest.raises(DesignError, match="too little data"):
        MotorData(np.arange(3.0), np.arange(3.0), np.zeros(1), np.ones(1))
