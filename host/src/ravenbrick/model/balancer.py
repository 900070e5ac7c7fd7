# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A two-wheeled inverted pendulum with two motors, linear about the upright position."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from ravenbrick.catalogue import part_source, part_values
from ravenbrick.errors import DesignError
from ravenbrick.model.lazy import control

__all__ = ["NXTWAY_GS", "TwoWheeledBalancer"]

_MAY_BE_ZERO = frozenset({"floor_friction", "motor_inertia"})


@dataclass(frozen=True)
class TwoWheeledBalancer:
    """Constants in SI units; the wheels' inertia is that of a disc, the body's that of a rod.

    `body_friction` between body and motor and `floor_friction` between wheel and floor in
    N m s/rad; `gear_ratio` 1 means that the motor's constants are those of the output shaft.
    """

    wheel_mass: float
    wheel_radius: float
    body_mass: float
    body_height: float
    body_friction: float
    floor_friction: float
    motor_resistance: float
    electric_constant: float
    torque_constant: float
    motor_inertia: float
    gear_ratio: float
    gravity: float
    source: str

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if isinstance(value, str):
                continue
            least_ok = value > 0 or (item.name in _MAY_BE_ZERO and value == 0)
            if not (math.isfinite(value) and least_ok):
                raise DesignError(f"balancer: {item.name} must be > 0, not {value}")

    def state_space(self) -> control.StateSpace:
        """States wheel angle, body pitch and their rates (rad, rad/s); inputs both motors' volts.

        The wheel angle is the mean of both wheels, measured against the vertical. Outputs are the
        states. Lagrange's equations of cart and pendulum, linear about pitch 0, the armature's
        inductance neglected (Y. Yamamoto, NXTway-GS Model-Based Design, 2008, section 3).
        """
        length = self.body_height / 2
        radius, ratio = self.wheel_radius, self.gear_ratio
        wheel_inertia = self.wheel_mass * radius**2 / 2
        pitch_inertia = self.body_mass * length**2 / 3
        rotor = 2 * ratio**2 * self.motor_inertia
        drive = ratio * self.torque_constant / self.motor_resistance
        braking = drive * self.electric_constant + self.body_friction
        coupling = self.body_mass * length * radius - rotor
        rolling = (2 * self.wheel_mass + self.body_mass) * radius**2 + 2 * wheel_inertia + rotor
        pitching = self.body_mass * length**2 + pitch_inertia + rotor
        inertia = np.array([[rolling, coupling], [coupling, pitching]])
        damping = 2 * np.array([[braking + self.floor_friction, -braking], [-braking, braking]])
        stiffness = np.diag([0.0, -self.body_mass * self.gravity * length])
        torque = drive * np.array([[1.0, 1.0], [-1.0, -1.0]])
        zero, one = np.zeros((2, 2)), np.eye(2)
        lower = -np.linalg.solve(inertia, np.hstack([stiffness, damping]))
        matrix = np.vstack([np.hstack([zero, one]), lower])
        entry = np.vstack([zero, np.linalg.solve(inertia, torque)])
        return control.ss(matrix, entry, np.eye(4), np.zeros((4, 2)))


def _nxtway_gs() -> TwoWheeledBalancer:
    body, motor = part_values("bodies", "nxtway"), part_values("motors", "nxtway")
    return TwoWheeledBalancer(
        wheel_mass=body["wheel_mass"],
        wheel_radius=body["wheel_radius"],
        body_mass=body["mass"],
        body_height=2 * body["centre_height"],
        body_friction=motor["viscous_friction"],
        floor_friction=0.0,
        motor_resistance=motor["resistance"],
        electric_constant=motor["electric_constant"],
        torque_constant=motor["torque_constant"],
        motor_inertia=motor["inertia"],
        gear_ratio=1.0,
        gravity=9.81,
        source=part_source("bodies", "nxtway"),
    )


NXTWAY_GS = _nxtway_gs()
