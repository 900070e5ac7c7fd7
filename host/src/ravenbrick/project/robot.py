# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What `robot.toml` says, typed, and how it is read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ravenbrick.catalogue import parts, sensor_kinds
from ravenbrick.project.named_parts import with_named_parts
from ravenbrick.schemas.located_toml import LocatedToml, read_toml
from ravenbrick.schemas.validation import validate

__all__ = [
    "ROBOT_FILE",
    "Battery",
    "Floor",
    "Quantity",
    "Robot",
    "SensorPort",
    "Task",
    "Wall",
    "read_robot",
    "tasks_of",
]

ROBOT_FILE = "robot.toml"


@dataclass(frozen=True)
class Quantity:
    """A physical constant; `tolerance` is the half width in the same unit."""

    value: float
    unit: str
    tolerance: float
    source: str

    def allows(self, value: float) -> bool:
        """Whether `value` lies within the tolerance (one part in 10^9 for rounding)."""
        slack = 1e-9 * max(abs(self.value), 1.0)
        return abs(value - self.value) <= self.tolerance + slack


@dataclass(frozen=True)
class MotorPort:
    """A motor on port A, B or C; `motor` names its parameter set."""

    motor: str
    role: str
    held_by_hand: bool
    hand_rate: Quantity | None


@dataclass(frozen=True)
class Mount:
    """Where a sensor sits: m forwards from and to the left of the axle's middle, rad."""

    x: float
    y: float
    direction: float


@dataclass(frozen=True)
class SensorPort:
    """A sensor on port 1 to 4; `axis` and `rest` (counts) are of a gyro."""

    device: str
    role: str
    mount: Mount | None = None
    axis: Literal["pitch", "yaw"] | None = None
    rest: Quantity | None = None

    @property
    def measures_plant(self) -> bool:
        """Whether the plant and its surroundings give the value instead of an input."""
        return self.mount is not None or self.axis is not None


@dataclass(frozen=True)
class Floor:
    """A picture on the floor; `corner` (m) is its lower left one, `outside` a reflectance."""

    image: Path
    pixel: Quantity
    corner: tuple[float, float]
    outside: float


@dataclass(frozen=True)
class Wall:
    """A straight wall between two points; m."""

    begin: tuple[float, float]
    end: tuple[float, float]


@dataclass(frozen=True)
class Body:
    """A bench, a vehicle with two driven wheels and a castor, or one that balances on them."""

    kind: Literal["bench", "differential_drive", "balancer"]
    left: str | None
    right: str | None
    quantities: Mapping[str, Quantity]


@dataclass(frozen=True)
class Battery:
    """Kind of cells, open-circuit voltage and internal resistance."""

    kind: str
    voltage: Quantity
    internal_resistance: Quantity


@dataclass(frozen=True)
class Task:
    """One task of the application; times in microseconds."""

    name: str
    description: str
    release: Literal["cyclic", "sporadic", "background"]
    period_us: int | None
    deadline_us: int | None
    priority: int
    stack_bytes: int


@dataclass(frozen=True)
class SetBy:
    """The variable that a program takes a set-point from, its first value and its range."""

    variable: str
    value: float
    lowest: float
    highest: float


@dataclass(frozen=True)
class Setpoint:
    """The variable with a motor's speed set-point; value times `scale` is in `scale.unit`."""

    port: str
    symbol: str
    type: str
    scale: Quantity
    set_by: SetBy | None = None

    @property
    def factor(self) -> float:
        """What turns a value into rad/s."""
        return math.radians(self.scale.value) if "deg" in self.scale.unit else self.scale.value


