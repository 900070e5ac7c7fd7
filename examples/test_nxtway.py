# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The balancing robot on the run-time, with the gains that are published for NXTway-GS."""

from __future__ import annotations

import re
import struct
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Input, Scenario, read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.measures import evaluate_criteria, measure_run
from ravenbrick.trace.recording import Recording

BALANCER = Path(__file__).resolve().parent / "balancer"
# Y. Yamamoto, NXTway-GS Model-Based Design (2008): on wheel angle, pitch, their rates (the wheel's
# with the factor 0.85) and the integral of the wheel angle.
PUBLISHED = (0.83508, 34.18958, 1.09951, 2.81409, 0.44721)
LONG = pytest.mark.long("a minute on the brick")


@pytest.fixture(scope="module")
def image() -> ElfImage:
    """Built from the generated C."""
    return build_image(Workspace.of(BALANCER), read_robot(BALANCER), "ram").image


def stand() -> tuple[Robot, Scenario]:
    """A minute with five pushes."""
    robot = read_robot(BALANCER)
    return robot, read_scenario(scenario_path(BALANCER, "stand"), robot)


def played(image: ElfImage, scenario: Scenario) -> tuple[Recording, dict[str, bool]]:
    """The run, and which criteria it meets."""
    robot = read_robot(BALANCER)
    recording = VirtualTarget().run(robot, scenario, image)
    results = evaluate_criteria(scenario, measure_run(robot, scenario, recording))
    return recording, {result.label: result.met for result in results}


def test_the_program_on_the_brick_has_the_published_gains(image: ElfImage) -> None:
    """Read from the memory of the running program, in single precision."""
    robot, scenario = stand()
    brick: Any = VirtualTarget().prepare(robot, scenario, image)
    brick.run_until(4_800_000)
    place = image.symbols["functional_P"]
    saturation, *gains = struct.unpack("<6f", brick.read_memory(place.address, place.size))
    assert saturation == robot.battery.voltage.value
    assert gains == [float(np.float32(value)) for value in PUBLISHED]


@LONG
def test_it_stands_for_a_minute_under_pushes(image: ElfImage) -> None:
    """It is let go at 2 s; five pushes follow. Its pitch and path are those of its README."""
    _, scenario = stand()
    assert scenario.duration_ms - 2_000 == 60_000
    pushes = [i for i in scenario.inputs if i.name == "body.push" and i.value]
    assert {push.value for push in pushes} == {1.0, -1.0} and len(pushes) == 5
    recording, met = played(image, scenario)
    assert met and all(met.values())
    limits = re.search(
        r"pitch stays within (\d+) degrees and the path\s+within (\d+) cm",
        (BALANCER / "README.md").read_text(),
    )
    assert limits is not None
    for name, limit in (("pitch", np.radians(int(limits[1]))), ("x", int(limits[2]) / 100)):
        largest = np.max(np.abs(recording.signal(f"body.{name}")[1]))
        assert 0.5 * limit < largest < limit, name


@LONG
def test_a_push_that_is_too_strong_throws_it_over(image: ElfImage) -> None:
    """Eight times the force: the criteria can be missed."""
    _, scenario = stand()

    def stronger(given: Input) -> Input:
        return replace(given, value=8 * given.value) if given.name == "body.push" else given

    inputs = tuple(stronger(given) for given in scenario.inputs)
    _, met = played(image, replace(scenario, inputs=inputs))
    assert not met['lcd shows "balancing" at the end']
