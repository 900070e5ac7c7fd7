# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Plants and block diagrams."""

from __future__ import annotations

from ravenbrick.model.balancer import NXTWAY_GS, TwoWheeledBalancer
from ravenbrick.model.blocks import (
    Block,
    Constant,
    Conversion,
    DiscreteIntegrator,
    DiscreteTransferFunction,
    Gain,
    Inport,
    IntegrationMethod,
    Outport,
    Parameter,
    Saturation,
    Sum,
    UnitDelay,
)
from ravenbrick.model.diagram import Diagram, DiagramError
from ravenbrick.model.encoder import Encoder, SpeedWindow
from ravenbrick.model.execution import Execution
from ravenbrick.model.fixed_point import FixedPoint, FixedPointOptions, to_fixed_point
from ravenbrick.model.linearisation import linearise
from ravenbrick.model.motor import NXT_MOTOR, MotorParameters, SpeedLoop
from ravenbrick.model.number_format import FixedFormat, Interval, Rounding
from ravenbrick.model.program import DataType, Program

__all__ = [
    "NXTWAY_GS",
    "NXT_MOTOR",
    "Block",
    "Constant",
    "Conversion",
    "DataType",
    "Diagram",
    "DiagramError",
    "DiscreteIntegrator",
    "DiscreteTransferFunction",
    "Encoder",
    "Execution",
    "FixedFormat",
    "FixedPoint",
    "FixedPointOptions",
    "Gain",
    "Inport",
    "IntegrationMethod",
    "Interval",
    "MotorParameters",
    "Outport",
    "Parameter",
    "Program",
    "Rounding",
    "Saturation",
    "SpeedLoop",
    "SpeedWindow",
    "Sum",
    "TwoWheeledBalancer",
    "UnitDelay",
    "linearise",
    "to_fixed_point",
]
