# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Robot and scenario -> the configuration of a virtual brick."""

from __future__ import annotations

from typing import Any

import numpy as np

from ravenbrick.clock import Clock
from ravenbrick.project.robot import Floor, Robot, SensorPort
from ravenbrick.project.scenario import Scenario

__all__ = ["brick_configuration"]

CUT_OUT = {
    "trip_current": "cut_out_current",
    "reset_current": "cut_out_reset_current",
    "time_constant": "cut_out_time_constant",
}


def _motor(robot: Robot, scenario: Scenario, port: str) -> dict[str, Any]:
    plugged = robot.motor_ports[port]
    parameters: dict[str, Any] = {name: q.value for name, q in robot.motors[plugged.motor].items()}
    parameters.update(scenario.deviations.get(port, {}))
    fuse = {field: parameters.pop(name) for field, name in CUT_OUT.items() if name in parameters}
    if fuse:
        parameters["cut_out"] = fuse
    motor: dict[str, Any] = {"parameters": parameters}
    if plugged.held_by_hand and plugged.hand_rate is not None:
        motor |= {"held_by_hand": True, "hand_rate": plugged.hand_rate.value}
    return motor


def _body(robot: Robot, scenario: Scenario) -> dict[str, Any]:
    if scenario.on_bench or robot.body.kind == "bench":
        return {"kind": "bench"}
    values = {name: quantity.value for name, quantity in robot.body.quantities.items()}
    return {"kind": robot.body.kind, "left": robot.body.left, "right": robot.body.right, **values}


def _sensor(sensor: SensorPort) -> dict[str, Any]:
    configuration: dict[str, Any] = {"kind": sensor.device}
    if sensor.mount is not None:
        mount = sensor.mount
        configuration["mount"] = {"x": mount.x, "y": mount.y, "direction": mount.direction}
    if sensor.axis is not None:
        configuration["axis"] = sensor.axis
    if sensor.rest is not None:
        configuration["rest"] = sensor.rest.value
    return configuration


def _floor(robot: Robot, floor: Floor) -> dict[str, Any]:
    """The picture in 1/255 of reflectance; raises `ProjectFileError` when it cannot be read."""
    from PIL import Image  # slow to load, and few robots have a floor

    try:
        with Image.open(floor.image) as picture:
            # 16 bits of grey are a mode of their own, which `convert` would cut off at 255.
            if picture.mode.startswith("I"):
                grey = np.asarray(picture) / 257
            else:
                grey = np.asarray(picture.convert("RGB")).mean(axis=2)
    except (OSError, SyntaxError, ValueError) as error:
        problem = f"'{floor.image}' cannot be read as a picture ({error}); save it as PNG"
        raise robot.document.error(("floor", "image"), problem) from None
    return {
        "pixel": floor.pixel.value,
        "corner": list(floor.corner),
        "width": int(grey.shape[1]),
        "reflectance": np.rint(grey).astype(int).ravel().tolist(),
        "outside": floor.outside,
    }


def _surroundings(robot: Robot) -> dict[str, Any]:
    walls = [{"from": list(wall.begin), "to": list(wall.end)} for wall in robot.walls]
    floor = {"floor": _floor(robot, robot.floor)} if robot.floor else {}
    return {**floor, "walls": walls}


def brick_configuration(robot: Robot, scenario: Scenario, clock: Clock) -> dict[str, Any]:
    """The configuration that the module `virtual_brick` takes as JSON; floats are SI."""
    battery = robot.battery
    return {
        "seed": scenario.seed,
        "signal_period_cycles": clock.cycles(scenario.signal_period_us * 1e-6),
        "battery": {
            "kind": battery.kind,
            "voltage": battery.voltage.value,
            "internal_resistance": battery.internal_resistance.value,
        },
        "motors": {port: _motor(robot, scenario, port) for port in robot.motor_ports},
        "body": _body(robot, scenario),
        "surroundings": _surroundings(robot),
        "sensors": {port: _sensor(sensor) for port, sensor in robot.sensor_ports.items()},
    }
