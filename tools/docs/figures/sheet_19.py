# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet on telemetry: a recorded experiment, and how certain it makes the motor."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.control.estimation.identification import MotorData, fit_motor
from ravenbrick.image.elf import read_image
from ravenbrick.model import NXT_MOTOR
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.motor_data import signal_data
from ravenbrick.trace.recording import Recording

from tools.docs.figures import SERIES, legend, new_figure, picture, project
from tools.docs.lessons import SHEETS, files_of
from tools.docs.live_steps import TURN_MS, Conversation

SCENARIO = files_of(SHEETS / "19-telemetry.md")["lab19/scenarios/own.toml"]
HOLDS_MS = (100, 200, 300, 500, 1000, 2000)
CONNECTED_MS, EXPERIMENT_MS = 1_000, 15_500
# Steps of the co-processor's pulses, and of its measurement of the battery in volts.
PULSE_STEPS, BATTERY_STEP = 125, 0.013848


@cache
def _own() -> tuple[Path, Robot, Scenario]:
    folder = project("motor", {"scenarios/own.toml": SCENARIO})
    robot = read_robot(folder)
    return folder, robot, read_scenario(scenario_path(folder, "own"), robot)


@cache
def _recorded(hold_ms: int) -> Recording:
    """The sheet's experiment in virtual time: a random set-point every `hold_ms`."""
    folder, robot, scenario = _own()
    image = read_image(Workspace.of(folder).image("ram", robot.name))
    brick = VirtualTarget().prepare(robot, scenario, image)
    brick.run_until(MASTER_CLOCK.cycles_of_ms(CONNECTED_MS))
    conversation, drawn, due_ms = Conversation(brick), random.Random(1), 0
    session = conversation.session
    for now_ms in range(0, EXPERIMENT_MS, TURN_MS):
        if session.described and now_ms >= due_ms:
            session.set_parameter("setpoint", round(drawn.uniform(-4.5, 4.5), 2))
            due_ms = now_ms + hold_ms
        conversation.talk(TURN_MS)
    assert session.run is not None
    return session.run.recording()


def _published(hold_ms: int) -> MotorData:
    return signal_data(_recorded(hold_ms), "control", "angle")


def _of_pulses(hold_ms: int) -> MotorData:
    """The same with the voltage that the pulses have: whole per cent, then whole steps below."""
    _, robot, _ = _own()
    battery, data = robot.battery.voltage.value, _published(hold_ms)
    measured = battery // BATTERY_STEP * BATTERY_STEP
    steps = np.trunc(np.round(100 * data.voltage / measured) * PULSE_STEPS / 100)
    return replace(data, voltage=steps / PULSE_STEPS * battery)


def _true_values() -> dict[str, float]:
    """Gain, time constant and friction of the scenario's motor, by its equations."""
    _, _, scenario = _own()
    own = scenario.deviations["B"]
    motor = replace(
        NXT_MOTOR,
        torque_constant=own["torque_constant"],
        electric_constant=own["electric_constant"],
    )
    return {
        "gain": motor.gain,
        "time_constant": motor.time_constant,
        "friction_voltage": motor.resistance * own["coulomb_friction"] / motor.torque_constant,
    }


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
    below.set(xlabel="time (s)", ylabel="in volts", ylim=(-5, 9))
    legend(below, "upper left")
    return picture(figure)


def intervals() -> str:
    """Intervals of the three parameters over the time that a set-point is held."""
    figure, axes = new_figure(7.0, 6.0, 3)
    kinds: dict[str, Callable[[int], MotorData]]
    kinds = {"published voltage": _published, "voltage of the pulses": _of_pulses}
    units = {"gain": "rad/s/V", "time_constant": "s", "friction_voltage": "V"}
    places = np.arange(len(HOLDS_MS))
    for number, (kind, data) in enumerate(kinds.items()):
        fits = [{p.name: p for p in fit_motor(data(hold)).parameters} for hold in HOLDS_MS]
        for axis, name in zip(axes, units, strict=True):
            found = [fit[name] for fit in fits]
            values = np.array([p.value for p in found])
            reach = np.array([[p.value - p.low, p.high - p.value] for p in found]).T
            axis.errorbar(
                places + 0.2 * number, values, reach, fmt="o", color=SERIES[1 - number],
                capsize=5, label=kind,
            )  # fmt: skip
    for axis, (name, unit) in zip(axes, units.items(), strict=True):
        axis.axhline(_true_values()[name], color="black", linewidth=1)
        axis.set(ylabel=f"{name.replace('_', ' ')} ({unit})")
        axis.set_xticks(list(places + 0.1), [str(hold) for hold in HOLDS_MS])
    axes[-1].set(xlabel="time that a set-point is held (ms)")
    axes[0].margins(y=0.3)
    legend(axes[0], "upper right", columns=2)
    return picture(figure)