@dataclass(frozen=True)
class Robot:
    """A whole robot; `document` gives the lines for later errors."""

    document: LocatedToml
    name: str
    description: str
    motor_ports: Mapping[str, MotorPort]
    sensor_ports: Mapping[str, SensorPort]
    motors: Mapping[str, Mapping[str, Quantity]]
    body: Body
    battery: Battery
    tasks: tuple[Task, ...]
    setpoints: tuple[Setpoint, ...]
    floor: Floor | None = None
    walls: tuple[Wall, ...] = ()
    profile: Literal["ravenscar", "jorvik"] = "ravenscar"
    execution_time: bool = False
    stack_check: bool = True
    watchdog: bool = True
    motor_timeout_ms: int = 0
    code: Literal["arm", "thumb"] = "arm"

    @property
    def directory(self) -> Path:
        """The folder of `robot.toml`."""
        return self.document.path.parent

    def task(self, name: str) -> Task | None:
        """The task with this name in whatever letter case."""
        return next((task for task in self.tasks if task.name.lower() == name.lower()), None)

    def period_ms(self, task: str) -> int:
        """Period of a task; raises `ProjectFileError` when it has none in whole milliseconds."""
        found = self.task(task)
        if found is None or found.period_us is None or found.period_us % 1000:
            problem = f"a design wants the task '{task}' with a period in whole milliseconds"
            raise self.document.error(("tasks",), problem)
        return found.period_us // 1000

    def motor_values(self, port: str) -> dict[str, float]:
        """Constants of the motor on a port, by name in SI units."""
        motor = self.motors[self.motor_ports[port].motor]
        return {name: quantity.value for name, quantity in motor.items()}

    def degrees_per_volt(self) -> float:
        """Speed that a volt of the set-points stands for, (deg/s)/V; raises `ProjectFileError`."""
        for setpoint in self.setpoints:
            if setpoint.scale.unit == "deg/s/V":
                return setpoint.scale.value
            if setpoint.scale.unit == "rad/s/V":
                return math.degrees(setpoint.scale.value)
        problem = 'a design wants a scale in "deg/s/V"; add it to a [[setpoints]]'
        raise self.document.error(("setpoints",), problem)


def _quantity(table: Mapping[str, Any]) -> Quantity:
    return Quantity(
        float(table["value"]), table["unit"], float(table["tolerance"]), table["source"]
    )


def _quantities(table: Mapping[str, Any]) -> dict[str, Quantity]:
    return {name: _quantity(value) for name, value in table.items() if isinstance(value, dict)}


def _motor_port(table: Mapping[str, Any]) -> MotorPort:
    rate = table.get("hand_rate")
    return MotorPort(
        table["motor"], table["role"], table.get("held_by_hand", False), rate and _quantity(rate)
    )


def _sensor_port(table: Mapping[str, Any]) -> SensorPort:
    mount, rest = table.get("mount"), table.get("rest")
    return SensorPort(
        table["device"],
        table["role"],
        mount and Mount(mount["x"], mount["y"], mount.get("direction", 0.0)),
        table.get("axis"),
        rest and _quantity(rest),
    )


def _floor(directory: Path, table: Mapping[str, Any]) -> Floor:
    x, y = table["corner"]
    image = directory / table["image"]
    return Floor(image, _quantity(table["pixel"]), (x, y), table.get("outside", 1.0))


def _wall(table: Mapping[str, Any]) -> Wall:
    return Wall((table["from"][0], table["from"][1]), (table["to"][0], table["to"][1]))


def _body(table: Mapping[str, Any]) -> Body:
    return Body(table["kind"], table.get("left"), table.get("right"), _quantities(table))


def tasks_of(document: LocatedToml) -> tuple[Task, ...]:
    """The tasks of a validated file; raises `ProjectFileError` for one that is defined twice."""
    seen: set[str] = set()
    for index, task in enumerate(document.values["tasks"]):
        if task["name"].lower() in seen:
            raise document.error(
                ("tasks", index, "name"), f"the task '{task['name']}' is defined twice; remove one"
            )
        seen.add(task["name"].lower())
    return tuple(
        Task(
            name=table["name"],
            description=table.get("description", ""),
            release=table["release"],
            period_us=table.get("period_us"),
            deadline_us=table.get("deadline_us"),
            priority=table["priority"],
            stack_bytes=table["stack_bytes"],
        )
        for table in document.values["tasks"]
    )


def _setpoint(table: Mapping[str, Any]) -> Setpoint:
    by = table.get("set_by")
    scale = _quantity(table["scale"])
    return Setpoint(table["port"], table["symbol"], table["type"], scale, by and SetBy(**by))


