# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Whole controllers as diagrams, each with its robot, what it is told, and what it must achieve."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import control
import numpy as np
from ravenbrick.control import LoopSpecification, dlqr, kalman, observer_system, pi_with_estimator
from ravenbrick.control.synthesis.controller import pi_diagram
from ravenbrick.model import (
    NXT_MOTOR,
    NXTWAY_GS,
    Abs,
    Block,
    Constant,
    Diagram,
    Gain,
    Inport,
    LookupTable,
    MachineState,
    MotorParameters,
    Outport,
    Product,
    Saturation,
    SpeedLoop,
    StateMachine,
    Subsystem,
    Sum,
    Transition,
    UnitDelay,
    state_space_block,
)

__all__ = ["ARM", "CONTROLLERS", "DrivenController"]


@dataclass(frozen=True)
class DrivenController:
    """A controller and all that a project of its own needs besides.

    `inputs` and `outputs` are the devices of its ports, `ranges` what fixed point asks for,
    `robot` texts of robot.toml with what takes their place, `scenario` inputs and criteria.
    """

    diagram: Callable[[], Diagram]
    inputs: Mapping[str, str]
    outputs: Mapping[str, str]
    ranges: Mapping[str, float]
    scenario: str
    robot: Mapping[str, str]
    speed_window: int = 8


def _connected(diagram: Diagram, blocks: tuple[Block, ...], lines: str) -> Diagram:
    """The blocks, joined by lines of `source target port` with commas between."""
    by_name = {block.name: diagram.add(block) for block in blocks}
    for line in lines.split(","):
        source, target, port = line.split()
        name, _, output = source.partition(".")
        diagram.connect(by_name[name], by_name[target], int(port), output=int(output or 1) - 1)
    return diagram


