# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Gains that are dragged: poles, step, margins and code follow."""

from __future__ import annotations

import math
from typing import Any

import control
import numpy as np
import pytest
from matplotlib.figure import Figure

from ravenbrick.codegen import generate_c
from ravenbrick.control import LoopSpecification, finish_design, pi_by_lambda, pi_with_estimator
from ravenbrick.control.analysis.frequency_plots import new_figure, plane_grid
from ravenbrick.control.design.interactive import InteractiveDesign, TunableLoop
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Diagram,
    Execution,
    Gain,
    Inport,
    Outport,
    Parameter,
    SpeedLoop,
    Sum,
)

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
    # The battery's limit is called Saturation, as the kind of a block.
    assert "8.0F /* Saturation:" in shown.lines()
    assert "<Root>" not in shown.lines()
    assert tunable.gains["Kp"] != 0.6
    loop = shown.loop.sampled
    closed = control.feedback(loop.open_loop(), 1)
    for pole in loop.poles():
        assert np.abs(closed.poles() - pole).min() < 1e-6
    after = shown.figures()
    assert after["phase_margin_deg"] > before["phase_margin_deg"] + 10
    assert after["settling_time"] > before["settling_time"] + 0.1


def test_code_and_sliders_stand_beside_the_pictures(tunable: TunableLoop) -> None:
    """Nothing is on or outside of anything else: axes, and the text of the code."""
    name = f"{tunable.program.name}.c"
    figure = Figure(figsize=(12, 8))
    InteractiveDesign(figure, tunable, lambda program: generate_c(program).files[name])
    figure.canvas.draw()
    areas = [axis.get_window_extent() for axis in figure.axes]
    for number, area in enumerate(areas):
        assert not any(area.overlaps(other) for other in areas[:number])
    (code,) = [text for axis in figure.axes for text in axis.texts if "Kp:" in text.get_text()]
    lines = code.get_window_extent()
    assert figure.bbox.contains(*lines.min) and figure.bbox.contains(*lines.max)
    assert sum(area.overlaps(lines) for area in areas) == 1


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


@pytest.mark.parametrize("sample_time", [0.01, None])
def test_lines_of_the_grid_are_labelled_with_what_they_mean(sample_time: float | None) -> None:
    """At the place of each label: the damping, or the natural frequency in 1/s; the view stays."""
    _, axes = new_figure(5, 5)
    axis = axes[0, 0]
    axis.set_xlim(-100, 10)
    axis.set_ylim(-100, 100)
    plane_grid(axis, sample_time)
    kinds = {"/s": 0, "": 0}
    for text in axis.texts:
        place = complex(*text.get_position())
        root = np.log(place) / sample_time if sample_time else place
        unit = "/s" if text.get_text().endswith("/s") else ""
        value = float(text.get_text().removesuffix("/s"))
        found = abs(root) if unit else -root.real / abs(root)
        assert found == pytest.approx(value, rel=6e-3)
        kinds[unit] += 1
    assert kinds == {"/s": 10, "": 9}


def test_the_grid_does_not_move_the_view_of_the_poles() -> None:
    """Its arcs reach further to the left than what was drawn before."""
    _, axes = new_figure(5, 5)
    axis = axes[0, 0]
    axis.plot([-100, 10], [-100, 100])
    left, high = axis.get_xlim()[0], axis.get_ylim()[1]
    plane_grid(axis, None)
    assert axis.get_xlim()[0] == left and axis.get_ylim() == (-high, high)
    assert min(np.min(line.get_xdata()) for line in axis.lines) < left


MOTOR = control.ss([[0, 1], [0, -20]], [[0], [40]], np.eye(2), np.zeros((2, 1)))
WHEELS = control.ss([[-10, 3], [3, -12]], [[30, 4], [4, 25]], np.eye(2), np.zeros((2, 2)))
DRIVEN = {"volts_left": 0, "volts_right": 1}


