# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Plants as diagrams: linear systems, a motor with friction and encoder, a two-wheeled vehicle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ravenbrick.errors import DesignError
from ravenbrick.model.blocks.basic import Gain, Inport, Outport, Sum
from ravenbrick.model.blocks.continuous import (
    ContinuousStateSpace,
    DryFriction,
    EncoderCount,
    Integrator,
)
from ravenbrick.model.blocks.relational import Product
from ravenbrick.model.blocks.trigonometry import Trigonometry
from ravenbrick.model.diagram import Diagram
from ravenbrick.model.motor import MotorParameters
from ravenbrick.model.program import DataType
from ravenbrick.model.structure.subsystem import Subsystem

__all__ = ["linear_plant", "motor_plant", "vehicle_plant"]

_STEP = 0.001  # s; plants without sampled blocks do not use it
_REAL = DataType.REAL64


def linear_plant(
    name: str, system: Any, inputs: Sequence[str] = (), outputs: Sequence[str] = (),
    initial: Sequence[float] = (),
) -> Diagram:  # fmt: skip
    """A continuous linear system, such as python-control's, between ports of these names.

    Without names the ports are called as in python-control's system, which are u[0], y[0] ... as
    u0, y0 unless they were given.
    """
    block = ContinuousStateSpace.of("System", system, tuple(map(float, initial)))
    diagram = Diagram(name, _STEP)
    diagram.add(block)
    own = [_labels(system, kind) for kind in ("input_labels", "output_labels")]
    names = [list(inputs) or own[0], list(outputs) or own[1]]
    counts = len(block.input_types), block.output_count
    for kind, count, found in zip(("input", "output"), counts, names, strict=True):
        if len(found) != count:
            raise DesignError(f"plant '{name}': {len(found)} names for {count} {kind}s")
    for port, label in enumerate(names[0]):
        diagram.connect(diagram.add(Inport(label, _REAL)), block, port)
    for output, label in enumerate(names[1]):
        diagram.connect(block, diagram.add(Outport(label, _REAL)), output=output)
    return diagram


def _labels(system: Any, kind: str) -> list[str]:
    labels = getattr(system, kind, None) or []
    return [str(label).replace("[", "").replace("]", "") for label in labels]


def motor_plant(
    name: str, motor: MotorParameters, *, static: float = 0.0, kinetic: float = 0.0,
    load_inertia: float = 0.0, counts_per_turn: int = 360,
) -> Diagram:  # fmt: skip
    """A direct-current motor: voltage (V) and load torque (N m) to speed, angle and count.

    `static` and `kinetic` friction in N m, `load_inertia` in kg m^2, all at the output shaft. The
    load torque acts against the motion that a positive voltage causes. The armature's inductance
    is neglected.
    """
    d = Diagram(name, _STEP)
    voltage = d.add(Inport("voltage", _REAL, unit="V"))
    load = d.add(Inport("load_torque", _REAL, unit="N m"))
    across = d.add(Sum("Across_Armature", _REAL, signs="+-"))
    current = d.add(Gain("Armature", _REAL, gain=1 / motor.resistance, unit="A"))
    torque = d.add(Gain("Torque_Constant", _REAL, gain=motor.torque_constant, unit="N m"))
    drive = d.add(Sum("Drive", _REAL, signs="+--"))
    friction = d.add(DryFriction("Friction", static=max(static, kinetic), kinetic=kinetic,
                                 unit="N m"))  # fmt: skip
    net = d.add(Sum("Net_Torque", _REAL, signs="+-"))
    inertia = d.add(Gain("Inertia", _REAL, gain=1 / (motor.inertia + load_inertia), unit="rad/s^2"))
    speed, angle = d.add(Integrator("Speed_State")), d.add(Integrator("Angle_State"))
    back = d.add(Gain("Back_Emf", _REAL, gain=motor.electric_constant, unit="V"))
    viscous = d.add(Gain("Viscous", _REAL, gain=motor.viscous_friction, unit="N m"))
    count = d.add(EncoderCount("Encoder", counts_per_turn=counts_per_turn, unit="count"))
    d.connect(voltage, across)
    d.connect_chain(across, current, torque, drive, net, inertia, speed, angle, count)
    d.connect(speed, back)
    d.connect(back, across, 1)
    d.connect(speed, viscous)
    d.connect(viscous, drive, 1)
    d.connect(load, drive, 2)
    d.connect(drive, friction)
    d.connect(speed, friction, 1)
    d.connect(friction, net, 1)
    for source, port, unit in ((speed, "speed", "rad/s"), (angle, "angle", "rad"),
                               (count, "encoder_count", "count")):  # fmt: skip
        d.connect(source, d.add(Outport(port, _REAL, unit=unit)))
    return d


def vehicle_plant(
    name: str, motor: MotorParameters, *, wheel_radius: float, track: float, mass: float,
    static: float = 0.0, kinetic: float = 0.0,
) -> Diagram:  # fmt: skip
    """A vehicle on two driven wheels: `left_voltage`, `right_voltage` (V) to place and heading.

    Lengths in m, mass in kg. Each motor carries half of the mass as inertia at its wheel; the
    turning body's inertia and sideways slip are neglected. Subsystems Left and Right are
    `motor_plant`.
    """
    d = Diagram(name, _STEP)
    inertia = mass * wheel_radius**2 / 2
    rest = d.add(Inport("load_torque", _REAL, unit="N m"))
    wheels = []
    for side in ("left", "right"):
        inner = motor_plant(f"{side}_motor", motor, static=static, kinetic=kinetic,
                            load_inertia=inertia)  # fmt: skip
        wheel = d.add(Subsystem(side.capitalize(), diagram=inner))
        d.connect(d.add(Inport(f"{side}_voltage", _REAL, unit="V")), wheel, 0)
        d.connect(rest, wheel, 1)
        d.connect(wheel, d.add(Outport(f"{side}_speed", _REAL, unit="rad/s")))
        d.connect(wheel, d.add(Outport(f"{side}_angle", _REAL, unit="rad")), output=1)
        d.connect(wheel, d.add(Outport(f"{side}_count", _REAL, unit="count")), output=2)
        wheels.append(wheel)
    both, turn = d.add(Sum("Both", _REAL, signs="++")), d.add(Sum("Turn", _REAL, signs="+-"))
    ahead = d.add(Gain("Wheel", _REAL, gain=wheel_radius / 2, unit="m/s"))
    yaw = d.add(Gain("Track", _REAL, gain=wheel_radius / track, unit="rad/s"))
    heading = d.add(Integrator("Heading_State"))
    for place, wheel in enumerate(wheels):
        d.connect(wheel, both, place)
        d.connect(wheel, turn, 1 - place)
    d.connect(both, ahead)
    d.connect_chain(turn, yaw, heading)
    for axis, function in (("x", "cos"), ("y", "sin")):
        part = d.add(Trigonometry(function.capitalize(), _REAL, function=function))
        share = d.add(Product(f"Along_{axis}", _REAL, unit="m/s"))
        d.connect(heading, part)
        d.connect(ahead, share, 0)
        d.connect(part, share, 1)
        d.connect_chain(share, d.add(Integrator(f"Path_{axis}")),
                        d.add(Outport(axis, _REAL, unit="m")))  # fmt: skip
    d.connect(heading, d.add(Outport("heading", _REAL, unit="rad")))
    return d
