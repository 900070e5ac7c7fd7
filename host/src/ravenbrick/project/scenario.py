# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One run of a robot, typed, and how it is read and checked against the robot."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.catalogue import SensorInput, SensorKind, sensor_input, sensor_kinds
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ScenarioError
from ravenbrick.project.criteria import Expectation, ExpectationSyntaxError, parse_expectation
from ravenbrick.project.named_files import named_file
from ravenbrick.project.questions import Question, read_questions
from ravenbrick.project.robot import Robot
from ravenbrick.project.stimuli import Channels, InputCheck, TimedInput, read_stimulus
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml, dotted, read_toml
from ravenbrick.schemas.validation import validate

__all__ = [
    "Criterion",
    "Input",
    "MonitorWindow",
    "Peer",
    "Scenario",
    "check_expectations",
    "check_stimuli",
    "input_check",
    "read_scenario",
    "scenario_path",
]

BUTTONS = ("left", "right", "orange", "grey")


@dataclass(frozen=True)
class Input:
    """An input of the brick's surroundings; `index` is its place in the file's [[inputs]]."""

    at_ms: int
    name: str
    value: float
    note: str
    index: int


@dataclass(frozen=True)
class StraightDrive:
    """From where on, and over which path length (m), the vehicle drives straight."""

    from_ms: int
    distance: float


@dataclass(frozen=True)
class StepWindow:
    """The window in which the set-point steps, and the motors to measure."""

    from_ms: int
    until_ms: int
    motors: tuple[str, ...]


@dataclass(frozen=True)
class Criterion:
    """A bound on a measure; `index` is its place in the file's [[criteria]]."""

    measure: str
    minimum: float | None
    maximum: float | None
    index: int


@dataclass(frozen=True)
class Peer:
    """A second brick in range: its project, and the name of its scenario."""

    project: Path
    scenario: str


@dataclass(frozen=True)
class MonitorWindow:
    """When a computer in range listens to the telemetry over Bluetooth, and its PIN; to the end
    without `until_ms`. `chatter` is what it says besides: when, in milliseconds, and bytes."""

    pin: str
    from_ms: int
    until_ms: int | None
    chatter: tuple[tuple[int, bytes], ...] = ()


@dataclass(frozen=True)
class Scenario:
    """One run; `deviations` maps port and motor parameter to the value used instead.

    `stimuli` are the inputs from stimulus files; `expectations` are criteria in words, from the
    file or from the command line.
    """

    document: LocatedToml
    name: str
    description: str
    role: str | None
    seed: int
    duration_ms: int
    on_bench: bool
    signal_period_us: int
    pictures_ms: tuple[int, ...]
    deviations: Mapping[str, Mapping[str, float]]
    inputs: tuple[Input, ...]
    straight: StraightDrive | None
    step: StepWindow | None
    criteria: tuple[Criterion, ...]
    stimuli: tuple[TimedInput, ...]
    expectations: tuple[Expectation, ...]
    peer: Peer | None = None
    monitor: MonitorWindow | None = None
    questions: tuple[Question, ...] = ()

    def timed_inputs(self) -> tuple[TimedInput, ...]:
        """All inputs of the run in the order of time; the file's own first at one instant."""
        path, line_of = self.document.path, self.document.line_of
        own = [
            TimedInput(
                MASTER_CLOCK.cycles_of_ms(e.at_ms),
                e.name,
                e.value,
                f"{path}:{line_of(('inputs', e.index))}",
            )
            for e in self.inputs
        ]
        return tuple(sorted([*own, *self.stimuli], key=lambda timed: timed.at_cycles))

    def unreachable(self, key_path: KeyPath, problem: str) -> ScenarioError:
        """An error that names file, line and field of what can never happen."""
        line = self.document.line_of(key_path)
        return ScenarioError(f"{self.document.path}:{line}: {dotted(key_path)}: {problem}")


def scenario_path(directory: Path, name: str) -> Path:
    """File of the scenario `name` of a project, by the rule of `named_file`; need not be there."""
    kept = directory / "scenarios"
    found = named_file(name, directory, kept, ".toml")
    return found or kept / (name if name.endswith(".toml") else f"{name}.toml")


def _motor_input(robot: Robot, port: str, quantity: str) -> str | None:
    motor = robot.motor_ports.get(port)
    if motor is None:
        return f"nothing is plugged into motor port {port}; see [ports] in robot.toml"
    if quantity == "hand_angle" and not motor.held_by_hand:
        return f"the motor on port {port} is not held by a hand; set held_by_hand in robot.toml"
    return None


def _sensor_input(robot: Robot, kind: SensorKind, taken: SensorInput, port: str) -> str | None:
    sensor = robot.sensor_ports.get(port)
    if sensor is None or sensor.device != kind.name:
        return f"there is no {kind.name} sensor on sensor port {port}; see [ports] in robot.toml"
    if taken.measured and sensor.measures_plant:
        return (
            f"the sensor on port {port} measures the plant; remove the input, or 'mount' or "
            "'axis' in robot.toml"
        )
    return None