def cascade(outer_time: float, outer_gain: float = 6.0) -> Diagram:
    """An angle under a proportional loop around a proportional loop of the speed at 10 ms."""
    diagram = Diagram("servo", 0.01)
    away = diagram.add(Sum("Away", signs="+-", sample_time=outer_time))
    error = diagram.add(Sum("Error", signs="+-"))
    gain = Parameter("Kx", outer_gain, "1/s", "of the angle")
    outer = diagram.add(Gain("Outer", gain=gain, sample_time=outer_time))
    inner = diagram.add(Gain("Inner", gain=Parameter("Kv", 2.0, "V s/rad", "of the speed")))
    diagram.connect_chain(diagram.add(Inport("wanted")), away, outer, error, inner)
    diagram.connect(diagram.add(Inport("speed")), error, 1)
    diagram.connect(diagram.add(Inport("angle")), away, 1)
    diagram.connect_chain(inner, diagram.add(Outport("voltage")))
    return diagram


def servo(outer_time: float = 0.01) -> TunableLoop:
    """That cascade around a motor."""
    return TunableLoop.around(MOTOR, cascade(outer_time), {"angle": 0, "speed": 1}, 2.0)


def test_a_cascade_around_any_plant_is_dragged() -> None:
    """Poles, step and margins as python-control closes both loops, one after the other."""
    shown = InteractiveDesign(Figure(figsize=(12, 8)), servo())
    shown.sliders["Kx"].set_val(9.0)
    loop = shown.loop.sampled
    motor = control.sample_system(MOTOR, 0.01, "zoh")
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


def test_a_cascade_of_two_rates_has_the_poles_of_its_slow_rate() -> None:
    """The inner loop by hand through four of its steps, with the outer one's command held."""
    figure = Figure(figsize=(12, 8))
    shown = InteractiveDesign(figure, servo(0.04))
    shown.sliders["Kx"].set_val(9.0)
    motor = control.sample_system(MOTOR, 0.01, "zoh")
    inner, force = motor.A - 2.0 * motor.B @ [[0, 1]], 2.0 * motor.B
    four = np.linalg.matrix_power(inner, 4)
    held = sum(np.linalg.matrix_power(inner, k) for k in range(4)) @ force
    slow = np.linalg.eigvals(four - 9.0 * held @ [[1, 0]])
    poles = sorted(shown.loop.sampled.poles(), key=abs)
    assert np.sort_complex(poles[-2:]) == pytest.approx(np.sort_complex(slow))
    assert np.abs(poles[:-2]).max() < 1e-9
    assert "of 40 ms" in figure.axes[0].get_title()
    assert set(shown.figures()) == {"settling_time", "overshoot"}
    assert any("no Bode plot" in axis.get_title() for axis in figure.axes)


@pytest.mark.parametrize("factor", [2, 4])
def test_a_loop_of_several_rates_has_no_margins(factor: int) -> None:
    """A sine in is no single sine out, already where one rate is half the other."""
    shown = InteractiveDesign(Figure(figsize=(12, 8)), servo(0.01 * factor))
    assert set(shown.figures()) == {"settling_time", "overshoot"}


def test_the_step_of_two_rates_is_that_of_the_controller_as_it_runs() -> None:
    """The diagram's own steps with the motor between them; the figures are of these samples."""
    loop = servo(0.04).tuned({"Kx": 15.0})
    run, motor = Execution(cascade(0.04, 15.0)), control.sample_system(MOTOR, 0.01, "zoh")
    state, angles = np.zeros(2), []
    for _ in range(200):
        angles.append(state[0])
        inputs = {"wanted": 1.0, "angle": state[0], "speed": state[1]}
        state = motor.A @ state + motor.B[:, 0] * float(run.step(inputs)["voltage"])
    response = loop.sampled.step_response(2.0).output
    assert response == pytest.approx(np.array(angles), abs=1e-5)
    metrics = loop.sampled.step_metrics()
    assert metrics.overshoot == pytest.approx(response.max() - 1, abs=1e-6)
    outside = np.flatnonzero(np.abs(response - 1) > 0.02)
    assert metrics.settling_time == pytest.approx(0.01 * (outside[-1] + 1))


