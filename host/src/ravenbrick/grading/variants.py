# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A robot and numbers of each student's own, drawn from the lecturer's class key.

The seed of a variant is HMAC-SHA-256 (RFC 2104, FIPS 198-1) of student and sheet under the key:
whoever has the key draws the same variant again, whoever has it not learns nothing from others'.
"""

from __future__ import annotations

import ast
import hashlib
import hmac
import json
import math
import operator
import random
import re
import secrets
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.project.robot import Battery, Quantity, Robot, SensorPort

__all__ = [
    "Individual",
    "OwnNumber",
    "Variant",
    "drawn_motor",
    "drawn_variant",
    "filled",
    "individual_of",
    "middle_variant",
    "new_key",
    "own_motor",
    "own_robot",
    "read_key",
    "student_id",
]

KEY_BYTES = 32
DIGITS = 6
_RIGID = ("backlash",)
_KEY = re.compile(rf"[0-9a-f]{{{2 * KEY_BYTES}}}\Z")
_PLACE = re.compile(r"\{([^{}]+)\}")


def _power(base: float, exponent: float) -> float:
    try:
        return math.pow(base, exponent)
    except ValueError as error:
        raise ArithmeticError("a root of a negative number, or zero divides") from error


_OPERATORS: Mapping[type, Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: _power,
}


@dataclass(frozen=True)
class OwnNumber:
    """A number of the assignment, drawn from `least` to `most` in whole steps."""

    name: str
    least: float
    most: float
    step: float

    def draw(self, dice: random.Random) -> float:
        """One of the values, each as probable as the others."""
        return self.least + self.step * dice.randint(0, self._steps)

    @property
    def middle(self) -> float:
        """The value in the middle."""
        return self.least + self.step * (self._steps // 2)

    @property
    def _steps(self) -> int:
        return round((self.most - self.least) / self.step)


@dataclass(frozen=True)
class Individual:
    """What differs from student to student; `design` maps constants of design.py to expressions.

    `hidden`: the motors' constants are the ones to be found, so the student's robot.toml has the
    catalogue's and the student gets recordings of the scenarios `records`. A submission with a
    wrong answer about own numbers keeps at most `share_without_own_answers` of the points. Rubrics
    with the same `sheet` give a student the same numbers.
    """

    motors: tuple[str, ...] = ()
    battery: bool = False
    sensors: bool = False
    hidden: bool = False
    records: tuple[str, ...] = ()
    numbers: tuple[OwnNumber, ...] = ()
    design: Mapping[str, str] = field(default_factory=dict)
    share_without_own_answers: float = 1.0
    sheet: str = ""


@dataclass(frozen=True)
class Variant:
    """One student's robot and numbers, and every value that the rubric may refer to."""

    robot: Robot
    numbers: Mapping[str, float]
    facts: Mapping[str, float]


def individual_of(table: Mapping[str, Any]) -> Individual:
    """The table [individual] of a rubric; raises `ValueError`."""
    numbers = tuple(
        OwnNumber(name, float(n["least"]), float(n["most"]), float(n["step"]))
        for name, n in table.get("numbers", {}).items()
    )
    for number in numbers:
        if number.most <= number.least or number.step <= 0:
            raise ValueError(f"{number.name}: expected least < most and step > 0")
    return Individual(
        motors=tuple(table.get("motors", ())),
        battery=table.get("battery", False),
        sensors=table.get("sensors", False),
        hidden=table.get("hidden", False),
        records=tuple(table.get("records", ())),
        numbers=numbers,
        design=dict(table.get("design", {})),
        share_without_own_answers=float(table.get("share_without_own_answers", 1.0)),
        sheet=table.get("sheet", ""),
    )


def new_key(path: Path) -> None:
    """Draw a key for a class; the file is its owner's alone. Raises `UsageError` if it is there."""
    if path.exists():
        raise UsageError(f"{shown_path(path)} exists; a new key would change every student's robot")
    atomic_write(path, f"{secrets.token_hex(KEY_BYTES)}\n", mode=0o600)


