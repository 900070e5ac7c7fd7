# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import jsonschema
import pytest

from ravenbrick.errors import ProjectFileError
from ravenbrick.schemas import schema
from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.configuration import brick_configuration
from ravenbrick.target.robot import Robot, read_robot
from ravenbrick.target.scenario import read_scenario, scenario_path

Edit = Callable[[str, str, str], int]

BROKEN = [
    (
        "resistance = { value = 6.8562",
        'resistance = { value = "six"',
        "motors.nxt.resistance.value",
        "expected a number",
    ),
    ('unit = "ohm"', 'unit = "kohm"', "motors.nxt.resistance.unit", "expected 'ohm'"),
    ("period_us = 4_000", "period_us = 4.5", "tasks[1].period_us", "expected a whole number"),
    ("period_us = 4_000", "period_ms = 4", "tasks[1].period_ms", "did you mean 'period_us'?"),
    ("mass = { value = 0.6", "mass = { value = -0.6", "body.mass.value", "expected more than 0"),
    ("[ports.1]", "[ports.D]", "ports.D", "unknown port 'D'"),
    ('device = "touch"', 'device = "radar"', "ports.1.device", "expected one of 'touch'"),
    ('left = "B"', 'left = "D"', "body.left", "expected one of 'A', 'B', 'C'"),
    ('right = "C"', 'right = "B"', "body.right", "is the port of the left wheel"),
    (
        'motor = "nxt"\nrole = "left',
        'motor = "ev3"\nrole = "left',
        "ports.B.motor",
        "there is no [motors.ev3]",
    ),
    ('name = "display_task"', 'name = "Control_Task"', "tasks[2].name", "is there twice"),
    ("schema_version = 1", "schema_version = 2", "schema_version", "expected 1"),
]


@pytest.mark.parametrize(("old", "new", "field", "problem"), BROKEN, ids=lambda v: str(v)[:30])
def test_a_wrong_field_is_named_with_its_line(
    project: Path, edit: Edit, old: str, new: str, field: str, problem: str
) -> None:
    """The error gives file, line, field and what was expected."""
    line = edit("robot.toml", old, new)
    with pytest.raises(ProjectFileError) as caught:
        read_robot(project)
    assert caught.value.field == field
    assert caught.value.line == line
    assert problem in caught.value.sentence
    assert f"robot.toml:{line}: {field}: " in caught.value.sentence


def test_a_missing_field_is_named_at_its_table(project: Path, edit: Edit) -> None:
    """What is not there is reported at the table where it belongs."""
    line = edit("robot.toml", 'kind = "li_ion"\n', "")
    with pytest.raises(ProjectFileError, match=r"battery\.kind: is missing; add it") as caught:
        read_robot(project)
    assert caught.value.line == line - 1


def test_further_errors_are_listed_in_the_detail(project: Path, edit: Edit) -> None:
    """The first error is the sentence, the others follow."""
    edit("robot.toml", 'unit = "kg"', 'unit = "g"')
    edit("robot.toml", "priority = 30", "priority = 300")
    with pytest.raises(ProjectFileError, match=r"body\.mass\.unit") as caught:
        read_robot(project)
    assert "tasks[0].priority: is 300; expected at most 255" in caught.value.detail


def test_a_folder_without_robot_toml_is_refused(tmp_path: Path) -> None:
    """The error says what kind of folder is expected."""
    with pytest.raises(ProjectFileError, match="must be a project folder"):
        read_robot(tmp_path)


@pytest.mark.parametrize("name", ["robot", "scenario"])
def test_the_published_schemas_are_valid_schemas(name: str) -> None:
    """Anyone can use the schemas with their own tools."""
    jsonschema.Draft202012Validator.check_schema(schema(name))


def test_every_constant_of_the_vehicle_has_a_source(robot: Robot) -> None:
    """Value, unit, tolerance and source are all there."""
    quantities = [q for motor in robot.motors.values() for q in motor.values()]
    quantities += list(robot.body.quantities.values())
    assert len(quantities) == 14
    assert all(len(q.source) > 5 and q.unit for q in quantities)


def test_the_configuration_of_the_brick_has_the_scenarios_deviations(
    project: Path, robot: Robot
) -> None:
    """Only the motor that deviates differs; a bench has no body."""
    drive = read_scenario(scenario_path(project, "drive"), robot)
    made = brick_configuration(robot, drive, MASTER_CLOCK)
    left, right = (made["motors"][port]["parameters"] for port in "BC")
    assert left["torque_constant"] == 0.31739
    assert right["torque_constant"] == pytest.approx(0.92 * 0.31739)
    assert right["coulomb_friction"] == pytest.approx(1.5 * left["coulomb_friction"])
    assert right["inertia"] == left["inertia"]
    assert made["body"]["left"] == "B"
    assert made["motors"]["A"]["held_by_hand"] is True
    assert made["signal_period_cycles"] == 48_055
    step = read_scenario(scenario_path(project, "step"), robot)
    assert brick_configuration(robot, step, MASTER_CLOCK)["body"] == {"kind": "bench"}
