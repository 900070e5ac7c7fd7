# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Robot and scenario -> the configuration of a virtual brick."""

from __future__ import annotations

from typing import Any

from ravenbrick.target.clock import Clock
from ravenbrick.target.robot import Robot
from ravenbrick.target.scenario import Scenario

__all__ = ["brick_configuration"]


def _motor(robot: Robot, scenario: Scenario, port: str) -> dict[str, Any]:
    plugged = robot.motor_ports[port]
    parameters = {name: q.value for name, q in robot.motors[plugged.motor].items()}
    parameters.update(scenario.deviations.get(port, {}))
    motor: dict[str, Any] = {"parameters": parameters}
    if plugged.held_by_hand and plugged.hand_rate is not None:
        motor |= {"held_by_hand": True, "hand_rate": plugged.hand_rate.value}
    return motor


def _body(robot: Robot, scenario: Scenario) -> dict[str, Any]:
    if scenario.on_bench or robot.body.kind == "bench":
        return {"kind": "bench"}
    values = {name: quantity.value for name, quantity in robot.body.quantities.items()}
    return {"kind": robot.body.kind, "left": robot.body.left, "right": robot.body.right, **values}


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
        "sensors": {port: {"kind": s.device} for port, s in robot.sensor_ports.items()},
    }