def read_key(path: Path) -> bytes:
    """The class key; raises `UsageError`."""
    try:
        text = path.read_text("ascii").strip()
    except (OSError, UnicodeDecodeError):
        raise UsageError(
            f"{shown_path(path)}: there is no class key; 'ravenbrick class --new-key' writes one"
        ) from None
    if not _KEY.match(text):
        raise UsageError(
            f"{shown_path(path)}: expected a class key of {2 * KEY_BYTES} hexadecimal digits"
        )
    return bytes.fromhex(text)


def student_id(text: str) -> str:
    """The same for all spellings of one id: Unicode's composed form, small letters, no margins."""
    return unicodedata.normalize("NFC", text).strip().casefold()


def _seed(key: bytes, sheet: str, student: str) -> str:
    message = json.dumps(["ravenbrick class", 1, sheet, student_id(student)])
    return hmac.new(key, message.encode(), hashlib.sha256).hexdigest()


def _within(quantity: Quantity, seed: str) -> float:
    """Uniform within the tolerance, never below 0, a function of the seed alone."""
    low = max(quantity.value - quantity.tolerance, 0.0)
    return random.Random(seed).uniform(low, quantity.value + quantity.tolerance)


def drawn_motor(robot: Robot, port: str, seed: str) -> dict[str, float]:
    """Parameters of the motor on a port, within the tolerances of robot.toml."""
    motor = robot.motors[robot.motor_ports[port].motor]
    found = {
        name: _within(quantity, f"{seed} {port} {name}")
        for name, quantity in sorted(motor.items())
        if name not in _RIGID and quantity.tolerance != 0
    }
    static = found.get("static_friction")
    if static is not None and "coulomb_friction" in found:
        found["static_friction"] = max(static, found["coulomb_friction"])
    return found


def _own(quantity: Quantity, value: float, digits: int = DIGITS) -> Quantity:
    """The quantity with this value; its tolerance still covers all that it covered."""
    rounded = float(f"{value:.{digits}g}")
    tolerance = float(f"{quantity.tolerance + abs(rounded - quantity.value):.{digits}g}")
    return Quantity(rounded, quantity.unit, tolerance, "your own, drawn within the tolerance")


def own_motor(port: str) -> str:
    """Name of the parameters of the student's motor on a port."""
    return f"own_{port.lower()}"


def own_robot(robot: Robot, individual: Individual, seed: str) -> Robot:
    """The robot with what `individual` names drawn within its tolerances."""
    motors, ports = dict(robot.motors), dict(robot.motor_ports)
    for port in individual.motors:
        plugged = ports[port]
        nominal = robot.motors[plugged.motor]
        drawn = drawn_motor(robot, port, seed)
        motors[own_motor(port)] = {
            name: _own(quantity, drawn[name]) if name in drawn else quantity
            for name, quantity in nominal.items()
        }
        ports[port] = replace(plugged, motor=own_motor(port))
    return replace(
        robot,
        motors=motors,
        motor_ports=ports,
        battery=_own_battery(robot, seed) if individual.battery else robot.battery,
        sensor_ports=_own_sensors(robot, seed) if individual.sensors else robot.sensor_ports,
    )


def _own_battery(robot: Robot, seed: str) -> Battery:
    battery = robot.battery
    return replace(
        battery,
        voltage=_own(battery.voltage, _within(battery.voltage, f"{seed} battery voltage"), 4),
        internal_resistance=_own(
            battery.internal_resistance,
            _within(battery.internal_resistance, f"{seed} battery resistance"),
            4,
        ),
    )


def _own_sensors(robot: Robot, seed: str) -> dict[str, SensorPort]:
    """Sensors with a reading at rest have one of their own."""
    return {
        port: replace(plugged, rest=_own(plugged.rest, _within(plugged.rest, f"{seed} {port}"), 4))
        if plugged.rest
        else plugged
        for port, plugged in robot.sensor_ports.items()
    }


