# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Plants and block diagrams."""

from __future__ import annotations

from ravenbrick.model.balancer import NXTWAY_GS, TwoWheeledBalancer
from ravenbrick.model.blocks.basic import (
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
from ravenbrick.model.blocks.dynamic import (
    ComplementaryFilter,
    Delay,
    DiscreteStateSpace,
    MovingAverage,
    PidController,
    state_space_block,
)
from ravenbrick.model.blocks.logic import (
    CustomFunction,
    MachineState,
    StateMachine,
    Transition,
    ZeroOrderHold,
)
from ravenbrick.model.blocks.nonlinear import (
    Backlash,
    DeadZone,
    LookupTable,
    Quantiser,
    RateLimit,
    Relay,
    Switch,
)
from ravenbrick.model.blocks.relational import (
    Abs,
    LogicalOperator,
    Merge,
    MinMax,
    Product,
    RelationalOperator,
    RoundingFunction,
    Sign,
)
from ravenbrick.model.blocks.sections import (
    DeltaTransferFunction,
    Section,
    transfer_function_block,
)
from ravenbrick.model.blocks.sources import Pulse, Ramp, Sine, Step
from ravenbrick.model.blocks.trigonometry import ArcTangent, SquareRoot, Trigonometry
from ravenbrick.model.diagram import Diagram, DiagramError
from ravenbrick.model.encoder import Encoder, SpeedWindow
from ravenbrick.model.execution import Execution
from ravenbrick.model.fidelity import Fidelity, check_fidelity, fidelity
from ravenbrick.model.fixed_point import FixedPoint, FixedPointOptions, to_fixed_point
from ravenbrick.model.linear_system import LinearSystem
from ravenbrick.model.linearisation import linear_system, linearise
from ravenbrick.model.motor import NXT_MOTOR, MotorParameters, SpeedLoop
from ravenbrick.model.number_format import FixedFormat, Interval, Rounding
from ravenbrick.model.program import DataType, Program
from ravenbrick.model.zero_pole_gain import ZeroPoleGain

__all__ = [
    "NXTWAY_GS",
    "NXT_MOTOR",
    "Abs",
    "ArcTangent",
    "Backlash",
    "Block",
    "ComplementaryFilter",
    "Constant",
    "Conversion",
    "CustomFunction",
    "DataType",
    "DeadZone",
    "Delay",
    "DeltaTransferFunction",
    "Diagram",
    "DiagramError",
    "DiscreteIntegrator",
    "DiscreteStateSpace",
    "DiscreteTransferFunction",
    "Encoder",
    "Execution",
    "Fidelity",
    "FixedFormat",
    "FixedPoint",
    "FixedPointOptions",
    "Gain",
    "Inport",
    "IntegrationMethod",
    "Interval",
    "LinearSystem",
    "LogicalOperator",
    "LookupTable",
    "MachineState",
    "Merge",
    "MinMax",
    "MotorParameters",
    "MovingAverage",
    "Outport",
    "Parameter",
    "PidController",
    "Product",
    "Program",
    "Pulse",
    "Quantiser",
    "Ramp",
    "RateLimit",
    "RelationalOperator",
    "Relay",
    "Rounding",
    "RoundingFunction",
    "Saturation",
    "Section",
    "Sign",
    "Sine",
    "SpeedLoop",
    "SpeedWindow",
    "SquareRoot",
    "StateMachine",
    "Step",
    "Sum",
    "Switch",
    "Transition",
    "Trigonometry",
    "TwoWheeledBalancer",
    "UnitDelay",
    "ZeroOrderHold",
    "ZeroPoleGain",
    "check_fidelity",
    "fidelity",
    "linear_system",
    "linearise",
    "state_space_block",
    "to_fixed_point",
    "transfer_function_block",
]
