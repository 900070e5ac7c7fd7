# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The sampled loop between and at the samples, with estimator and delay."""

from __future__ import annotations

import control
import numpy as np
import pytest

from ravenbrick.control import (
    LoopSpecification,
    SampledLoop,
    pi_by_lambda,
    pi_diagram,
    pi_direct,
    pi_with_estimator,
)
from ravenbrick.errors import DesignError
from ravenbrick.model import NXT_MOTOR, IntegrationMethod, SpeedLoop, linearise

LOOP = SpeedLoop(2.029, 0.037, 116.0)
SAMPLE_TIME = 0.004
EULER = IntegrationMethod.FORWARD_EULER
TUSTIN = IntegrationMethod.TUSTIN
BACKWARD = IntegrationMethod.BACKWARD_EULER

# integrator, window, delay in samples, settling between the samples, settling at the samples
SETTLING = [
    (EULER, None, 0, 0.3844, 0.388),
    (EULER, 1, 0, 0.3763, 0.380),
    (EULER, None, 1, 0.3718, 0.372),
    (EULER, 1, 1, 0.3634, 0.364),
    (TUSTIN, None, 0, 0.3920, 0.392),
    (TUSTIN, 1, 0, 0.3841, 0.388),
    (TUSTIN, None, 1, 0.3799, 0.380),
    (TUSTIN, 1, 1, 0.3717, 0.372),
    (BACKWARD, None, 0, 0.3995, 0.400),
    (BACKWARD, 1, 0, 0.3917, 0.392),
    (BACKWARD, None, 1, 0.3877, 0.388),
    (BACKWARD, 1, 1, 0.3797, 0.380),
]


@pytest.mark.parametrize(("method", "window", "delay", "between", "at_samples"), SETTLING)
def test_the_discretised_loop_settles_as_computed_elsewhere(
    method: IntegrationMethod, window: int | None, delay: int, between: float, at_samples: float
) -> None:
    """Twelve cases with independently computed times (4 digits); none overshoots."""
    controller = pi_by_lambda(LOOP, 0.4).discretised(method, SAMPLE_TIME).controller()
    found = SampledLoop(LOOP, controller, window, delay * SAMPLE_TIME).step_metrics()
    assert found.settling_time == pytest.approx(between, abs=1.1e-4)
    assert found.settling_time_at_samples == pytest.approx(at_samples, abs=1e-9)
    assert found.overshoot == 0.0


def test_margins_with_one_sample_of_delay() -> None:
    """85.65 degrees and 28.6 dB for forward Euler."""
    controller = pi_by_lambda(LOOP, 0.4).discretised(EULER, SAMPLE_TIME).controller()
    found = SampledLoop(LOOP, controller, delay=SAMPLE_TIME).margins()
    assert found.phase_margin_deg == pytest.approx(85.65, abs=0.01)
    assert 20 * np.log10(found.gain_margin) == pytest.approx(28.6, abs=0.05)


@pytest.mark.parametrize("method", list(IntegrationMethod))
def test_the_direct_design_settles_exactly(method: IntegrationMethod) -> None:
    """0.4000 s to a microsecond, without overshoot, in every integrator form."""
    pi = pi_direct(LOOP, 0.4, SAMPLE_TIME, method)
    found = SampledLoop(LOOP, pi.controller()).step_metrics()
    assert found.settling_time == pytest.approx(0.4, abs=1e-6)
    assert found.overshoot == 0.0


def test_the_ideal_loop_has_the_poles_of_the_sampled_transfer_functions() -> None:
    """Without window and delay the poles are those that python-control computes."""
    controller = pi_by_lambda(LOOP, 0.4).discretised(TUSTIN, SAMPLE_TIME).controller()
    plant = control.sample_system(LOOP.plant(), SAMPLE_TIME, "zoh")
    wanted = np.sort(control.feedback(controller * plant).poles().real)
    np.testing.assert_allclose(
        np.sort(SampledLoop(LOOP, controller).poles().real), wanted, atol=1e-7
    )