def _motor_facts(robot: Robot, port: str) -> dict[str, float]:
    """Gain (rad/s/V), time constant (s) and friction as a voltage (V) of a motor.

    Dry friction Tc takes the voltage Tc R / Kt.
    """
    from ravenbrick.model import MotorParameters  # slow to load, and the judge has no need of it

    values, name = robot.motor_values(port), f"motor_{port.lower()}"
    motor = MotorParameters.of_values(values, "robot.toml")
    return {
        f"{name}_gain": motor.gain,
        f"{name}_time_constant": motor.time_constant,
        f"{name}_friction": values["coulomb_friction"] * motor.resistance / motor.torque_constant,
    }


def _design_figures(robot: Robot, constants: Mapping[str, float]) -> dict[str, float]:
    """Figures of the reference project's design.py for this robot; the file is the lecturer's."""
    file = robot.directory / "design.py"
    spec = spec_from_file_location("ravenbrick_reference_design", file)
    if spec is None or spec.loader is None or not file.is_file():
        raise UsageError(f"{shown_path(file)}: there is no design; remove individual.design")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    for name, value in {"ROBOT": robot, **constants}.items():
        if not hasattr(module, name):
            raise UsageError(f"{shown_path(file)}: there is no {name}; correct individual.design")
        setattr(module, name, value)
    figures: Mapping[str, object] = module.design().figures()
    return {n: float(v) for n, v in figures.items() if isinstance(v, int | float)}


def _variant(robot: Robot, numbers: dict[str, float], individual: Individual) -> Variant:
    facts = dict(numbers)
    for port in robot.motor_ports:
        facts |= _motor_facts(robot, port)
    facts["battery_voltage"] = robot.battery.voltage.value
    for port, plugged in robot.sensor_ports.items():
        if plugged.rest:
            facts[f"sensor_{port}_rest"] = plugged.rest.value
            facts[f"sensor_{port}_count"] = math.floor(plugged.rest.value + 0.5)
    if individual.design:
        values = {name: _value(text, facts) for name, text in individual.design.items()}
        # A number of samples is whole in design.py, too.
        constants = {n: int(v) if v.is_integer() else v for n, v in values.items()}
        facts |= _design_figures(robot, constants)
    return Variant(robot, numbers, facts)


def drawn_variant(
    robot: Robot, individual: Individual, key: bytes, sheet: str, student: str
) -> Variant:
    """The student's variant of a sheet, the same whenever it is drawn."""
    seed = _seed(key, sheet, student)
    numbers = {n.name: n.draw(random.Random(f"{seed} {n.name}")) for n in individual.numbers}
    return _variant(own_robot(robot, individual, seed), numbers, individual)


def middle_variant(robot: Robot, individual: Individual) -> Variant:
    """The robot of the project and the middle of each number, to check a rubric with."""
    return _variant(robot, {n.name: n.middle for n in individual.numbers}, individual)


def _value(expression: str, facts: Mapping[str, float]) -> float:
    """A sum, difference, product, quotient or power of facts and numbers; raises `ValueError`."""

    def of(node: ast.expr) -> float:
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id in facts:
            return facts[node.id]
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            return _OPERATORS[type(node.op)](of(node.left), of(node.right))
        raise ValueError(
            f"'{ast.unparse(node)}' in '{expression}': expected numbers, + - * / ** and the names "
            f"{', '.join(sorted(facts))}"
        )

    try:
        return of(ast.parse(expression.strip(), mode="eval").body)
    except (SyntaxError, ArithmeticError) as error:
        raise ValueError(f"'{expression}' has no value: {error}") from None


def filled(text: str, facts: Mapping[str, float]) -> str:
    """The text with the value of each expression in braces; raises `ValueError`."""
    return _PLACE.sub(lambda match: f"{_value(match[1], facts):.{DIGITS + 1}g}", text)
