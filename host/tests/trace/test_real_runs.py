# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Replay, exports and expectations of a short drive on the real virtual brick."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from verification.support.needed_tools import NEEDS_VIRTUAL_BRICK
from verification.support.projects import VEHICLE

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.brick.stimulus_callback import BrickState, Callback
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import read_image
from ravenbrick.project.criteria import parse_expectation
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, input_check, read_scenario, scenario_path
from ravenbrick.project.stimuli import Channels, read_stimulus
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.dynamics import handler_dynamics, task_dynamics
from ravenbrick.trace.export import Format, export
from ravenbrick.trace.export.timeline import timeline_of
from ravenbrick.trace.measures import measure_run
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.verdict import judge

IMAGE = Workspace.of(VEHICLE).image("ram", "vehicle")

pytestmark = [
    pytest.mark.skipif(not IMAGE.is_file(), reason="the vehicle is not built; 'make demo' does it"),
    NEEDS_VIRTUAL_BRICK,
]


def hand(state: BrickState) -> dict[str, float] | None:
    """Start by the touch sensor, then steer as soon as the wheel turns and the LCD says so."""
    if state.cycles < MASTER_CLOCK.cycles_of_ms(200):
        return None
    if state.cycles < MASTER_CLOCK.cycles_of_ms(350):
        return {"touch.1": 1.0}
    if state.read("vehicle_setpoint_left") > 1 and state.signal("motor.B.angle") > 1:
        return {"touch.1": 0.0, "motor.A.hand_angle": 0.25}
    return {"touch.1": 0.0}


@pytest.fixture(scope="module")
def robot() -> Robot:
    """The vehicle."""
    return read_robot(VEHICLE)


@pytest.fixture(scope="module")
def scenario(robot: Robot) -> Scenario:
    """Two seconds without inputs of its own."""
    drive = read_scenario(scenario_path(VEHICLE, "drive"), robot)
    return replace(drive, duration_ms=2000, inputs=(), pictures_ms=(), criteria=())


@pytest.fixture(scope="module")
def driven(robot: Robot, scenario: Scenario) -> Recording:
    """A drive by callback."""
    target = VirtualTarget(callback=Callback(hand, "hand", 50))
    return target.run(robot, scenario, read_image(IMAGE))


def test_a_drive_by_callback_replays_with_the_same_digest(
    robot: Robot, scenario: Scenario, driven: Recording
) -> None:
    """The recorded inputs alone give the same trace, whatever instants the callback chose."""
    assert {timed.name for timed in driven.inputs} == {"touch.1", "motor.A.hand_angle"}
    replayed = replace(scenario, stimuli=driven.inputs)
    again = VirtualTarget().run(robot, replayed, read_image(IMAGE))
    assert again.digest == driven.digest
    assert again.inputs == driven.inputs


def test_a_pin_that_is_spoken_of_is_recorded_change_by_change(
    robot: Robot, scenario: Scenario, driven: Recording
) -> None:
    """PA26 is an encoder line of motor B: it changes with each count. The trace is the same."""
    asked = replace(scenario, expectations=(parse_expectation("pin 26 ever high", "here"),))
    target = VirtualTarget(callback=Callback(hand, "hand", 50))
    recording = target.run(robot, asked, read_image(IMAGE))
    assert recording.digest == driven.digest
    pin = recording.signals["pin.26"]
    counts = recording.signals["motor.B.encoder"].values
    assert np.abs(np.diff(counts)).sum() > 100
    assert abs(pin.values.size - 1 - np.abs(np.diff(counts)).sum()) <= 1
    assert set(np.abs(np.diff(pin.values))) == {1.0}


def test_a_drive_is_played_again_from_its_vcd(
    robot: Robot, scenario: Scenario, driven: Recording, tmp_path: Path
) -> None:
    """The wheels do the same to the last bit; repeated values are not in the file."""
    pytest.importorskip("vcd", reason="pyvcd is an extra")
    (file,) = export(driven, Format.VCD, tmp_path / "drive.vcd")
    stimuli = read_stimulus(file, MASTER_CLOCK, Channels(input_check(robot)))
    again = VirtualTarget().run(robot, replace(scenario, stimuli=stimuli), read_image(IMAGE))
    for name in ("motor.B.angle", "motor.C.angular_velocity", "body.heading"):
        assert np.array_equal(again.signals[name].values, driven.signals[name].values)


def test_the_lcd_of_the_drive_can_be_graded(
    robot: Robot, scenario: Scenario, driven: Recording
) -> None:
    """Texts come at the display's instants and are whole."""
    measures = measure_run(robot, scenario, driven)
    for text in (
        'lcd shows "stopped" before 300 ms',
        'lcd shows "closed loop" after 400 ms',
        'lcd never shows "open loop"',
        "motor.B.angular_velocity at most 0.01 rad/s at 190 ms",
        "motor.B.angular_velocity ever at least 8 rad/s",
        "deadlines met",
        "no fault",
    ):
        verdict = judge(parse_expectation(text, "here"), measures)
        assert verdict.met, verdict.sentence


def test_the_time_of_every_job_is_accounted_for(robot: Robot, driven: Recording) -> None:
    """Execution, interference, blocking, handlers and kernel make up each response time."""
    for task in task_dynamics(robot, driven):
        parts = (
            task.execution_cycles
            + task.interference_cycles
            + task.blocking_cycles
            + task.interrupt_cycles
        )
        kernel = task.response_time_cycles - parts
        assert np.all(kernel >= 0)
        assert np.all(kernel <= 0.5 * task.response_time_cycles + 500), task.name
    timer = {handler.name: handler for handler in handler_dynamics(driven)}["TC0"]
    assert timer.duration_cycles.size > 900


def test_the_lanes_of_an_export_fill_the_run(driven: Recording) -> None:
    """Each cycle belongs to one lane."""
    lanes = timeline_of(driven).lanes
    total = sum(int((lane.end_cycles - lane.begin_cycles).sum()) for lane in lanes)
    assert total == driven.stop.at_cycles
    assert next(lane.name for lane in lanes if lane.kind == "task") == "coprocessor_task"
    assert {"PIOA", "SPI", "TWI", "TC0"} == {
        lane.name for lane in lanes if lane.kind == "interrupt"
    }