def two_wheels(**choice: Any) -> TunableLoop:
    """Two coupled wheels under a proportional controller each, at 10 ms."""
    diagram = Diagram("wheels", 0.01)
    for side, gain in (("left", 1.5), ("right", 0.75)):
        error = diagram.add(Sum(f"error_{side}", signs="+-"))
        diagram.connect(diagram.add(Inport(f"wanted_{side}")), error, 0)
        diagram.connect(diagram.add(Inport(f"speed_{side}")), error, 1)
        value = Parameter(f"K_{side}", gain, "V", "")
        volts = diagram.add(Gain(f"gain_{side}", gain=value))
        diagram.connect_chain(error, volts, diagram.add(Outport(f"volts_{side}")))
    measured = {"speed_left": 0, "speed_right": 1}
    return TunableLoop.around(WHEELS, diagram, measured, **choice)


def test_of_two_actuators_one_pair_is_shown_while_the_others_stay_closed() -> None:
    """Poles, step and margins as python-control closes one loop after the other."""
    loop = two_wheels(driven=DRIVEN, set_point="wanted_right", followed=1, cut="volts_right")
    plant = control.sample_system(WHEELS, 0.01, "zoh")
    gains = np.diag([1.5, 0.75])
    both = plant.A - plant.B @ gains
    assert np.sort_complex(loop.sampled.poles()) == pytest.approx(
        np.sort_complex(np.linalg.eigvals(both))
    )
    closed = control.ss(both, plant.B @ gains[:, [1]], [[0, 1]], 0, 0.01)
    response = control.step_response(closed, np.arange(0, 1, 0.01)).outputs
    assert loop.sampled.step_response(1.0).output == pytest.approx(response, abs=1e-9)
    left = plant.A - 1.5 * plant.B[:, [0]] @ [[1, 0]]
    cut = control.ss(left, plant.B[:, [1]], [[0, 0.75]], 0, 0.01)
    at = np.array([1.0, 10.0, 100.0])
    found = control.frequency_response(loop.sampled.open_loop(), at).complex
    assert found == pytest.approx(control.frequency_response(cut, at).complex)
    gain = loop.sampled.margins().gain_margin
    edge = np.linalg.eigvals(left - gain * 0.75 * plant.B[:, [1]] @ [[0, 1]])
    assert np.abs(edge).max() == pytest.approx(1.0, abs=1e-6)
    assert loop.cut == ", cut at volts_right, other loops closed"


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ({}, "has the outputs .*say which input of the plant each drives"),
        ({"driven": DRIVEN}, "choose one with set_point: wanted_left, wanted_right"),
        ({"driven": DRIVEN, "set_point": "speed_left"}, "'speed_left' is no such input; choose"),
        ({"driven": {"volts": 0}}, "no output 'volts'; it has"),
        ({"driven": {"volts_left": 2}, "set_point": "wanted_left"}, "0 to 1, so none has 2"),
        (
            {"driven": DRIVEN, "set_point": "wanted_left", "cut": "left"},
            "'left' is no such output .* choose one with cut: volts_left, volts_right",
        ),
    ],
)
def test_a_choice_that_is_missing_or_wrong_is_named(choice: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        _ = two_wheels(**choice).sampled


def test_a_speed_loop_with_a_slow_controller_is_refused() -> None:
    """With the way to show it."""
    diagram = cascade(0.04)
    with pytest.raises(DesignError, match="several rates or outputs; give it with its plant"):
        TunableLoop.of(LOOP, WANTED, diagram)


def test_a_loop_that_cannot_be_closed_is_refused() -> None:
    """With what is expected."""
    diagram = Diagram("one", 0.01)
    gain = Gain("K", gain=Parameter("K", 1.0, "", ""))
    diagram.connect_chain(diagram.add(Inport("wanted")), diagram.add(gain),
                          diagram.add(Outport("u")))  # fmt: skip
    with pytest.raises(DesignError, match="no input 'angle'; it has"):
        TunableLoop.around(control.tf([1], [1, 1]), diagram, {"angle": 0})
    with pytest.raises(DesignError, match="continuous system with no direct path"):
        _ = TunableLoop.around(control.tf([1, 0], [1, 1]), diagram, {}).sampled
