# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Gains that are dragged: poles, step, margins and code follow."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest
from matplotlib.figure import Figure

from ravenbrick.codegen import generate_c
from ravenbrick.control import LoopSpecification, finish_design, pi_by_lambda, pi_with_estimator
from ravenbrick.control.analysis.frequency_plots import new_figure, plane_grid
from ravenbrick.control.design.interactive import InteractiveDesign, TunableLoop
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, Gain, Inport, Outport, Parameter, SpeedLoop, Sum

LOOP = SpeedLoop(2.029, 0.037, 116.0)
WANTED = LoopSpecification(settling_time=0.4, overshoot=0.005, sample_time=0.004, window=8,
                           delay=0.0023)  # fmt: skip


@pytest.fixture(scope="module")
def tunable() -> TunableLoop:
    """The vehicle's speed loop."""
    discrete = pi_with_estimator(LOOP, WANTED).rounded(6)
    design = finish_design("v", LOOP, WANTED, pi_by_lambda(LOOP, 0.4), discrete, 8.0)
    return TunableLoop.of(LOOP, WANTED, design.controller)


def test_what_the_linear_loop_depends_on_is_open(tunable: TunableLoop) -> None:
    """Not the limit and the anti-windup behind it."""
    assert list(tunable.gains) == ["Kp", "Ki_Ts"]


def test_poles_and_code_follow_a_slider(tunable: TunableLoop) -> None:
    """Poles as python-control closes the loop; the C has the gain that the slider shows."""
    name = f"{tunable.program.name}.c"
    shown = InteractiveDesign(
        Figure(figsize=(12, 8)), tunable, lambda program: generate_c(program).files[name]
    )
    before = shown.figures()
    shown.sliders["Kp"].set_val(0.6)
    assert "0.6F, /* Kp:" in shown.lines()
    assert tunable.gains["Kp"] != 0.6
    loop = shown.loop.sampled
    closed = control.feedback(loop.open_loop(), 1)
    for pole in loop.poles():
        assert np.abs(closed.poles() - pole).min() < 1e-6
    after = shown.figures()
    assert after["phase_margin_deg"] > before["phase_margin_deg"] + 10
    assert after["settling_time"] > before["settling_time"] + 0.1


def test_a_loop_that_is_not_stable_says_so(tunable: TunableLoop) -> None:
    """And can be dragged back."""
    figure = Figure(figsize=(12, 8))
    shown = InteractiveDesign(figure, tunable)
    shown.set({"Kp": 6.0})
    assert figure.get_suptitle() == "not stable"
    assert shown.figures() == {}
    shown.set(tunable.gains)
    assert "settles in 400 ms" in figure.get_suptitle()


def test_a_controller_of_numbers_only_is_refused() -> None:
    """With the way to open a gain."""
    diagram = Diagram("fixed", 0.004)
    error = diagram.add(Sum("Error", signs="+-"))
    diagram.connect(diagram.add(Inport("Wanted")), error, 0)
    diagram.connect(diagram.add(Inport("Speed")), error, 1)
    diagram.connect_chain(error, diagram.add(Gain("Kp", gain=0.3)), diagram.add(Outport("Volts")))
    with pytest.raises(DesignError, match="give one of its blocks a Parameter"):
        TunableLoop.of(LOOP, WANTED, diagram)


@pytest.mark.parametrize("sample_time", [0.01, None])
def test_poles_of_a_damping_and_a_frequency_lie_on_lines_of_the_grid(
    sample_time: float | None,
) -> None:
    """Damping 0.5, three tenths of the highest frequency."""
    _, axes = new_figure(5, 5)
    axis = axes[0, 0]
    axis.set_xlim(-100, 10)
    axis.set_ylim(-100, 100)
    plane_grid(axis, sample_time)
    highest = math.pi / sample_time if sample_time else math.hypot(100, 100)
    root = 0.3 * highest * complex(-0.5, math.sqrt(0.75))
    pole = np.exp(root * sample_time) if sample_time else root
    near = []
    for line in axis.lines:
        x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        ends = x + 1j * y
        steps = np.linspace(0, 1, 2000)
        fine = (ends[:-1, np.newaxis] + np.diff(ends)[:, np.newaxis] * steps).ravel()
        near.append(float(np.abs(fine - pole).min() / abs(pole)))
    assert sorted(near)[1] < 1e-3


def servo() -> TunableLoop:
    """An angle under a proportional loop around a proportional loop of the speed, at 10 ms."""
    diagram = Diagram("servo", 0.01)
    away, error = diagram.add(Sum("Away", signs="+-")), diagram.add(Sum("Error", signs="+-"))
    outer = diagram.add(Gain("Outer", gain=Parameter("Kx", 6.0, "1/s", "of the angle")))
    inner = diagram.add(Gain("Inner", gain=Parameter("Kv", 2.0, "V s/rad", "of the speed")))
    diagram.connect_chain(diagram.add(Inport("wanted")), away, outer, error, inner)
    diagram.connect(diagram.add(Inport("speed")), error, 1)
    diagram.connect(diagram.add(Inport("angle")), away, 1)
    diagram.connect_chain(inner, diagram.add(Outport("voltage")))
    plant = control.ss([[0, 1], [0, -20]], [[0], [40]], np.eye(2), np.zeros((2, 1)))
    return TunableLoop.around(plant, diagram, {"angle": 0, "speed": 1}, 2.0)


def test_a_cascade_around_any_plant_is_dragged() -> None:
    """Poles, step and margins as python-control closes both loops, one after the other."""
    shown = InteractiveDesign(Figure(figsize=(12, 8)), servo())
    shown.sliders["Kx"].set_val(9.0)
    loop = shown.loop.sampled
    motor = control.sample_system(control.ss([[0, 1], [0, -20]], [[0], [40]], np.eye(2),
                                             np.zeros((2, 1))), 0.01, "zoh")  # fmt: skip
    speed = control.ss(motor.A - 2.0 * motor.B @ [[0, 1]], 2.0 * motor.B, [[1, 0]], 0, 0.01)
    closed = control.feedback(9.0 * speed, 1)
    assert np.sort_complex(loop.poles()) == pytest.approx(np.sort_complex(closed.poles()))
    times = np.arange(0, 2.0, 0.01)
    response = control.step_response(closed, times).outputs
    assert loop.step_response(2.0).output == pytest.approx(response, abs=1e-9)
    assert shown.figures()["overshoot"] == pytest.approx(response.max() - 1, abs=1e-6)
    cut = control.ss(motor.A, motor.B, [[18.0, 2.0]], 0, 0.01)
    found = shown.figures()
    assert found["phase_margin_deg"] == pytest.approx(control.margin(cut)[1], abs=0.01)
    at_the_edge = control.feedback(found["gain_margin"] * cut, 1).poles()
    assert np.abs(at_the_edge).max() == pytest.approx(1.0, abs=1e-6)


def test_a_loop_that_cannot_be_closed_is_refused() -> None:
    """With what is expected."""
    diagram = Diagram("one", 0.01)
    gain = Gain("K", gain=Parameter("K", 1.0, "", ""))
    diagram.connect_chain(diagram.add(Inport("wanted")), diagram.add(gain),
                          diagram.add(Outport("u")))  # fmt: skip
    with pytest.raises(DesignError, match="no input 'angle'; it has"):
        TunableLoop.around(control.tf([1], [1, 1]), diagram, {"angle": 0})
    with pytest.raises(DesignError, match="continuous system with one input"):
        _ = TunableLoop.around(control.tf([1, 0], [1, 1]), diagram, {}).sampled
