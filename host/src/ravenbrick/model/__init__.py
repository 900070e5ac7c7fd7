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
from ravenbrick.model.blocks.continuous import (
    ContinuousStateSpace,
    CustomDerivatives,
    DryFriction,
    EncoderCount,
    Integrator,
    continuous_transfer_function,
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
from ravenbrick.model.blocks.time_functions import TimeFunction, white_noise
from ravenbrick.model.blocks.trigonometry import ArcTangent, SquareRoot, Trigonometry
from ravenbrick.model.diagram import Diagram, DiagramError
from ravenbrick.model.encoder import Encoder, SpeedWindow
from ravenbrick.model.fidelity import Fidelity, check_fidelity, fidelity
from ravenbrick.model.fixed_point import FixedPoint, FixedPointOptions, to_fixed_point
from ravenbrick.model.linear_system import LinearSystem
from ravenbrick.model.linearisation import linear_system, linearise
from ravenbrick.model.motor import NXT_MOTOR, MotorParameters, SpeedLoop
from ravenbrick.model.number_format import FixedFormat, Interval, Rounding
from ravenbrick.model.picture.svg import diagram_svg
from ravenbrick.model.program import DataType, Program
from ravenbrick.model.simulation.closed_loop import Simulation
from ravenbrick.model.simulation.execution import Execution
from ravenbrick.model.simulation.fmu_plant import FmuPlant
from ravenbrick.model.simulation.hybrid import Solver
from ravenbrick.model.simulation.plants import linear_plant, motor_plant, vehicle_plant
from ravenbrick.model.simulation.recording import Recording, Signal
from ravenbrick.model.structure.signals import BusCreator, BusSelector, Demux, Mux
from ravenbrick.model.structure.subsystem import Subsystem
from ravenbrick.model.structure.text_file import diagram_text, load_diagram, read_diagram
from ravenbrick.model.structure.units import UnitConversion
from ravenbrick.model.zero_pole_gain import ZeroPoleGain

__all__ = [
    "NXTWAY_GS",
    "NXT_MOTOR",
    "Abs",
    "ArcTangent",
    "Backlash",
    "Block",
    "BusCreator",
    "BusSelector",
    "ComplementaryFilter",
    "Constant",
    "ContinuousStateSpace",
    "Conversion",
    "CustomDerivatives",
    "CustomFunction",
    "DataType",
    "DeadZone",
    "Delay",
    "DeltaTransferFunction",
    "Demux",
    "Diagram",
    "DiagramError",
    "DiscreteIntegrator",
    "DiscreteStateSpace",
    "DiscreteTransferFunction",
    "DryFriction",
    "Encoder",
    "EncoderCount",
    "Execution",
    "Fidelity",
    "FixedFormat",
    "FixedPoint",
    "FixedPointOptions",
    "FmuPlant",
    "Gain",
    "Inport",
    "IntegrationMethod",
    "Integrator",
    "Interval",
    "LinearSystem",
    "LogicalOperator",
    "LookupTable",
    "MachineState",
    "Merge",
    "MinMax",
    "MotorParameters",
    "MovingAverage",
    "Mux",
    "Outport",
    "Parameter",
    "PidController",
    "Product",
    "Program",
    "Pulse",
    "Quantiser",
    "Ramp",
    "RateLimit",
    "Recording",
    "RelationalOperator",
    "Relay",
    "Rounding",
    "RoundingFunction",
    "Saturation",
    "Section",
    "Sign",
    "Signal",
    "Simulation",
    "Sine",
    "Solver",
    "SpeedLoop",
    "SpeedWindow",
    "SquareRoot",
    "StateMachine",
    "Step",
    "Subsystem",
    "Sum",
    "Switch",
    "TimeFunction",
    "Transition",
    "Trigonometry",
    "TwoWheeledBalancer",
    "UnitConversion",
    "UnitDelay",
    "ZeroOrderHold",
    "ZeroPoleGain",
    "check_fidelity",
    "continuous_transfer_function",
    "diagram_svg",
    "diagram_text",
    "fidelity",
    "linear_plant",
    "linear_system",
    "linearise",
    "load_diagram",
    "motor_plant",
    "read_diagram",
    "state_space_block",
    "to_fixed_point",
    "transfer_function_block",
    "vehicle_plant",
    "white_noise",
]
