# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The direct-current motor as a first-order system from voltage to speed of the output shaft."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

from ravenbrick.catalogue import part_source, part_values
from ravenbrick.errors import DesignError
from ravenbrick.model.lazy import control

__all__ = ["NXT_MOTOR", "MotorParameters", "SpeedLoop"]


@dataclass(frozen=True)
class MotorParameters:
    """Constants of a motor with its gear, seen at the output shaft.

    `torque_constant` Kt in N m/A, `electric_constant` Ke in V s/rad, `resistance` R in ohm,
    `viscous_friction` b in N m s/rad, `inertia` J in kg m^2. `source` says where they come from.
    """

    torque_constant: float
    electric_constant: float
    resistance: float
    viscous_friction: float
    inertia: float
    source: str

    @classmethod
    def of_catalogue(cls, name: str) -> MotorParameters:
        """The motor of this name in the catalogue, without its dry friction and backlash."""
        return cls.of_values(part_values("motors", name), part_source("motors", name))

    @classmethod
    def of_values(cls, values: Mapping[str, float], source: str) -> MotorParameters:
        """The motor with these constants by name, without its dry friction and backlash."""
        known = {field.name: values[field.name] for field in fields(cls) if field.name in values}
        return cls(**known, source=source)

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, float) and not (math.isfinite(value) and value > 0):
                raise DesignError(f"motor: {field.name} must be > 0, not {value}")

    @property
    def _damping(self) -> float:
        return (
            self.viscous_friction * self.resistance + self.torque_constant * self.electric_constant
        )

    @property
    def gain(self) -> float:
        """Steady speed per volt, K = Kt / (b R + Kt Ke), in rad/s per V."""
        return self.torque_constant / self._damping

    @property
    def time_constant(self) -> float:
        """tau = R J / (b R + Kt Ke), in s.

        The armature's inductance is neglected, as in Franklin, Powell and Emami-Naeini, Feedback
        Control of Dynamic Systems, section 2.3.
        """
        return self.resistance * self.inertia / self._damping

    def transfer_function(self) -> control.TransferFunction:
        """Voltage (V) to speed (rad/s): K / (tau s + 1)."""
        return control.tf([self.gain], [self.time_constant, 1.0])


NXT_MOTOR = MotorParameters.of_catalogue("nxt")


@dataclass(frozen=True)
class SpeedLoop:
    """The speed loop in volts: the fed-back signal is the speed over `degrees_per_volt`.

    `gain` and `time_constant` (s) are those of the motor in rad/s per V; `degrees_per_volt` in
    (deg/s)/V turns a speed into the voltage that stands for it.
    """

    gain: float
    time_constant: float
    degrees_per_volt: float

    @classmethod
    def of_motor(cls, motor: MotorParameters, degrees_per_volt: float) -> SpeedLoop:
        """The loop around a motor with the constants as computed from its parameters."""
        return cls(motor.gain, motor.time_constant, degrees_per_volt)

    @property
    def feedback_gain(self) -> float:
        """Volts per rad/s."""
        return math.degrees(1.0) / self.degrees_per_volt

    @property
    def loop_gain(self) -> float:
        """a = K times the feedback gain: fed-back volts per volt of control input."""
        return self.gain * self.feedback_gain

    def plant(self) -> control.TransferFunction:
        """Control input (V) to fed-back signal (V): a / (tau s + 1)."""
        return control.tf([self.loop_gain], [self.time_constant, 1.0])

    def closed_loop(self, controller: control.TransferFunction) -> control.TransferFunction:
        """Set-point (V) to fed-back signal (V) with a continuous controller."""
        return control.minreal(control.feedback(controller * self.plant()), verbose=False)
