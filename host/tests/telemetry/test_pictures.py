# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Steps cut out of live signals, and the pictures made of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.backend_bases import MouseButton, MouseEvent
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from verification.support.telemetry_program import Program

from ravenbrick.errors import UsageError
from ravenbrick.telemetry import Session
from ravenbrick.telemetry.picture import signals_figure, steps_figure, units_of
from ravenbrick.telemetry.steps import live_steps
from ravenbrick.telemetry.window import LiveFigure
from ravenbrick.trace.design import Design, Response

TIME_CONSTANT = 0.1


def stepping() -> Session:
    """Set-points 0, 4 and 2 V, half a second each, followed with a time constant of 0.1 s."""
    program, session, speed = Program(), Session(), 0.0
    session.receive(program.receive(session.connected(0.0)))
    for number in range(375):
        setpoint = (0.0, 4.0, 2.0)[number // 125]
        session.receive(program.sample(1, setpoint, speed) + program.sample(2, 7900))
        speed += (setpoint - speed) * (1 - math.exp(-0.004 / TIME_CONSTANT))
        program.time_us += 4_000
    return session


def test_steps_are_found_and_scaled() -> None:
    """Each change of the set-point is a step from 0 to 1, upwards and downwards."""
    session = stepping()
    assert session.run is not None
    steps = live_steps(session.run.recording(), "setpoint", "speed")
    assert [(round(s.at_s, 3), s.height) for s in steps] == [(0.5, 4.0), (1.0, -2.0)]
    for step in steps:
        assert step.times[0] == 0
        at_time_constant = float(np.interp(TIME_CONSTANT, step.times, step.values))
        assert at_time_constant == pytest.approx(1 - math.exp(-1), abs=0.02)


def test_a_mean_of_samples_takes_the_counts_out_of_a_speed() -> None:
    """Noise of every second sample goes; the step stays at its instant."""
    session = stepping()
    assert session.run is not None
    column = session.run.groups[1].columns[1]
    for number in range(len(column)):
        column[number] += 1.0 if number % 2 else -1.0
    recording = session.run.recording()
    for step in live_steps(recording, "setpoint", "speed", mean=8):
        at_time_constant = float(np.interp(TIME_CONSTANT, step.times, step.values))
        assert at_time_constant == pytest.approx(1 - math.exp(-1), abs=0.02)


@pytest.mark.parametrize(("samples", "count"), [(7, 0), (8, 1)])
def test_a_step_that_has_just_happened_is_none_yet(samples: int, count: int) -> None:
    """It takes eight samples of the output."""
    program, session = Program(), Session()
    session.receive(program.receive(session.connected(0.0)))
    for number in range(10 + samples):
        session.receive(program.sample(1, 0.0 if number < 10 else 4.0, 0.0))
        program.time_us += 4_000
    assert session.run is not None
    assert len(live_steps(session.run.recording(), "setpoint", "speed")) == count


def test_a_change_below_a_tenth_of_the_largest_is_no_step() -> None:
    """By hand: of 4 V, 0.45 V up is one and 0.35 V down is none."""
    program, session = Program(), Session()
    session.receive(program.receive(session.connected(0.0)))
    for number in range(80):
        session.receive(program.sample(1, (0.0, 4.0, 4.45, 4.1)[number // 20], 0.0))
        program.time_us += 4_000
    assert session.run is not None
    steps = live_steps(session.run.recording(), "setpoint", "speed")
    assert [round(step.height, 2) for step in steps] == [4.0, 0.45]


def test_a_slider_that_is_moved_sends_its_value() -> None:
    """A click in the middle of the first slider, whose parameter goes from 0 to 2."""
    program, session = Program(), Session()
    session.receive(program.receive(session.connected(0.0)))
    figure, told = Figure(), list[str]()
    canvas = FigureCanvasAgg(figure)
    live = LiveFigure(figure, session, told.append)
    live.refresh()
    place = next(axes for axes in figure.axes if axes.get_xlim() == (0.0, 2.0))
    x, y = place.transData.transform((1.0, 0.5))
    signals = [axes for axes in figure.axes if axes.get_ylabel()]
    assert signals
    assert min(a.get_position().y0 for a in signals) > place.get_position().y1
    canvas.callbacks.process(
        "button_press_event", MouseEvent("button_press_event", canvas, x, y, MouseButton.LEFT)
    )
    session.receive(program.receive(session.pending(1.0)))
    assert program.gains == [pytest.approx(1.0), 8.0]
    assert not told


def test_unknown_signals_are_named() -> None:
    """The names that exist are said."""
    session = stepping()
    assert session.run is not None
    with pytest.raises(UsageError, match="recorded are: battery, setpoint, speed"):
        live_steps(session.run.recording(), "setpoint", "velocity")


def test_pictures_name_axes_and_units() -> None:
    """One axis per unit; steps over both responses of the design."""
    session = stepping()
    assert session.run is not None
    assert units_of(session.run) == ["V", "mV"]
    figure = signals_figure(session.run)
    assert [axis.get_ylabel() for axis in figure.axes] == ["(V)", "(mV)"]
    drawn = [[str(line.get_label()) for line in axis.get_lines()] for axis in figure.axes]
    assert drawn == [["setpoint", "speed"], ["battery"]]
    assert figure.axes[-1].get_xlabel() == "time since power-on (s)"
    line = figure.axes[0].get_lines()[0]
    assert np.asarray(line.get_xdata())[[0, -1]] == pytest.approx([0, 1.496])
    height = figure.get_figheight()
    del session.run.groups[2]
    assert height > signals_figure(session.run).get_figheight() + 1
    times = np.linspace(0, 0.5, 100)
    response = Response(times, 1 - np.exp(-times / TIME_CONSTANT), 0.4, 0.0)
    steps = live_steps(session.run.recording(), "setpoint", "speed")
    design = Design({"continuous": response, "sampled": response}, {}, ())
    axes = steps_figure(steps, design, "setpoint", "speed").axes[0]
    assert axes.get_ylabel() == "speed per step of setpoint"
    lines = axes.get_lines()
    labels = [str(line.get_label()) for line in lines]
    assert labels[:2] == ["continuous design", "sampled design"]
    assert labels[2] == "live, step of 4 at 0.50 s"
