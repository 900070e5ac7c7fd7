# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The speed controller with gains by lambda tuning for 400 ms, fed back in rad/s."""

from __future__ import annotations

import math

import control
from ravenbrick.control import PlantInLoop, pi_by_lambda
from ravenbrick.model import (
    Diagram,
    DiscreteIntegrator,
    FixedPoint,
    FixedPointOptions,
    Gain,
    Inport,
    Outport,
    Parameter,
    Rounding,
    Saturation,
    SpeedLoop,
    Sum,
    to_fixed_point,
)

LOOP = SpeedLoop(2.029, 0.037, 116.0)
SAMPLE_TIME = 0.004
SUPPLY = 9.0
RANGES = {"Input_Voltage": 10.0, "Speed": 20.0, "Integral": SUPPLY}


def paper_pi() -> Diagram:
    """Set-point in V and speed in rad/s to motor voltage."""
    gains = pi_by_lambda(LOOP, 0.4)
    diagram = Diagram("functional", SAMPLE_TIME)
    set_point = diagram.add(Inport("Input_Voltage", unit="V", description="set-point"))
    speed = diagram.add(Inport("Speed", unit="rad/s", description="of the wheel"))
    scale = Parameter("Scale", math.degrees(1) / 116, "V s/rad", "speed as volts")
    volts = diagram.add(Gain("Real_Voltage", gain=scale))
    error = diagram.add(Sum("Error", signs="+-"))
    share = Parameter("Kp", gains.proportional, "V/V", "proportional gain")
    proportional = diagram.add(Gain("Proportional", gain=share))
    step = Parameter("Ki_Ts", gains.integral * SAMPLE_TIME, "V/V", "integral gain, one sample")
    increment = diagram.add(Gain("Integral_Gain", gain=step))
    integral = diagram.add(DiscreteIntegrator("Integral", gain=1.0))
    demand = diagram.add(Sum("Demand"))
    limit = Parameter("Limit", SUPPLY, "V", "largest voltage")
    saturated = diagram.add(Saturation("Saturated", limit=limit))
    corrected = diagram.add(Outport("correctedvoltage", unit="V", description="motor voltage"))
    diagram.connect(set_point, error, 0)
    diagram.connect(speed, volts)
    diagram.connect(volts, error, 1)
    diagram.connect_chain(error, proportional, demand, saturated, corrected)
    diagram.connect_chain(error, increment, integral)
    diagram.connect(integral, demand, 1)
    return diagram


def fixed_pi(rounding: Rounding = Rounding.ZERO) -> FixedPoint:
    """The controller in fixed point with formats chosen from the ranges alone."""
    return to_fixed_point(paper_pi(), FixedPointOptions(RANGES, rounding=rounding))


def plant() -> PlantInLoop:
    """The motor from volts to rad/s, observed as the volts that are fed back."""
    motor = control.tf([LOOP.gain], [LOOP.time_constant, 1.0])
    sampled = control.ss(control.sample_system(motor, SAMPLE_TIME, "zoh"))
    return PlantInLoop(sampled, ("Speed",), math.degrees(1) / 116, "V")
