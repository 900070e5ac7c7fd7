# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The PI controller as a block diagram: what is simulated and what becomes C."""

from __future__ import annotations

from ravenbrick.control.synthesis.tuning import DiscretePi
from ravenbrick.model import (
    Diagram,
    DiscreteIntegrator,
    Gain,
    Inport,
    IntegrationMethod,
    Outport,
    Parameter,
    Saturation,
    Sum,
    UnitDelay,
)

__all__ = ["pi_diagram"]


def pi_diagram(
    pi: DiscretePi,
    supply_voltage: float,
    tracking_time: float,
    name: str = "functional",
) -> Diagram:
    """PI from (Input_Voltage, Real_Voltage) to correctedvoltage, all V, limited to the supply.

    Anti-windup by back-calculation: what the limit cuts off drives the integrator back with time
    constant `tracking_time` (s) (Astrom and Hagglund, Advanced PID Control, section 3.5). Without
    saturation the returned difference is exactly 0, so the loop is the linear design. Gains per
    sample are folded: the integrator accumulates.
    """
    diagram = Diagram(name, pi.sample_time)
    set_point = diagram.add(Inport("Input_Voltage", unit="V", description="set-point"))
    measured = diagram.add(Inport("Real_Voltage", unit="V", description="fed-back speed"))
    error = diagram.add(Sum("Error", signs="+-"))
    proportional = diagram.add(
        Gain("Proportional", gain=Parameter("Kp", pi.proportional, "V/V", "proportional gain"))
    )
    integral_step = Parameter("Ki_Ts", pi.integral_step, "V/V", "integral gain times sample time")
    integral_gain = diagram.add(Gain("Integral_Gain", gain=integral_step))
    cut = diagram.add(Sum("Cut_Off", signs="+-"))
    tracking_step = pi.sample_time / tracking_time
    tracking = diagram.add(
        Gain(
            "Tracking",
            gain=Parameter("Kt_Ts", tracking_step, "V/V", "anti-windup gain times sample time"),
        )
    )
    increment = diagram.add(Sum("Increment", signs="++"))
    integral = diagram.add(DiscreteIntegrator("Integral", gain=1.0, method=pi.method))
    demand = diagram.add(Sum("Demand", signs="++"))
    limit = Parameter("Saturation", supply_voltage, "V", "largest voltage, the battery's")
    saturation = diagram.add(Saturation("Saturated", limit=limit))
    corrected = diagram.add(Outport("correctedvoltage", unit="V", description="motor voltage"))
    diagram.connect(set_point, error, 0)
    diagram.connect(measured, error, 1)
    diagram.connect_chain(error, proportional, demand, saturation, corrected)
    diagram.connect_chain(error, integral_gain, increment, integral)
    diagram.connect(integral, demand, 1)
    diagram.connect(saturation, cut, 0)
    diagram.connect(demand, cut, 1)
    diagram.connect(cut, tracking)
    if pi.method is IntegrationMethod.FORWARD_EULER:
        diagram.connect(tracking, increment, 1)
    else:
        memory = diagram.add(UnitDelay("Tracking_Memory"))
        diagram.connect(tracking, memory)
        diagram.connect(memory, increment, 1)
    return diagram
