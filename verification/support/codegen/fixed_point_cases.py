# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Controllers and filters in fixed point, with both roundings."""

from __future__ import annotations

from ravenbrick.control import DiscretePi, pi_diagram
from ravenbrick.model import (
    Constant,
    Diagram,
    DiscreteTransferFunction,
    FixedPoint,
    FixedPointOptions,
    Gain,
    Inport,
    IntegrationMethod,
    Outport,
    Rounding,
    Saturation,
    Sum,
    UnitDelay,
    to_fixed_point,
)

from verification.support.codegen.paper_pi import fixed_pi


def anti_windup(method: IntegrationMethod, rounding: Rounding) -> FixedPoint:
    """The vehicle's controller with back-calculation."""
    diagram = pi_diagram(DiscretePi(0.314445, 0.032221, 0.004, method), 8.0, 0.037)
    ranges = {"Input_Voltage": 10.0, "Real_Voltage": 10.0, "Integral": 9.0}
    return to_fixed_point(diagram, FixedPointOptions(ranges, rounding=rounding))


def filters(rounding: Rounding) -> FixedPoint:
    """Recursive filter, delays, literal gains and offsets: states without stated ranges."""
    diagram = Diagram("filters", 0.01)
    source = diagram.add(Inport("In"))
    smooth = diagram.add(
        DiscreteTransferFunction(
            "Smooth", numerator=(0.02, 0.04, 0.02), denominator=(1.0, -1.56, 0.64)
        )
    )
    memory = diagram.add(UnitDelay("Memory", initial=-0.5))
    older = diagram.add(UnitDelay("Older"))
    offset = diagram.add(Constant("Offset", value=-0.1))
    total = diagram.add(Sum("Total", signs="+-++"))
    scale = diagram.add(Gain("Scale", gain=-2.75))
    diagram.connect_chain(source, smooth, total, scale, diagram.add(Outport("Out")))
    diagram.connect_chain(source, memory, older)
    diagram.connect(memory, total, 1)
    diagram.connect(older, total, 2)
    diagram.connect(offset, total, 3)
    return to_fixed_point(diagram, FixedPointOptions({"In": 5.0}, rounding=rounding))


def slow_limit(accumulator_bits: int) -> FixedPoint:
    """A large gain and a limit at every second sample; what is held has another fraction."""
    diagram = Diagram("slow_limit", 0.01)
    large = Gain("Large", gain=9.0, sample_time=0.02)
    limit = Saturation("Limit", limit=4.0, sample_time=0.02)
    chain = (Inport("In"), large, limit, Gain("Small", gain=0.3), Outport("Out"))
    diagram.connect_chain(*map(diagram.add, chain))
    options = FixedPointOptions({"In": 1.0}, accumulator_bits=accumulator_bits)
    return to_fixed_point(diagram, options)


CASES = {
    f"{name}_{rounding.name.lower()}": case
    for rounding in Rounding
    for name, case in {
        "paper": fixed_pi(rounding),
        "filters": filters(rounding),
        **{m.name.lower(): anti_windup(m, rounding) for m in IntegrationMethod},
    }.items()
}