def mixed_rates() -> Diagram:
    """A Kalman filter and a speed loop at 5 ms; a table and a state machine at 20 ms."""
    fast, slow = 0.005, 0.02
    a, c = np.array([[1.0, fast], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    gain = kalman(control.ss(a, np.zeros((2, 1)), c, 0, fast), [1e-2, 4e3], [0.3]).gain
    speed = control.ss(a - gain @ c, gain, [[0.0, 1.0]], [[0.0]], fast)
    machine = StateMachine(
        "Mode", sample_time=slow,
        machine_states=(MachineState("resting", 0.0), MachineState("driving", 1.0)),
        transitions=(Transition("resting", "driving", 0, ">=", 6.0),
                     Transition("driving", "resting", 0, "<", 2.0, after=5)),
    )  # fmt: skip
    table = LookupTable("Shape", breakpoints=(-90.0, -10.0, 10.0, 90.0),
                        table=(-400.0, -60.0, 60.0, 400.0), sample_time=slow)  # fmt: skip
    blocks = (
        Inport("wanted"), Inport("angle"), Sum("Away", signs="+-", sample_time=slow), table,
        Abs("Size", sample_time=slow), machine, Product("Allowed", sample_time=slow),
        state_space_block("Speed", speed), Sum("Error", signs="+-"), Gain("Kp", gain=0.08),
        Gain("Kf", gain=0.11), Sum("Both"), Saturation("Cut", limit=90.0), Outport("duty"),
        Outport("estimate"),
    )  # fmt: skip
    return _connected(
        Diagram("functional", fast),
        blocks,
        "wanted Away 0, angle Away 1, Away Shape 0, Away Size 0, Size Mode 0, Shape Allowed 0,"
        "Mode Allowed 1, angle Speed 0, Allowed Error 0, Speed Error 1, Error Kp 0, Allowed Kf 0,"
        "Kp Both 0, Kf Both 1, Both Cut 0, Cut duty 0, Speed estimate 0",
    )


# A rod of 30 cm and 50 g on the motor's shaft: m l^2 / 3.
ARM_INERTIA = 0.0015
ARM = MotorParameters(
    NXT_MOTOR.torque_constant, NXT_MOTOR.electric_constant, NXT_MOTOR.resistance,
    NXT_MOTOR.viscous_friction, NXT_MOTOR.inertia + ARM_INERTIA, "the NXT motor with a rod",
)  # fmt: skip
ARM_SPEED_WINDOW = 4


def cascade_arm() -> Diagram:
    """Position of an arm: a proportional loop at 20 ms around a PI speed loop at 5 ms.

    Seen from the outer loop the inner one is a lag; a gain of a quarter of its reciprocal time
    constant gives a damping of 1.
    """
    fast, slow, settling = 0.005, 0.02, 0.3
    specification = LoopSpecification(settling, 0.1, fast, ARM_SPEED_WINDOW, 0.004)
    inner = pi_with_estimator(SpeedLoop.of_motor(ARM, 1.0), specification)
    lag = settling / 4
    blocks = (
        Inport("wanted"), Inport("angle"), Inport("speed"),
        Sum("Away", signs="+-", sample_time=slow),
        Gain("Position", gain=1 / (4 * lag), sample_time=slow),
        Saturation("Fastest", limit=400.0, sample_time=slow),
        Subsystem("Inner", diagram=pi_diagram(inner, 7.0, 2 * lag)),
        Outport("voltage"),
    )  # fmt: skip
    return _connected(
        Diagram("functional", fast),
        blocks,
        "wanted Away 0, angle Away 1, Away Position 0, Position Fastest 0, Fastest Inner 0,"
        "speed Inner 1, Inner voltage 0",
    )


BALANCE_TIME = 0.004
COMMAND_DELAY = 0.0025
"""From a sample to the new voltage, as `sample_timing` measures it on the brick."""
GYRO_AT_REST = 600.0
"""As a data sheet says; the brick's own gyro has another, which the filter finds."""


def _body(seconds: float) -> control.StateSpace:
    """NXTway-GS over a time with the same voltage at both motors; degrees and volts."""
    plant = NXTWAY_GS.state_space()
    entry = np.degrees(plant.B.sum(axis=1, keepdims=True))
    both = control.ss(plant.A, entry, np.eye(4), np.zeros((4, 1)))
    return control.sample_system(both, seconds, "zoh")


def lqg_balancer() -> Diagram:
    """NXTway-GS held upright by optimal feedback of a Kalman filter's estimates.

    The filter sees the wheels' angle against the body and the gyro, whose reading may be some
    milliseconds old: that counts as noise. Its fifth state is the gyro's error at rest; the
    feedback's fifth state is the voltage of the sample before, which lasts until the new one
    arrives. The filter runs from the start; the motors do while the touch sensor is pressed.
    """
    body, rest = _body(BALANCE_TIME), _body(BALANCE_TIME - COMMAND_DELAY)
    before, now = rest.A @ _body(COMMAND_DELAY).B, rest.B
    held = np.zeros((5, 5))
    held[:4] = np.hstack([body.A, before])
    delayed = control.ss(held, np.vstack([now, [1.0]]), np.eye(5), np.zeros((5, 1)), BALANCE_TIME)
    weights = np.array([400.0, 6e5, 1.0, 1.0, 0.0]) * math.radians(1) ** 2
    gain = dlqr(delayed, weights, [2e3]).gain[0]
    a = np.eye(5)
    a[:4, :4] = body.A
    entry = np.vstack([np.hstack([now, before]), np.zeros((1, 2))])
    sensors = [[1.0, -1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0, 1.0]]
    seen = control.ss(a, entry, sensors, np.zeros((2, 2)), BALANCE_TIME)
    whole = observer_system(seen, kalman(seen, [1e-4, 1e-4, 1.0, 0.2, 1e-3], [0.3, 3.0]))
    shown = [[*-gain[:4], 0.0], [0.0, 1.0, 0.0, 0.0, 0.0]]
    estimate = control.ss(whole.A, whole.B, shown, np.zeros((2, 4)), BALANCE_TIME)
    blocks = (
        Inport("left"), Inport("right"), Inport("gyro"), Inport("go"), Sum("Wheels"),
        Gain("Mean", gain=0.5), Constant("Rest", value=GYRO_AT_REST), Sum("Rate", signs="+-"),
        state_space_block("Filter", estimate), UnitDelay("Before"),
        Gain("Past", gain=-float(gain[4])), Sum("Demand"), Product("Allowed"),
        Saturation("Cut", limit=7.0), Outport("voltage_left"), Outport("voltage_right"),
        Outport("pitch"),
    )  # fmt: skip
    return _connected(
        Diagram("functional", BALANCE_TIME),
        blocks,
        "left Wheels 0, right Wheels 1, Wheels Mean 0, gyro Rate 0, Rest Rate 1, Cut Before 0,"
        "Cut Filter 0, Before Filter 1, Mean Filter 2, Rate Filter 3, Filter.1 Demand 0,"
        "Before Past 0, Past Demand 1, Demand Allowed 0, go Allowed 1, Allowed Cut 0,"
        "Cut voltage_left 0, Cut voltage_right 0, Filter.2 pitch 0",
    )


def _inputs(*rows: tuple[float, str, float]) -> str:
    return "".join(
        f'[[inputs]]\nat_ms = {at}\ninput = "{name}"\nvalue = {value}\n' for at, name, value in rows
    )


def _scenario(duration_ms: int, inputs: str, *criteria: str) -> str:
    head = f'schema_version = 1\nname = "start"\nseed = 1\nduration_ms = {duration_ms}\n'
    wanted = (*criteria, "deadlines met", "no fault")
    return head + inputs + "".join(f'[[criteria]]\nexpect = "{one}"\n' for one in wanted)


_WANTED = "variable.controller_wanted:f32"
CONTROLLERS = {
    "mixed-rate": DrivenController(
        mixed_rates,
        {"angle": "motor.B.angle", "wanted": "200"},
        {"duty": "motor.B.duty"},
        {"wanted": 720.0, "angle": 720.0, "Speed": 2000.0},
        _scenario(
            2_500,
            _inputs((1_000, _WANTED, -90)),
            "motor.B.angle between 194 and 206 deg from 0.98 s to 1 s",
            "motor.B.angle between -96 and -84 deg after 2.4 s",
        ),
        {},
    ),
    "cascade arm": DrivenController(
        cascade_arm,
        {"angle": "motor.B.angle", "speed": "motor.B.speed", "wanted": "0"},
        {"voltage": "motor.B.voltage"},
        {"wanted": 360.0, "angle": 360.0, "speed": 1500.0, "Inner_Integral": 20.0},
        _scenario(
            6_000,
            _inputs((500, _WANTED, 90), (2_500, "motor.B.load_torque", 0.1), (4_000, _WANTED, -45)),
            "motor.B.angle at most 92 deg",
            "motor.B.angle between 88 and 92 deg from 1.4 s to 2.5 s",
            "motor.B.angle at least 75 deg from 2.5 s to 4 s",
            "motor.B.angle between 88 and 92 deg from 3.6 s to 4 s",
            "motor.B.angle between -47 and -43 deg from 5.2 s to 6 s",
        ),
        {
            'motor = "nxt"': 'motor = "arm"',
            "[body]": f"""[motors.arm]
catalogue = "nxt"
inertia = {{ value = {ARM.inertia}, unit = "kg m^2", tolerance = 1e-5, source = "motor and rod" }}

[body]""",
        },
        ARM_SPEED_WINDOW,
    ),
    "LQG balancer": DrivenController(
        lqg_balancer,
        {"left": "motor.B.angle", "right": "motor.C.angle", "gyro": "gyro.4", "go": "touch.1"},
        {"voltage_left": "motor.B.voltage", "voltage_right": "motor.C.voltage"},
        {
            "left": 1000.0,
            "right": 1000.0,
            "gyro": 1023.0,
            "go": 1.0,
            "Filter_DSTATE1": 1000.0,
            "Filter_DSTATE2": 60.0,
            "Filter_DSTATE3": 2000.0,
            "Filter_DSTATE4": 500.0,
            "Filter_DSTATE5": 100.0,
        },
        _scenario(
            22_000,
            _inputs(
                (2_000, "touch.1", 1),
                (2_000, "body.held", 0),
                (8_000, "body.push", 1.0),
                (8_100, "body.push", 0.0),
                (15_000, "body.push", -1.0),
                (15_100, "body.push", 0.0),
            ),
            "body.pitch between -12 and 12 deg",
            "body.pitch between -2 and 2 deg from 6 s to 8 s",
            "body.pitch between -2 and 2 deg after 20 s",
            "body.x between -0.3 and 0.3 m",
            "body.x between -0.05 and 0.05 m after 20 s",
        ),
        {
            'motor = "nxt"': 'motor = "nxtway"',
            'device = "gyro"': 'device = "gyro"\naxis = "pitch"\nrest = { value = 605.4, '
            'unit = "counts", tolerance = 20.0, source = "NXTway-GS sample data" }',
            'kind = "bench"': 'catalogue = "nxtway"\nleft = "B"\nright = "C"',
        },
    ),
}