def _check_motor_names(document: LocatedToml) -> None:
    motors = document.values["motors"]
    for port, table in document.values["ports"].items():
        if "motor" in table and table["motor"] not in motors:
            known = ", ".join(f"'{name}'" for name in dict.fromkeys([*motors, *parts("motors")]))
            raise document.error(
                ("ports", port, "motor"),
                f"there is no [motors.{table['motor']}] here or in the catalogue; known: {known}",
            )


def _check_wheels(document: LocatedToml) -> None:
    body, ports = document.values["body"], document.values["ports"]
    for side in ("left", "right"):
        if side in body and body[side] not in ports:
            raise document.error(
                ("body", side),
                f"nothing is plugged into port {body[side]}; add [ports.{body[side]}]",
            )
    if "left" in body and body["left"] == body.get("right"):
        raise document.error(("body", "right"), "is the port of the left wheel; name another port")


def _check_setpoints(document: LocatedToml) -> None:
    for index, setpoint in enumerate(document.values.get("setpoints", [])):
        if setpoint["port"] not in document.values["ports"]:
            raise document.error(
                ("setpoints", index, "port"),
                f"nothing is plugged into port {setpoint['port']}; add [ports.{setpoint['port']}]",
            )
        by = setpoint.get("set_by")
        if by and not by["lowest"] <= by["value"] <= by["highest"]:
            raise document.error(
                ("setpoints", index, "set_by", "value"),
                f"is {by['value']:g}; expected a value from lowest to highest",
            )


def _check_sensors(document: LocatedToml) -> None:
    kinds = sensor_kinds()
    for port, table in document.values["ports"].items():
        kind = kinds.get(table["device"])
        for field in table:
            having = " and ".join(name for name, known in kinds.items() if field in known.fields)
            if having and (kind is None or field not in kind.fields):
                raise document.error(
                    ("ports", port, field),
                    f"is for {having} only, not for {table['device']}; remove it",
                )
        if kind and "mount" in table and kind.looks_at not in document.values:
            raise document.error(
                ("ports", port, "mount"), f"has nothing to look at; add [{kind.looks_at}]"
            )
    image = document.values.get("floor", {}).get("image")
    if image and not (document.path.parent / image).is_file():
        raise document.error(("floor", "image"), f"there is no file '{image}'; correct its name")


def read_robot(directory: Path) -> Robot:
    """Read `robot.toml` of a project folder; raises `ProjectFileError`."""
    document = read_toml(
        directory / ROBOT_FILE, missing=f"'{directory}' must be a project folder with robot.toml"
    )
    document = with_named_parts(document)
    validate(document, "robot")
    checks = (_check_motor_names, _check_wheels, _check_setpoints, _check_sensors)
    for check in checks:
        check(document)
    values = document.values
    ports = values["ports"]
    battery = values["battery"]
    return Robot(
        document=document,
        name=values["name"],
        description=values.get("description", ""),
        motor_ports={p: _motor_port(ports[p]) for p in sorted(ports) if p in "ABC"},
        sensor_ports={p: _sensor_port(ports[p]) for p in sorted(ports) if p in "1234"},
        motors={name: _quantities(table) for name, table in values["motors"].items()},
        body=_body(values["body"]),
        battery=Battery(
            battery["kind"],
            _quantity(battery["voltage"]),
            _quantity(battery["internal_resistance"]),
        ),
        tasks=tasks_of(document),
        setpoints=tuple(_setpoint(table) for table in values.get("setpoints", [])),
        floor=_floor(document.path.parent, values["floor"]) if "floor" in values else None,
        walls=tuple(_wall(table) for table in values.get("walls", [])),
        profile=values.get("profile", "ravenscar"),
        execution_time=values.get("execution_time", False),
        stack_check=values.get("stack_check", True),
        watchdog=values.get("watchdog", True),
        motor_timeout_ms=values.get("motor_timeout_ms", 0),
        code=values.get("code", "arm"),
    )