def test_a_delay_between_samples_lies_between_its_neighbours() -> None:
    """The step response with 2 ms of delay is that of a simulation at half the sample time."""
    pi = pi_direct(LOOP, 0.4, SAMPLE_TIME, EULER)
    response = SampledLoop(LOOP, pi.controller(), delay=0.002).step_response(0.2, 2)
    plant = control.ss(control.sample_system(LOOP.plant(), SAMPLE_TIME / 2, "zoh"))
    speed, integral, command, outputs = 0.0, 0.0, 0.0, []
    for half in range(len(response.time)):
        outputs.append(speed)
        if half % 2 == 0:
            error = 1.0 - speed
            held, command = command, pi.proportional * error + integral
            integral += pi.integral_step * error
        voltage = command if half % 2 else held
        speed = float(plant.A[0, 0]) * speed + float((plant.C @ plant.B)[0, 0]) * voltage
    np.testing.assert_allclose(response.output, outputs, atol=1e-12)


def test_the_diagram_of_the_controller_is_its_transfer_function() -> None:
    """Linearised, the diagram with limit and anti-windup is C(z) on the error."""
    for method in IntegrationMethod:
        pi = pi_direct(LOOP, 0.4, SAMPLE_TIME, method)
        diagram = linearise(pi_diagram(pi, 8.0, 0.037))
        z = np.exp(1j * np.linspace(0.01, 3.0, 20))
        wanted = np.array([np.squeeze(pi.controller()(point)) for point in z])
        found = np.array([np.ravel(diagram(point)) for point in z])
        np.testing.assert_allclose(found, np.stack([wanted, -wanted], axis=1), atol=1e-12)


@pytest.mark.parametrize("window", [1, 4, 8, 16])
@pytest.mark.parametrize("delay", [0.0, 0.0023, 0.004])
def test_the_design_with_the_estimator_in_the_loop_meets_the_specification(
    window: int, delay: float
) -> None:
    """Exactly 400 ms and no overshoot with the window and the delay in the loop."""
    wanted = LoopSpecification(0.4, 0.005, SAMPLE_TIME, window, delay)
    pi = pi_with_estimator(LOOP, wanted)
    found = SampledLoop(LOOP, pi.controller(), window, delay).step_metrics()
    assert found.settling_time == pytest.approx(0.4, abs=1e-6)
    assert found.overshoot == 0.0


@pytest.mark.parametrize("settling_time", [0.08, 0.0725])
def test_a_design_near_the_fastest_response_is_found(settling_time: float) -> None:
    """A little more gain leaves the band again, so the gains that meet the time are close."""
    pi = pi_with_estimator(LOOP, LoopSpecification(settling_time, 0.02, SAMPLE_TIME, 8, 0.0023))
    found = SampledLoop(LOOP, pi.controller(), 8, 0.0023).step_metrics()
    assert found.settling_time == pytest.approx(settling_time, abs=1e-6)


def test_a_settling_time_of_whole_samples_has_a_design() -> None:
    """Rounding errors decide on which side of the last sample the band is left."""
    loop = SpeedLoop.of_motor(NXT_MOTOR, 116.0)
    pi = pi_with_estimator(loop, LoopSpecification(0.2, 0.005, 0.02, 1, 0.0023))
    found = SampledLoop(loop, pi.controller(), 1, 0.0023).step_metrics()
    assert found.settling_time == pytest.approx(0.2, abs=1e-6)


def test_a_specification_that_cannot_be_met_is_refused() -> None:
    """A window of 400 ms cannot settle in 80 ms."""
    with pytest.raises(DesignError, match=r"overshoot|no gain|to settle"):
        pi_with_estimator(LOOP, LoopSpecification(0.08, 0.005, SAMPLE_TIME, 100, 0.0))


def test_an_unstable_sampled_loop_is_refused() -> None:
    """Gains far too high are refused with the distance of the pole."""
    controller = control.tf([80.0, -70.0], [1.0, -1.0], SAMPLE_TIME)
    with pytest.raises(DesignError, match="not stable"):
        SampledLoop(LOOP, controller).step_metrics()
