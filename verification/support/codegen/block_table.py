# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every block of the library with what it should compute, written down without the library."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import control
import numpy as np
from ravenbrick.control import kalman, observer_system
from ravenbrick.model import (
    Abs,
    ArcTangent,
    Backlash,
    Block,
    ComplementaryFilter,
    Constant,
    Conversion,
    CustomFunction,
    DataType,
    DeadZone,
    Delay,
    DeltaTransferFunction,
    Diagram,
    DiscreteIntegrator,
    DiscreteStateSpace,
    DiscreteTransferFunction,
    Gain,
    Inport,
    IntegrationMethod,
    LogicalOperator,
    LookupTable,
    MachineState,
    Merge,
    MinMax,
    MovingAverage,
    Outport,
    PidController,
    Product,
    Pulse,
    Quantiser,
    Ramp,
    RateLimit,
    RelationalOperator,
    Relay,
    RoundingFunction,
    Saturation,
    Sign,
    Sine,
    SquareRoot,
    StateMachine,
    Step,
    Sum,
    Switch,
    Transition,
    Trigonometry,
    UnitConversion,
    UnitDelay,
    ZeroOrderHold,
    ZeroPoleGain,
    state_space_block,
)
from scipy import signal
from scipy.linalg import solve_discrete_are

# From the input columns (steps, ports) to the output (steps).
Reference = Callable[[np.ndarray], np.ndarray]

MATRICES = (((0.9, 0.2), (-0.1, 0.7)), ((0.5, 0.0), (0.1, -0.3)), (1.0, -2.0), (0.0, 0.25))

# Every kind of section: real poles, a complex pair, an integrator, complex zeros on real poles.
SECTIONS = ZeroPoleGain(
    (-1.5 + 0.3j, -1.5 - 0.3j, -2.0, -0.2, -0.4 + 0.3j, -0.4 - 0.3j, -2.0),
    (-0.3 + 0.4j, -0.3 - 0.4j, -0.5, -0.6, -0.7, -0.4, 0.0),
    0.02,
    0.01,
)
# The middle one does not pass its input on at once.
DELAYED_SECTIONS = ZeroPoleGain((-2.0, 0.0), (-0.9, -0.5, -0.2), 0.5, 0.01)


def _by_roots(system: ZeroPoleGain) -> Reference:
    sections = signal.zpk2sos(1 + np.array(system.zeros), 1 + np.array(system.poles), system.gain)
    return lambda u: signal.sosfilt(sections, u[:, 0])


def _filtered(numerator: Sequence[float], denominator: Sequence[float]) -> Reference:
    return lambda u: signal.lfilter(numerator, denominator, u[:, 0])


def _recurrence(step: Callable[[float, np.ndarray], float], start: float) -> Reference:
    """The output follows from the last one and the inputs."""

    def run(u: np.ndarray) -> np.ndarray:
        values, last = [], start
        for row in u:
            last = step(last, row)
            values.append(last)
        return np.array(values)

    return run


def _delayed(length: int, initial: float) -> Reference:
    return lambda u: np.concatenate([np.full(length, initial), u[:, 0]])[: len(u)]


def _averaged(length: int) -> Reference:
    return _filtered([1 / length] * length, [1.0])


def _relay(last: float, row: np.ndarray) -> float:
    if row[0] >= 3.0:
        return 5.0
    return -1.0 if row[0] <= -2.0 else last


def _state_space(u: np.ndarray) -> np.ndarray:
    a, b, c, d = map(np.array, MATRICES)
    return signal.dlsim((a, b, c[np.newaxis], d[np.newaxis], 1.0), u, x0=[0.5, -0.5])[1][:, 0]


def _pid(u: np.ndarray) -> np.ndarray:
    error = u[:, 0]
    integral = signal.lfilter([0.0, 0.03], [1.0, -1.0], error)
    integral += signal.lfilter([0.0, 1.0], [1.0, -1.0], u[:, 1])
    derivative = 0.7 * signal.lfilter([1.0, -1.0], [1.0, -1.0 + 0.4], error)
    return 1.5 * error + integral + derivative


