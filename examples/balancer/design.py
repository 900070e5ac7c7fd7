# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""State feedback of NXTway-GS: from the published constants to the published gains to C.

`python design.py` writes generated/ and prints the figures; with `--results FILE` it also leaves
figures and step responses as JSON. Plant, weights and structure: Y. Yamamoto, NXTway-GS
Model-Based Design (2008), sections 3 and 5.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import control
import numpy as np
from ravenbrick.codegen import AdaBinding, NamedNumber, ada_binding, ada_package, generate_c
from ravenbrick.control import lqr, with_integrators, write_loop_results
from ravenbrick.model import (
    NXTWAY_GS,
    Diagram,
    DiscreteIntegrator,
    DiscreteTransferFunction,
    Gain,
    Inport,
    Outport,
    Parameter,
    Saturation,
    Sum,
)
from ravenbrick.project.robot import read_robot

PROJECT = Path(__file__).resolve().parent
ROBOT = read_robot(PROJECT)

SAMPLE_TIME_MS = ROBOT.period_ms("balance_task")
SAMPLE_TIME = SAMPLE_TIME_MS / 1000

# Wheel angle, pitch, their rates, integral of the wheel angle.
STATE_WEIGHTS = [1.0, 6e5, 1.0, 1.0, 4e2]
INPUT_WEIGHTS = [1e3, 1e3]

# "Suppress velocity gain because it fluctuates": the encoder's counts in it.
WHEEL_RATE_SHARE = 0.85

# Low-pass of the wheel angle before it is differentiated.
FILTER = 0.8

SUPPLY_VOLTAGE = ROBOT.battery.voltage.value


def gains() -> np.ndarray:
    """State feedback of one motor as generated, shape (5,): V per rad, rad, rad/s, rad/s, rad s."""
    plant = with_integrators(NXTWAY_GS.state_space(), [[1.0, 0.0, 0.0, 0.0]])
    feedback = lqr(plant, STATE_WEIGHTS, INPUT_WEIGHTS)
    scale = np.array([1.0, 1.0, WHEEL_RATE_SHARE, 1.0, 1.0])
    return np.asarray(feedback.gain[0] * scale).round(5)


def closed_loops(gain: np.ndarray) -> tuple[control.StateSpace, control.StateSpace]:
    """From the wanted to the true wheel angle (rad), continuous and sampled."""
    plant = with_integrators(NXTWAY_GS.state_space(), [[1.0, 0.0, 0.0, 0.0]])
    rows = np.vstack([gain, gain])
    wheel = np.eye(5)[:1]
    minus_integral = -np.eye(5)[:, 4:]

    def close(system: control.StateSpace, step: np.ndarray) -> control.StateSpace:
        entry = system.B @ rows[:, :1] + step
        return control.ss(system.A - system.B @ rows, entry, wheel, [[0.0]], system.dt)

    sampled = control.sample_system(plant, SAMPLE_TIME, "zoh")
    return close(plant, minus_integral), close(sampled, SAMPLE_TIME * minus_integral)


def open_loop(gain: np.ndarray) -> control.StateSpace:
    """The sampled loop cut at the motors' voltage, which is the same for both."""
    plant = with_integrators(NXTWAY_GS.state_space(), [[1.0, 0.0, 0.0, 0.0]])
    sampled = control.sample_system(plant, SAMPLE_TIME, "zoh")
    return control.ss(sampled.A, sampled.B.sum(axis=1, keepdims=True), gain, 0.0, sampled.dt)


def controller(gain: np.ndarray) -> Diagram:
    """From the wheels' angle against the body and the pitch rate to both motors' voltage."""
    diagram = Diagram("functional", SAMPLE_TIME)
    wheel = diagram.add(Inport("Wheel_Angle", unit="rad", description="mean, against the body"))
    rate = diagram.add(Inport("Pitch_Rate", unit="rad/s", description="gyro less its offset"))
    pitch = diagram.add(DiscreteIntegrator("Pitch", gain=SAMPLE_TIME))
    angle = diagram.add(Sum("Angle", signs="++"))
    slope = (1 - FILTER) / SAMPLE_TIME
    speed = diagram.add(
        DiscreteTransferFunction("Speed", numerator=(slope, -slope), denominator=(1.0, -FILTER))
    )
    integral = diagram.add(DiscreteIntegrator("Integral", gain=SAMPLE_TIME))
    demand = diagram.add(Sum("Demand", signs="+++++"))
    limit = Parameter("Saturation", SUPPLY_VOLTAGE, "V", "largest voltage, the battery's")
    limited = diagram.add(Saturation("Limited", limit=limit))
    output = diagram.add(Outport("motorvoltage", unit="V", description="of both motors"))
    pitch_out = diagram.add(Outport("bodypitch", unit="rad", description="of the body"))
    diagram.connect(rate, pitch)
    diagram.connect(pitch, pitch_out)
    diagram.connect(wheel, angle, 0)
    diagram.connect(pitch, angle, 1)
    diagram.connect_chain(angle, speed)
    diagram.connect_chain(angle, integral)
    terms = {"Angle": angle, "Pitch": pitch, "Speed": speed, "Rate": rate, "Integral": integral}
    units = ("V/rad", "V/rad", "V s/rad", "V s/rad", "V/(rad s)")
    for port, ((name, source), unit) in enumerate(zip(terms.items(), units, strict=True)):
        value = Parameter(f"K_{name}", float(-gain[port]), unit, f"gain of {name.lower()}")
        weighted = diagram.add(Gain(f"{name}_Gain", gain=value))
        diagram.connect(source, weighted)
        diagram.connect(weighted, demand, port)
    diagram.connect_chain(demand, limited, output)
    return diagram


def design() -> Diagram:
    """The controller as it is generated."""
    return controller(gains())


def main() -> None:
    """Design, generate, and print the figures."""
    parser = argparse.ArgumentParser(description="Design the balancing controller.")
    parser.add_argument("--results", type=Path, help="JSON file for figures and step responses")
    parser.add_argument("--generated", type=Path, default=PROJECT / "generated", help="C folder")
    arguments = parser.parse_args()
    gain = gains()
    code = generate_c(design())
    code.write(arguments.generated)
    numbers = (NamedNumber("Sample_Time_Ms", SAMPLE_TIME_MS, "Period of the balance task, ms."),)
    names = {"motorvoltage": "Motor_Voltage", "bodypitch": "Body_Pitch"}
    seen = AdaBinding("State_Feedback", names)
    packages = ada_package("Controller_Design", numbers)
    packages |= ada_binding(code.files["functional.h"], seen, "functional.h")
    for name, text in packages.items():
        (arguments.generated / name).write_text(text, encoding="utf-8")
    states = ("wheel_angle", "pitch", "wheel_rate", "pitch_rate", "wheel_angle_integral")
    figures = {f"gain_{name}": float(value) for name, value in zip(states, gain, strict=True)}
    poles = closed_loops(gain)[1].poles()
    figures["largest_sampled_pole"] = float(np.abs(poles).max())
    if arguments.results:
        loops = closed_loops(gain)
        write_loop_results(
            arguments.results, "balancer", loops, figures, 10.0, open_loop(gain), design()
        )
    for name, value in figures.items():
        print(f"{name:40} {value:.6g}")


if __name__ == "__main__":
    main()
