# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from PIL import Image

from ravenbrick.brick.configuration import brick_configuration
from ravenbrick.catalogue import SensorKind, part_values, parts, sensor_kinds
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ProjectFileError
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import input_check, read_scenario, scenario_path
from ravenbrick.schemas import schema

Edit = Callable[[str, str, str], int]

BODY = 'left = "B"'


def quantity(name: str, value: str, unit: str) -> str:
    """A line of robot.toml."""
    return f'{name} = {{ value = {value}, unit = "{unit}", tolerance = 0.1, source = "test" }}\n'


BROKEN = [
    (BODY, quantity("mass", '"heavy"', "kg") + BODY, "body.mass.value", "expected a number"),
    (BODY, quantity("mass", "0.6", "g") + BODY, "body.mass.unit", "expected 'kg'"),
    (BODY, quantity("mass", "-0.6", "kg") + BODY, "body.mass.value", "expected more than 0"),
    ("castor_vehicle", "hovercraft", "body.catalogue", "among its bodies; it has 'castor_vehicle'"),
    (
        "schema_version = 1",
        "motors.old.mass = 1\nschema_version = 1",
        "motors.old.mass",
        "unknown field",
    ),
    ("period_us = 4_000", "period_us = 4.5", "tasks[1].period_us", "expected a whole number"),
    ("period_us = 4_000", "period_ms = 4", "tasks[1].period_ms", "did you mean 'period_us'?"),
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
    ('name = "display_task"', 'name = "Control_Task"', "tasks[2].name", "is defined twice"),
    ("schema_version = 1", "schema_version = 2", "schema_version", "expected 1"),
    (
        "schema_version = 1",
        'profile = "full"\nschema_version = 1',
        "profile",
        "expected one of 'ravenscar', 'jorvik'",
    ),
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


def test_a_wheel_without_a_motor_is_named(project: Path, edit: Edit) -> None:
    """The body's field is the wrong one, whichever the side."""
    edit("robot.toml", '[ports.C]\ndevice = "motor"\nmotor = "nxt"', '[ports.2]\ndevice = "touch"')
    line = edit("robot.toml", 'right = "C"', 'right = "C" ')
    with pytest.raises(ProjectFileError, match="nothing is plugged into port C") as caught:
        read_robot(project)
    assert (caught.value.field, caught.value.line) == ("body.right", line)


def test_a_missing_field_is_named_at_its_table(project: Path, edit: Edit) -> None:
    """What is not there is reported at the table where it belongs."""
    line = edit("robot.toml", '[battery]\ncatalogue = "li_ion"', "[battery]")
    with pytest.raises(
        ProjectFileError, match=r"battery\.internal_resistance: is missing"
    ) as caught:
        read_robot(project)
    assert caught.value.line == line


def test_further_errors_are_listed_in_the_detail(project: Path, edit: Edit) -> None:
    """The first error is the sentence, the others follow."""
    edit("robot.toml", BODY, quantity("mass", "0.6", "g") + BODY)
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


@pytest.mark.parametrize(
    ("group", "kind"), [("motors", "motor"), ("bodies", "body"), ("batteries", "battery")]
)
def test_every_part_of_the_catalogue_is_one_of_robot_toml(group: str, kind: str) -> None:
    """Fields, units and ranges are those of the schema; only the wheels' ports are missing."""
    published = schema("robot")
    rule = published["$defs"].get(kind, published["properties"].get(kind))
    ports = {"left": "B", "right": "C"} if kind == "body" else {}
    for entry in parts(group).values():
        jsonschema.validate({**entry, **ports}, {"$defs": published["$defs"], **rule})


def test_a_value_of_the_catalogue_can_be_replaced(project: Path, edit: Edit) -> None:
    """A motor and a body differ from their entries in one constant each."""
    edit("robot.toml", BODY, quantity("mass", "0.7", "kg") + BODY)
    worn = quantity("resistance", "7.5", "ohm")
    edit("robot.toml", "[battery]", f'[motors.worn]\ncatalogue = "nxt"\n{worn}\n[battery]')
    edit("robot.toml", 'motor = "nxt"\nrole = "left', 'motor = "worn"\nrole = "left')
    robot = read_robot(project)
    assert robot.body.quantities["mass"].value == 0.7
    usual, changed = robot.motors["nxt"], robot.motors["worn"]
    assert {name for name in usual if usual[name] != changed[name]} == {"resistance"}


def test_a_robot_may_write_all_its_constants_down(project: Path, robot: Robot, edit: Edit) -> None:
    """A file that names no entry of the catalogue is read as before there was one."""
    for place, group, name in (
        ('catalogue = "castor_vehicle"', "bodies", "castor_vehicle"),
        ('catalogue = "li_ion"', "batteries", "li_ion"),
        ("[body]", "motors", "nxt"),
    ):
        lines = [
            f"{key} = {json.dumps(value)}"
            if isinstance(value, str)
            else f"{key} = {{ {', '.join(f'{k} = {json.dumps(v)}' for k, v in value.items())} }}"
            for key, value in parts(group)[name].items()
        ]
        text = "\n".join(lines)
        edit("robot.toml", place, f"[motors.nxt]\n{text}\n[body]" if place == "[body]" else text)
    written = read_robot(project)
    assert (written.motors, written.body, written.battery) == (
        robot.motors,
        robot.body,
        robot.battery,
    )


def test_the_configuration_of_the_brick_has_the_scenarios_deviations(
    project: Path, robot: Robot
) -> None:
    """Only the motor that deviates differs; a bench has no body."""
    drive = read_scenario(scenario_path(project, "drive"), robot)
    made = brick_configuration(robot, drive, MASTER_CLOCK)
    left, right = (made["motors"][port]["parameters"] for port in "BC")
    assert left["torque_constant"] == part_values("motors", "nxt")["torque_constant"]
    assert right["torque_constant"] == pytest.approx(0.92 * left["torque_constant"])
    assert right["coulomb_friction"] == pytest.approx(1.5 * left["coulomb_friction"])
    assert right["inertia"] == left["inertia"]
    assert made["body"]["left"] == "B"
    assert made["motors"]["A"]["held_by_hand"] is True
    assert made["signal_period_cycles"] == 48_055
    step = read_scenario(scenario_path(project, "step"), robot)
    assert brick_configuration(robot, step, MASTER_CLOCK)["body"] == {"kind": "bench"}


SENSORS = '[ports.1]\ndevice = "touch"'
WRONG_SENSORS = [
    ('device = "gyro"\nmount = { x = 0.1, y = 0.0 }', "ports.1.mount", "is for light and"),
    ('device = "light"\naxis = "yaw"', "ports.1.axis", "is for gyro only, not for light"),
    ('device = "light"\nmount = { x = 0.1, y = 0.0 }', "ports.1.mount", "add [floor]"),
    ('device = "ultrasonic"\nmount = { x = 0.1, y = 0.0 }', "ports.1.mount", "add [walls]"),
    ('device = "light"\nmount = { x = 3.0, y = 0.0 }', "ports.1.mount.x", "expected at most 1"),
]


@pytest.mark.parametrize(("new", "field", "problem"), WRONG_SENSORS)
def test_a_sensor_that_cannot_measure_is_named(
    project: Path, edit: Edit, new: str, field: str, problem: str
) -> None:
    """Where it sits, what it looks at and what it turns with must fit together."""
    edit("robot.toml", SENSORS, f"[ports.1]\n{new}")
    with pytest.raises(ProjectFileError) as caught:
        read_robot(project)
    assert caught.value.field == field
    assert problem in caught.value.sentence


@pytest.mark.parametrize(
    ("pixels", "reflectance"),
    [
        (np.array([[0, 255], [20, 0]], np.uint8), [0, 255, 20, 0]),
        (np.array([[0, 65535], [20 * 257, 257]], np.uint16), [0, 255, 20, 1]),
        (
            np.array([[[9, 9, 9], [255, 255, 255]], [[0, 20, 40], [0, 0, 0]]], np.uint8),
            [9, 255, 20, 0],
        ),
        (np.array([[[9, 9, 9, 0], [1, 1, 1, 9]]] * 2, np.uint8), [9, 1, 9, 1]),
    ],
    ids=["grey", "grey of 16 bits", "colours", "transparent"],
)
def test_floor_walls_and_mounts_reach_the_brick(
    project: Path, edit: Edit, pixels: np.ndarray, reflectance: list[int]
) -> None:
    """The picture becomes reflectances in 1/255, row by row from the top; colours, their mean."""
    Image.fromarray(pixels).save(project / "floor.png")
    sensor = 'device = "light"\nmount = { x = 0.1, y = 0.02 }'
    edit("robot.toml", SENSORS, f"[ports.1]\n{sensor}")
    pixel = '{ value = 0.01, unit = "m", tolerance = 0.0, source = "test" }'
    with (project / "robot.toml").open("a") as file:
        file.write(f'[floor]\nimage = "floor.png"\npixel = {pixel}\ncorner = [-1.0, 2]\n')
        file.write("[[walls]]\nfrom = [0, 1]\nto = [2, 1]\n")
    robot = read_robot(project)
    scenario = (project / "scenarios" / "step.toml").read_text()
    (project / "scenarios" / "step.toml").write_text(scenario.split("[[inputs]]")[0])
    read = read_scenario(scenario_path(project, "step"), robot)
    configuration = brick_configuration(robot, read, MASTER_CLOCK)
    assert configuration["surroundings"] == {
        "floor": {
            "pixel": 0.01,
            "corner": [-1.0, 2],
            "width": 2,
            "reflectance": reflectance,
            "outside": 1.0,
        },
        "walls": [{"from": [0, 1], "to": [2, 1]}],
    }
    mount = {"x": 0.1, "y": 0.02, "direction": 0.0}
    assert configuration["sensors"]["1"] == {"kind": "light", "mount": mount}


KINDS = schema("robot")["properties"]["battery"]["properties"]["kind"]["enum"]


@pytest.mark.parametrize("kind", KINDS)
def test_the_brick_takes_every_kind_of_battery(project: Path, edit: Edit, kind: str) -> None:
    """What the schema allows, the virtual brick has."""
    module = pytest.importorskip("virtual_brick")
    edit("robot.toml", 'catalogue = "li_ion"', f'catalogue = "li_ion"\nkind = "{kind}"')
    robot = read_robot(project)
    scenario = read_scenario(scenario_path(project, "drive"), robot)
    configuration = json.dumps(brick_configuration(robot, scenario, MASTER_CLOCK))
    with pytest.raises(module.ImageError):
        module.VirtualBrick(configuration, b"no image")


@pytest.mark.parametrize("kind", sensor_kinds().values(), ids=lambda kind: kind.name)
def test_a_sensor_of_the_catalogue_is_known_everywhere(
    project: Path, edit: Edit, kind: SensorKind
) -> None:
    """Its fields are in the schema, its inputs in scenarios, and the virtual brick has it."""
    module = pytest.importorskip("virtual_brick")
    assert set(kind.fields) <= set(schema("robot")["$defs"]["sensor_port"]["properties"])
    edit("robot.toml", SENSORS, f'[ports.1]\ndevice = "{kind.name}"')
    robot = read_robot(project)
    check = input_check(robot)
    for one in kind.inputs:
        assert check(one.name.replace("{port}", "1")) is None
        problem = str(check(one.name.replace("{port}", "2")))
        assert f"no {kind.name} sensor on sensor port 2" in problem
    path = project / "scenarios" / "step.toml"
    path.write_text(path.read_text().split("[[inputs]]")[0])
    scenario = read_scenario(scenario_path(project, "step"), robot)
    configuration = brick_configuration(robot, scenario, MASTER_CLOCK)
    assert configuration["sensors"]["1"] == {"kind": kind.name}
    with pytest.raises(module.ImageError):
        module.VirtualBrick(json.dumps(configuration), b"")