def _divided(u: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        return u[:, 0] / u[:, 1]


def _merged(last: float, row: np.ndarray) -> float:
    if row[0] >= 0.5:
        return row[1]
    return row[3] if row[2] >= 0.5 else last


def _quantised(u: np.ndarray) -> np.ndarray:
    return 0.75 * np.sign(u[:, 0]) * np.floor(np.abs(u[:, 0]) / 0.75 + 0.5)


def _machine(u: np.ndarray) -> np.ndarray:
    """Stopped, driving, waiting: a touch starts, low stops, waiting ends by itself."""
    state, since, outputs = "stopped", 0, []
    for touch, level in u:
        before = state
        if state == "stopped" and touch >= 2.0:
            state = "driving"
        elif state == "driving":
            if level < -3.0:
                state = "waiting"
            elif since >= 4 and touch > 5.0:
                state = "stopped"
        elif state == "waiting" and since >= 3:
            state = "stopped"
        since = since + 1 if state == before else 1
        outputs.append({"stopped": -1.0, "driving": 4.5, "waiting": 0.5}[state])
    return np.array(outputs)


# Angle and speed of a motor, driven by its voltage; the angle is measured.
MOTOR = control.ss([[1.0, 0.095], [0.0, 0.9]], [[0.02], [0.2]], [[1.0, 0.0]], [[0.0]], 0.01)
NOISES = [[0.01, 0.0], [0.0, 0.05]], [[0.08]]


def _kalman(u: np.ndarray) -> np.ndarray:
    """The predicted speed by the textbook's recurrence, its gain from the Riccati equation."""
    a, b, c = (np.asarray(m) for m in (MOTOR.A, MOTOR.B, MOTOR.C))
    process, measured = map(np.array, NOISES)
    spread = solve_discrete_are(a.T, c.T, process, measured)
    gain = a @ spread @ c.T @ np.linalg.inv(c @ spread @ c.T + measured)
    state, found = np.zeros(2), []
    for voltage, angle in u:
        found.append(state[1])
        state = a @ state + b[:, 0] * voltage + gain[:, 0] * (angle - (c @ state)[0])
    return np.array(found)


def _rows(count: int) -> np.ndarray:
    return np.arange(count, dtype=float)


TABLE: dict[str, tuple[Block, Reference]] = {
    "constant": (Constant("B", value=-2.5), lambda u: np.full(len(u), -2.5)),
    "gain": (Gain("B", gain=-0.3), lambda u: -0.3 * u[:, 0]),
    "unit_conversion": (
        UnitConversion("B", source="deg/s", target="rad/s"),
        lambda u: np.radians(u[:, 0]),
    ),
    "sum": (Sum("B", signs="+-+"), lambda u: u[:, 0] - u[:, 1] + u[:, 2]),
    "saturation": (Saturation("B", limit=4.0), lambda u: np.clip(u[:, 0], -4, 4)),
    "unit_delay": (UnitDelay("B", initial=0.5), _delayed(1, 0.5)),
    "delay": (Delay("B", length=7, initial=-1.5), _delayed(7, -1.5)),
    "forward_euler": (DiscreteIntegrator("B", gain=0.1), _filtered([0.0, 0.1], [1.0, -1.0])),
    "tustin": (
        DiscreteIntegrator("B", gain=0.1, method=IntegrationMethod.TUSTIN),
        _filtered([0.05, 0.05], [1.0, -1.0]),
    ),
    "backward_euler": (
        DiscreteIntegrator("B", gain=0.1, method=IntegrationMethod.BACKWARD_EULER),
        _filtered([0.1, 0.0], [1.0, -1.0]),
    ),
    "transfer_function": (
        DiscreteTransferFunction("B", numerator=(0.5, 0.2, -0.1), denominator=(1.0, -0.9, 0.3)),
        _filtered([0.5, 0.2, -0.1], [1.0, -0.9, 0.3]),
    ),
    "delta_transfer_function": (
        DeltaTransferFunction.of("B", SECTIONS),
        _by_roots(SECTIONS),
    ),
    "delayed_sections": (
        DeltaTransferFunction.of("B", DELAYED_SECTIONS),
        _filtered([0.0, 0.5, 0.0, -0.5], [1.0, -1.4, 0.53, -0.04]),
    ),
    "state_space": (
        DiscreteStateSpace(
            "B", a=MATRICES[0], b=MATRICES[1], c=MATRICES[2], d=MATRICES[3], initial=(0.5, -0.5)
        ),
        _state_space,
    ),
    "pid": (
        PidController(
            "B",
            proportional=1.5,
            integral_step=0.03,
            derivative_gain=0.7,
            filter_step=0.4,
            tracking=True,
        ),
        _pid,
    ),
    "moving_average": (MovingAverage("B", length=5), _averaged(5)),
    "complementary": (
        ComplementaryFilter("B", weight=0.9, step=0.02, initial=1.0),
        _recurrence(lambda last, row: 0.9 * (last + 0.02 * row[0]) + 0.1 * row[1], 1.0),
    ),
    "kalman": (
        state_space_block("B", observer_system(MOTOR, kalman(MOTOR, *NOISES)), output=1),
        _kalman,
    ),
    "dead_zone": (
        DeadZone("B", start=-2.0, end=3.0),
        lambda u: u[:, 0] - np.clip(u[:, 0], -2.0, 3.0),
    ),
    "rate_limit": (
        RateLimit("B", rising=2.0, falling=3.0, initial=1.0),
        _recurrence(lambda last, row: float(np.clip(row[0], last - 3.0, last + 2.0)), 1.0),
    ),
    "quantiser": (Quantiser("B", interval=0.75), _quantised),
    "relay": (Relay("B", on_above=3.0, off_below=-2.0, on_value=5.0, off_value=-1.0),
              _recurrence(_relay, -1.0)),
    "backlash": (
        Backlash("B", width=4.0, initial=0.5),
        _recurrence(lambda last, row: float(np.clip(last, row[0] - 2.0, row[0] + 2.0)), 0.5),
    ),
    "switch": (
        Switch("B", threshold=1.0),
        lambda u: np.where(u[:, 1] >= 1.0, u[:, 0], u[:, 2]),
    ),
    "equal": (RelationalOperator("B", operator="=="), lambda u: (u[:, 0] == u[:, 1]) * 1.0),
    "below": (RelationalOperator("B", operator="<"), lambda u: (u[:, 0] < u[:, 1]) * 1.0),
    "logic": (
        LogicalOperator("B", operator="NXOR", ports=3),
        lambda u: 1.0 - np.count_nonzero(u, axis=1) % 2,
    ),
    "all_true": (
        LogicalOperator("B", operator="NAND", ports=2),
        lambda u: 1.0 * np.any(u == 0, axis=1),
    ),
    "smallest": (MinMax("B", ports=3), lambda u: u.min(axis=1)),
    "largest": (MinMax("B", function="max"), lambda u: u.max(axis=1)),
    "size": (Abs("B"), lambda u: np.abs(u[:, 0])),
    "sign": (Sign("B"), lambda u: np.sign(u[:, 0])),
    "floor": (RoundingFunction("B"), lambda u: np.floor(u[:, 0])),
    "ceil": (RoundingFunction("B", function="ceil"), lambda u: np.ceil(u[:, 0])),
    "fix": (RoundingFunction("B", function="fix"), lambda u: np.fix(u[:, 0])),
    "product": (Product("B", operators="***"), lambda u: u.prod(axis=1)),
    "quotient": (Product("B", operators="*/"), _divided),
    "merge": (Merge("B", ports=4, initial=0.25), _recurrence(_merged, 0.25)),
    "switch_above": (
        Switch("B", threshold=1.0, criterion=">"),
        lambda u: np.where(u[:, 1] > 1.0, u[:, 0], u[:, 2]),
    ),
    "switch_unless": (
        Switch("B", threshold=0.0, criterion="~="),
        lambda u: np.where(u[:, 1] != 0.0, u[:, 0], u[:, 2]),
    ),
    "limits": (Saturation("B", limit=3.0, lower=-1.5), lambda u: np.clip(u[:, 0], -1.5, 3.0)),
    "staircase": (
        LookupTable("B", breakpoints=(-5.0, 0.0, 1.0), table=(2.0, -1.0, 4.0), interpolate=False),
        lambda u: np.array([2.0, -1.0, 4.0])[np.searchsorted([0.0, 1.0], u[:, 0], side="right")],
    ),
    "sine_of": (Trigonometry("B"), lambda u: np.sin(u[:, 0])),
    "cosine_of": (Trigonometry("B", function="cos"), lambda u: np.cos(u[:, 0])),
    "arc_tangent": (ArcTangent("B"), lambda u: np.arctan2(u[:, 0], u[:, 1] + 0.0)),
    "square_root": (SquareRoot("B"), lambda u: np.sqrt(np.maximum(u[:, 0], 0.0))),
    "ended_ramp": (
        Ramp("B", slope=0.5, at_sample=4, initial=1.0, last_sample=12),
        lambda u: 1.0 + 0.5 * np.clip(_rows(len(u)) - 4, 0, 8),
    ),
    "look_up": (
        LookupTable("B", breakpoints=(-5.0, 0.0, 1.0, 6.0), table=(2.0, -1.0, 4.0, 3.0)),
        lambda u: np.interp(u[:, 0], [-5.0, 0.0, 1.0, 6.0], [2.0, -1.0, 4.0, 3.0]),
    ),
    "look_up_on": (
        LookupTable("B", breakpoints=(-1.0, 1.0), table=(1.0, 2.0), extrapolate=True),
        lambda u: 1.5 + 0.5 * u[:, 0],
    ),
    "state_machine": (
        StateMachine(
            "B",
            machine_states=(
                MachineState("stopped", -1.0),
                MachineState("driving", 4.5),
                MachineState("waiting", 0.5),
            ),
            transitions=(
                Transition("stopped", "driving", 0, ">=", 2.0),
                Transition("driving", "waiting", 1, "<", -3.0),
                Transition("driving", "stopped", 0, ">", 5.0, after=4),
                Transition("waiting", "stopped", None, after=3),
            ),
            ports=2,
        ),
        _machine,
    ),
    "custom": (
        CustomFunction(
            "B",
            function=lambda a, b: a * b + a,
            c="return (a * b) + a;",
            ada="return A * B + A;",
        ),
        lambda u: u[:, 0] * u[:, 1] + u[:, 0],
    ),
    "hold": (
        ZeroOrderHold("B", sample_time=0.03),
        lambda u: u[3 * (np.arange(len(u)) // 3), 0],
    ),
    "slow_average": (
        MovingAverage("B", length=2, sample_time=0.02),
        lambda u: np.repeat(
            np.convolve(u[::2, 0], [0.5, 0.5])[: len(u[::2])], 2
        )[: len(u)],
    ),
    "sine": (
        Sine("B", amplitude=3.0, period=37),
        lambda u: 3.0 * np.sin(2 * math.pi * _rows(len(u)) / 37),
    ),
    "step": (
        Step("B", at_sample=10, before=-1.0, after=2.0),
        lambda u: np.where(_rows(len(u)) >= 10, 2.0, -1.0),
    ),
    "ramp": (
        Ramp("B", slope=0.5, at_sample=4, initial=1.0),
        lambda u: 1.0 + 0.5 * np.maximum(_rows(len(u)) - 4, 0),
    ),
    "pulse": (
        Pulse("B", amplitude=2.0, period=9, width=3),
        lambda u: np.where(_rows(len(u)) % 9 < 3, 2.0, 0.0),
    ),
}  # fmt: skip


def block_diagram(name: str, data_type: DataType = DataType.REAL32) -> Diagram:
    """One block of the table between inports `In0`.. and an outport; ports in `data_type`."""
    block = replace(TABLE[name][0], data_type=data_type)
    diagram = Diagram(name, 0.01)
    diagram.add(block)
    for port in range(max(len(block.input_types), 1)):
        source = diagram.add(Inport(f"In{port}", data_type))
        if block.input_types:
            diagram.connect(source, block, port)
    out = diagram.add(Outport("Out", data_type))
    if block.input_types:
        diagram.connect(block, out)
        return diagram
    total = diagram.add(Sum("Total", data_type, signs="++"))
    still = diagram.add(Saturation("Still", data_type, limit=0.0))
    diagram.connect(source, still)
    diagram.connect(block, total)
    diagram.connect(still, total, 1)
    diagram.connect(total, out)
    return diagram


def wide_diagram(name: str) -> Diagram:
    """The same in double precision with single-precision ports."""
    inner = block_diagram(name, DataType.REAL64)
    diagram = Diagram(f"wide_{name}", inner.sample_time)
    copies: dict[str, Block] = {}
    for block in inner.blocks:
        if isinstance(block, Inport):
            port = diagram.add(Inport(block.name))
            copies[block.name] = diagram.add(
                Conversion(f"{block.name}_Wide", DataType.REAL64, from_type=DataType.REAL32)
            )
            diagram.connect(port, copies[block.name])
        elif isinstance(block, Outport):
            narrow = diagram.add(Conversion(f"{block.name}_Narrow"))
            copies[block.name] = narrow
            diagram.connect(narrow, diagram.add(Outport(block.name)))
        else:
            copies[block.name] = diagram.add(block)
    for block in inner.blocks:
        for port_number in range(len(block.input_types)):
            source = inner.source(block, port_number)
            diagram.connect(copies[source.name], copies[block.name], port_number)
    return diagram