def _body_input(robot: Robot, quantity: str) -> str | None:
    if robot.body.kind == "balancer":
        return None
    return f"body.{quantity} is of a body that balances, not of a {robot.body.kind}"


def _button_input(_robot: Robot, button: str) -> str | None:
    if button in BUTTONS:
        return None
    return f"unknown button '{button}'; the brick has {', '.join(BUTTONS)}"


_INPUTS: tuple[tuple[str, Callable[..., str | None]], ...] = (
    (r"body\.(held|push)", _body_input),
    (r"button\.(\w+)", _button_input),
    (r"motor\.(\w+)\.(hand_angle|load_torque)", _motor_input),
    (r"battery\.(voltage)", lambda _robot, _name: None),
    # The image knows its variables.
    (r"variable\.([\w.]+)(?::\w+)?", lambda _robot, _path: None),
)


def input_check(robot: Robot) -> InputCheck:
    """What is wrong with the name of an input of this robot; None when nothing is."""
    return lambda name: _input_problem(robot, name)


def _input_problem(robot: Robot, name: str) -> str | None:
    for pattern, check in _INPUTS:
        match = re.fullmatch(pattern, name)
        if match:
            return check(robot, *match.groups())
    found = sensor_input(name)
    if found is not None:
        return _sensor_input(robot, *found)
    of_sensors = [i.name for kind in sensor_kinds().values() for i in kind.inputs]
    known = ", ".join([*of_sensors, "button.<name>", "motor.<port>.hand_angle"])
    return (
        f"unknown input '{name}'; known are {known.replace('{port}', '<port>')}, "
        "motor.<port>.load_torque, body.held, body.push, battery.voltage and variable.<path>"
    )


def _check_inputs(document: LocatedToml, robot: Robot) -> None:
    for index, table in enumerate(document.values.get("inputs", [])):
        problem = _input_problem(robot, table["input"])
        if problem:
            raise document.error(("inputs", index, "input"), problem)


def _check_ports(document: LocatedToml, robot: Robot) -> None:
    values = document.values
    used: list[tuple[KeyPath, str]] = [
        (("deviations", port), port) for port in values.get("deviations", {})
    ]
    step = values.get("step", {})
    used += [(("step", "motors", i), port) for i, port in enumerate(step.get("motors", []))]
    for path, port in used:
        if port not in robot.motor_ports:
            raise document.error(
                path, f"nothing is plugged into motor port {port}; see [ports] in robot.toml"
            )


def _deviations(document: LocatedToml, robot: Robot) -> dict[str, dict[str, float]]:
    result: dict[str, dict[str, float]] = {}
    for port, table in document.values.get("deviations", {}).items():
        nominal = robot.motors[robot.motor_ports[port].motor]
        result[port] = {}
        for name, change in table.items():
            quantity = nominal[name]
            value = change.get("value", quantity.value * change.get("factor", 1.0))
            if not quantity.allows(value):
                raise document.error(
                    ("deviations", port, name),
                    f"{value:.6g} {quantity.unit} is outside the tolerance "
                    f"{quantity.value:.6g} ± {quantity.tolerance:.6g} {quantity.unit} "
                    "of robot.toml; stay within it or justify a wider one there",
                )
            result[port][name] = float(value)
    return result


def _instants(values: Mapping[str, Any]) -> list[tuple[KeyPath, int]]:
    found: list[tuple[KeyPath, int]] = [
        (("inputs", index, "at_ms"), table["at_ms"])
        for index, table in enumerate(values.get("inputs", []))
    ]
    found += [(("pictures_ms", i), at) for i, at in enumerate(values.get("pictures_ms", []))]
    for table in ("straight", "step", "monitor"):
        for key in ("from_ms", "until_ms"):
            if key in values.get(table, {}):
                found.append(((table, key), values[table][key]))
    return found


def check_stimuli(scenario: Scenario) -> None:
    """Raise `ScenarioError` for the first input of a stimulus file beyond the duration."""
    end = MASTER_CLOCK.cycles_of_ms(scenario.duration_ms)
    for timed in scenario.stimuli:
        if timed.at_cycles > end:
            raise ScenarioError(
                f"{timed.place}: {timed.name}: {MASTER_CLOCK.seconds(timed.at_cycles):g} s is "
                f"beyond the duration of {scenario.duration_ms} ms; shorten the stimulus or "
                "lengthen duration_ms"
            )


def check_expectations(scenario: Scenario) -> None:
    """Raise `ScenarioError` for the first expectation about what comes after the duration."""
    for expectation in scenario.expectations:
        if expectation.last_named > scenario.duration_ms / 1000:
            raise ScenarioError(
                f"{expectation.place}: '{expectation.text}': {expectation.last_named:g} s "
                f"is beyond the duration of {scenario.duration_ms} ms; move it forward or "
                "lengthen duration_ms"
            )


