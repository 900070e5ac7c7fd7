# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A project's `robot.toml` with the constants of a student's own robot, comments and all."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ravenbrick.project.robot import Quantity, Robot

__all__ = ["own_robot_text"]


def _quantity(quantity: Quantity) -> str:
    return (
        f'{{ value = {quantity.value!r}, unit = "{quantity.unit}", '
        f'tolerance = {quantity.tolerance!r}, source = "{quantity.source}" }}'
    )


def _with_fields(text: str, table: str, fields: Mapping[str, str]) -> str:
    """The text with these fields in [table], in place of what it says about them."""
    lines: list[str] = []
    inside, left = False, dict(fields)
    for line in [*text.splitlines(), "[end]"]:
        if line.startswith("["):
            if inside:
                last = len(lines)
                while not lines[last - 1].strip():
                    last -= 1
                lines[last:last] = [f"{name} = {value}" for name, value in left.items()]
            inside = line.strip() == f"[{table}]"
        name = line.partition("=")[0].strip()
        if inside and name in left:
            line = f"{name} = {left.pop(name)}"
        lines.append(line)
    return "\n".join(lines[:-1]) + "\n"


def own_robot_text(text: str, project: Robot, own: Robot) -> str:
    """`text`, the robot.toml of `project`, changed to say what `own` is."""
    for port, plugged in own.motor_ports.items():
        if plugged.motor != project.motor_ports[port].motor:
            text = _with_fields(text, f"ports.{port}", {"motor": f'"{plugged.motor}"'})
            constants = own.motors[plugged.motor].items()
            table = "".join(f"{name} = {_quantity(value)}\n" for name, value in constants)
            text = f"{text.rstrip()}\n\n[motors.{plugged.motor}]\n{table}"
    if own.battery != project.battery:
        battery = own.battery
        fields = {"voltage": battery.voltage, "internal_resistance": battery.internal_resistance}
        text = _with_fields(text, "battery", {n: _quantity(q) for n, q in fields.items()})
    for port, sensor in own.sensor_ports.items():
        if sensor != project.sensor_ports[port] and sensor.rest:
            text = _with_fields(text, f"ports.{port}", {"rest": _quantity(sensor.rest)})
    return re.sub(r"\n{3,}", "\n\n", text)
