# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet on telemetry: a recorded experiment, and how certain it makes the motor."""

from __future__ import annotations

import random
from functools import cache

import numpy as np
from ravenbrick.brick.links.peers import BluetoothComputer
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.control.estimation.identification import IdentifiedMotor, fit_motor
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.telemetry import Session
from ravenbrick.trace.motor_data import signal_data
from ravenbrick.trace.recording import Recording

from tools.docs.figures import SERIES, legend, new_figure, picture, project
from tools.docs.lessons import SHEETS, files_of

SHEET = files_of(SHEETS / "19-telemetry.md")
HOLDS_MS = (100, 200, 300, 500, 1000, 2000)
TURN_MS, CONNECTED_MS, UNTIL_MS = 10, 1_000, 17_500
# Of the motor in the sheet's scenario, by its equations.
TRUE = {"gain": 2.1655, "time_constant": 0.04235, "friction_voltage": 0.1301}


@cache
def _recorded(hold_ms: int, seed: int = 1) -> Recording:
    """The sheet's experiment in virtual time: a random set-point every `hold_ms`."""
    edits = {"scenarios/own.toml": SHEET["lab19/scenarios/own.toml"]}
    folder = project("motor", edits)
    robot = read_robot(folder)
    image = read_image(Workspace.of(folder).image("ram", robot.name))
    brick = VirtualTarget().prepare(
        robot, read_scenario(scenario_path(folder, "own"), robot), image
    )
    brick.run_until(MASTER_CLOCK.cycles_of_ms(CONNECTED_MS))
    computer, session, drawn = BluetoothComputer(brick, pin="1234"), Session(), random.Random(seed)
    computer.connect(timeout_ms=CONNECTED_MS)
    computer.write(session.connected(MASTER_CLOCK.seconds(brick.cycles)))
    due_ms = 0
    for now_ms in range(0, UNTIL_MS - 2 * CONNECTED_MS, TURN_MS):
        if session.described and now_ms >= due_ms:
            session.set_parameter("setpoint", round(drawn.uniform(-4.5, 4.5), 2))
            due_ms = now_ms + hold_ms
        computer.write(session.pending(MASTER_CLOCK.seconds(brick.cycles)))
        brick.run_until(brick.cycles + MASTER_CLOCK.cycles_of_ms(TURN_MS))
        session.receive(computer.take())
    assert session.run is not None
    return session.run.recording()


@cache
def _fitted(hold_ms: int) -> IdentifiedMotor:
    return fit_motor(signal_data(_recorded(hold_ms), "control", "angle"))


def record() -> str:
    """Voltage and speed of two seconds of the experiment, as the computer received them."""
    recording = _recorded(300)
    figure, (above, below) = new_figure(7.0, 3.6, 2)
    seconds, volts = recording.signal("control")
    _, speed = recording.signal("speed")
    _, wanted = recording.signal("setpoint")
    shown = (seconds > 6.0) & (seconds < 8.0)
    above.step(seconds[shown], volts[shown], where="post", color=SERIES[1])
    below.step(seconds[shown], wanted[shown], where="post", color="black", label="set-point")
    below.plot(seconds[shown], speed[shown], color=SERIES[0], label="speed")
    above.set(ylabel="voltage (V)")
    below.set(xlabel="time (s)", ylabel="in volts")
    legend(below, "lower left")
    return picture(figure)


def intervals() -> str:
    """Intervals of the three parameters over the time that a set-point is held."""
    figure, axes = new_figure(7.0, 6.0, 3)
    names = {"gain": "rad/s/V", "time_constant": "s", "friction_voltage": "V"}
    for one, (name, unit) in zip(axes, names.items(), strict=True):
        found = [next(p for p in _fitted(h).parameters if p.name == name) for h in HOLDS_MS]
        values = np.array([p.value for p in found])
        reach = np.array([[p.value - p.low, p.high - p.value] for p in found]).T
        places = range(len(HOLDS_MS))
        one.errorbar(places, values, reach, fmt="o", color=SERIES[0], capsize=5)
        one.axhline(TRUE[name], color=SERIES[1], linewidth=1)
        one.set(ylabel=f"{name.replace('_', ' ')} ({unit})")
        one.set_xticks(list(places), [str(hold) for hold in HOLDS_MS])
    axes[-1].set(xlabel="time that a set-point is held (ms)")
    return picture(figure)