def _check_reachable(scenario: Scenario) -> None:
    duration = scenario.duration_ms
    for path, at_ms in _instants(scenario.document.values):
        if at_ms > duration:
            raise scenario.unreachable(
                path,
                f"{at_ms} ms is beyond the duration of {duration} ms; "
                "move it forward or lengthen duration_ms",
            )
    check_stimuli(scenario)
    check_expectations(scenario)
    needs = {
        "settling_time": ("step", scenario.step),
        "overshoot": ("step", scenario.step),
        "steady_state_error": ("step", scenario.step),
        "lateral_deviation": ("straight", scenario.straight),
    }
    for criterion in scenario.criteria:
        table, present = needs.get(criterion.measure, ("", True))
        if not present:
            raise scenario.unreachable(
                ("criteria", criterion.index, "measure"),
                f"'{criterion.measure}' can never be measured without a table [{table}]; add it",
            )


def _inputs(values: Mapping[str, Any]) -> tuple[Input, ...]:
    inputs = [
        Input(t["at_ms"], t["input"], float(t["value"]), t.get("note", ""), index)
        for index, t in enumerate(values.get("inputs", []))
    ]
    return tuple(sorted(inputs, key=lambda item: item.at_ms))


def _stimuli(document: LocatedToml, robot: Robot) -> tuple[TimedInput, ...]:
    """Inputs of all stimulus files, which lie relative to the scenario."""
    found: list[TimedInput] = []
    for index, table in enumerate(document.values.get("stimuli", [])):
        file = document.path.parent / table["file"]
        if not file.is_file():
            raise ScenarioError(
                f"{document.path}:{document.line_of(('stimuli', index, 'file'))}: "
                f"stimuli[{index}].file: there is no file '{file}'; correct its name"
            )
        channels = Channels(input_check(robot), table.get("signals", {}))
        found += read_stimulus(file, MASTER_CLOCK, channels, table.get("from_ms", 0))
    return tuple(found)


def _criteria(values: Mapping[str, Any]) -> tuple[Criterion, ...]:
    return tuple(
        Criterion(t["measure"], t.get("minimum"), t.get("maximum"), index)
        for index, t in enumerate(values.get("criteria", []))
        if "measure" in t
    )


def read_expectations(document: LocatedToml) -> tuple[Expectation, ...]:
    """Criteria in words of a file's [[criteria]]; raises `ProjectFileError`."""
    found = []
    for index, table in enumerate(document.values.get("criteria", [])):
        if "expect" in table:
            path: KeyPath = ("criteria", index, "expect")
            try:
                place = f"{document.path}:{document.line_of(path)}"
                found.append(parse_expectation(table["expect"], place))
            except ExpectationSyntaxError as error:
                raise document.error(path, str(error)) from None
    return tuple(found)


def _peer(document: LocatedToml) -> Peer | None:
    table = document.values.get("peer")
    if table is None:
        return None
    project = (document.path.parent / table["project"]).resolve()
    if not (project / "robot.toml").is_file():
        raise document.error(
            ("peer", "project"), f"'{project}' has no robot.toml; name the folder of a project"
        )
    return Peer(project, table["scenario"])


def _monitor(document: LocatedToml) -> MonitorWindow | None:
    table = document.values.get("monitor")
    if table is None:
        return None
    begin, end = table.get("from_ms", 0), table.get("until_ms")
    if "peer" in document.values:
        raise document.error(("monitor",), "a scenario has a peer or a monitor; leave one out")
    if end is not None and end <= begin:
        raise document.error(
            ("monitor", "until_ms"), f"is {end}; expected more than from_ms = {begin}"
        )
    return MonitorWindow(table["pin"], begin, end)


def read_scenario(path: Path, robot: Robot) -> Scenario:
    """Read a scenario; raises `ProjectFileError`, or `ScenarioError` for what cannot happen."""
    if not path.is_file():
        folder = robot.directory / "scenarios"
        known = ", ".join(sorted(file.stem for file in folder.glob("*.toml"))) or "none"
        raise ScenarioError(f"{path}: there is no such scenario; known scenarios: {known}")
    document = read_toml(path, missing="name a scenario below scenarios/")
    validate(document, "scenario")
    _check_inputs(document, robot)
    _check_ports(document, robot)
    values = document.values
    straight, step = values.get("straight"), values.get("step")
    scenario = Scenario(
        document=document,
        name=values["name"],
        description=values.get("description", ""),
        role=values.get("role"),
        seed=values["seed"],
        duration_ms=values["duration_ms"],
        on_bench=values.get("body", "robot") == "bench",
        signal_period_us=values.get("signal_period_us", 1000),
        pictures_ms=tuple(sorted(values.get("pictures_ms", []))),
        deviations=_deviations(document, robot),
        inputs=_inputs(values),
        straight=straight and StraightDrive(straight["from_ms"], float(straight["distance"])),
        step=step and StepWindow(step["from_ms"], step["until_ms"], tuple(step["motors"])),
        criteria=_criteria(values),
        stimuli=_stimuli(document, robot),
        expectations=read_expectations(document),
        peer=_peer(document),
        monitor=_monitor(document),
        questions=read_questions(document),
    )
    _check_reachable(scenario)
    return scenario
