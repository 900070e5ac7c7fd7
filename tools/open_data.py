# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The open data of the virtual brick, made again: `python -m tools.open_data [FOLDER]`.

Without a folder the records of `data/virtual` are written. With `--count` more motors and timings
are drawn; the numbers are the seeds, so a larger set contains the smaller one.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.control.estimation.identification import MotorData
from ravenbrick.grading.sweep import draw
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ElfImage
from ravenbrick.open_data.data_record import write_data_record
from ravenbrick.open_data.making import SELF_TEST, Origin, of_motor, of_self_test
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace, tree
from ravenbrick.self_test.comparison import NOMINAL_VOLTS, equipment
from ravenbrick.self_test.parameters import PARAMETERS
from ravenbrick.self_test.taking import from_virtual_brick
from ravenbrick.trace.motor_data import motor_data
from ravenbrick.trace.recording import Recording

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "data" / "virtual"
BY, ON = "Ravenbrick, tools/open_data.py", "2026-11-26"
COMMITTED = 2
MOTOR = "B"
# Project, scenario and window (s) in which the motor is looked at.
STEP = ("motor-bench", "step", (0.9, 3.0))
EXPERIMENTS = (
    ("vehicle", "experiments/identify.toml", "identification"),
    ("vehicle", "experiments/identify-check.toml", "identification-check"),
)
ALTERED_PARAMETERS = 3


def _built(name: str) -> tuple[Robot, ElfImage]:
    project = tree() / "examples" / name
    robot = read_robot(project)
    return robot, build_image(Workspace.of(project), robot, "ram").image


def _origin(image: ElfImage, program: str, what: str, number: int, altered: Any) -> Origin:
    drawn = f"constants drawn with seed {number}" if number else "constants of the catalogue"
    origin = Origin(f"{what}; virtual brick, {drawn}", "virtual", program, image, "li_ion", BY, ON)
    return replace(origin, altered=altered, seed=number) if number else origin


def _recorded(
    robot: Robot, image: ElfImage, name: str, number: int
) -> tuple[Recording, dict[str, float]]:
    """A run; motor constants within their tolerances, those of the catalogue for number 0."""
    scenario = read_scenario(scenario_path(robot.document.path.parent, name), robot)
    if number:
        scenario = replace(scenario, deviations=draw(robot, scenario, number), seed=number)
    else:
        scenario = replace(scenario, deviations={})
    return VirtualTarget().run(robot, scenario, image), dict(scenario.deviations.get(MOTOR, {}))


def _step_responses(count: int) -> Iterator[tuple[str, dict[str, Any]]]:
    project, name, window = STEP
    robot, image = _built(project)
    for number in range(count):
        recording, altered = _recorded(robot, image, name, number)
        origin = _origin(image, project, "speed controller, step of the set-point", number, altered)
        voltage = recording.signal(f"motor.{MOTOR}.voltage")
        angle = recording.signal(f"motor.{MOTOR}.encoder")
        columns = voltage, angle, window, MOTOR, NOMINAL_VOLTS
        yield f"step-{number:04}", of_motor("step_response", *columns, origin)


def _identification(count: int) -> Iterator[tuple[str, dict[str, Any]]]:
    for project, name, title in EXPERIMENTS:
        robot, image = _built(project)
        for number in range(count):
            recording, altered = _recorded(robot, image, name, number)
            data: MotorData = motor_data(recording, MOTOR)
            origin = _origin(image, project, "open loop, wheels off the floor", number, altered)
            voltage = np.append(0.0, data.change), np.append(0.0, data.voltage)
            window = float(data.change[0]) - 0.1, float(data.time[-1])
            columns = voltage, (data.time, data.count), window, MOTOR, NOMINAL_VOLTS
            yield f"{title}-{number:04}", of_motor("identification", *columns, origin)


def _drawn_timing(number: int) -> dict[str, Any]:
    """Other values of three timing parameters; none for number 0."""
    chosen = random.Random(f"timing {number}")
    listed = [p for p in PARAMETERS if p.values]
    parameters = chosen.sample(listed, ALTERED_PARAMETERS) if number else []
    return {
        p.name: chosen.choice([value for value in p.values if value != p.nominal])
        for p in parameters
    }


def _timing(count: int) -> Iterator[tuple[str, dict[str, Any]]]:
    _, image = _built(SELF_TEST)
    for number in range(count):
        timing = _drawn_timing(number)
        record = from_virtual_brick(image, {**equipment(), "timing": timing})
        origin = _origin(image, SELF_TEST, "self-test", number, timing)
        yield f"timing-{number:04}", of_self_test(record, origin)


def write_data(folder: Path, count: int) -> list[Path]:
    """Write this many records of each kind; the files."""
    files = []
    for kind in (_step_responses, _identification, _timing):
        for name, values in kind(count):
            file = folder / f"{name}.json"
            write_data_record(file, values)
            print(file, flush=True)
            files.append(file)
    return files


def main() -> int:
    """Write the records."""
    parser = argparse.ArgumentParser(description="Make the open data of the virtual brick again.")
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER, help="where they go")
    parser.add_argument("--count", type=int, default=COMMITTED, help="records of each kind")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    write_data(arguments.folder, arguments.count)
    return 0


if __name__ == "__main__":
    sys.exit(main())
