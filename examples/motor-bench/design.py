# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed controller of the motor, and the outer loop that holds an angle.

`python design.py` writes generated/ and prints the figures; with `--results FILE` it also leaves
figures and step responses as JSON.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ravenbrick.codegen import AdaBinding, NamedNumber, ada_binding, ada_package, generate_c
from ravenbrick.control import (
    Design,
    LoopSpecification,
    finish_design,
    pi_by_lambda,
    pi_with_estimator,
)
from ravenbrick.model import MotorParameters, SpeedLoop
from ravenbrick.project.robot import read_robot

PROJECT = Path(__file__).resolve().parent
ROBOT = read_robot(PROJECT)

DEGREES_PER_VOLT = ROBOT.degrees_per_volt()
SAMPLE_TIME_MS = ROBOT.period_ms("control_task")
SPEED_WINDOW = 8
ACTUATOR_DELAY = 0.0023
SUPPLY_VOLTAGE = ROBOT.battery.voltage.value
SETTLING_TIME = 0.4


def design() -> Design:
    """A PI controller of the speed with estimator and delay in the loop."""
    motor = MotorParameters.of_values(ROBOT.motor_values("B"), "robot.toml")
    loop = SpeedLoop.of_motor(motor, DEGREES_PER_VOLT)
    wanted = LoopSpecification(
        settling_time=SETTLING_TIME,
        overshoot=0.005,
        sample_time=SAMPLE_TIME_MS / 1000,
        window=SPEED_WINDOW,
        delay=ACTUATOR_DELAY,
    )
    continuous = pi_by_lambda(loop, wanted.settling_time)
    discrete = pi_with_estimator(loop, wanted).rounded(6)
    return finish_design("motor-bench", loop, wanted, continuous, discrete, SUPPLY_VOLTAGE)


def position_gain() -> float:
    """Speed per angle error in 1/s that just does not overshoot.

    The closed speed loop is nearly 1 / (tau s + 1) with tau a quarter of its 2 % settling time;
    with an integrator behind it, the gain 1 / (4 tau) makes both poles of the outer loop equal.
    """
    return 1.0 / (4 * SETTLING_TIME / 4)


def main() -> None:
    """Design, generate, and print the figures."""
    parser = argparse.ArgumentParser(description="Design the speed and position controllers.")
    parser.add_argument("--results", type=Path, help="JSON file for figures and step responses")
    parser.add_argument("--generated", type=Path, default=PROJECT / "generated", help="C folder")
    arguments = parser.parse_args()
    result = design()
    code = generate_c(result.controller)
    code.write(arguments.generated)
    numbers = (
        NamedNumber("Sample_Time_Ms", SAMPLE_TIME_MS, "Period of the control task, ms."),
        NamedNumber("Speed_Window", SPEED_WINDOW, "Samples that a speed is measured over."),
        NamedNumber("Speed_Per_Volt", DEGREES_PER_VOLT, "Of a motor without load, (deg/s)/V."),
        NamedNumber("Position_Gain", position_gain(), "Speed per error of the angle, 1/s."),
    )
    seen = AdaBinding(
        "Speed_Controller",
        names={
            "correctedvoltage": "Corrected_Voltage",
            "Kp": "Proportional_Gain",
            "Ki_Ts": "Integral_Gain_Per_Job",
            "Kt_Ts": "Tracking_Gain_Per_Job",
        },
    )
    packages = ada_package("Controller_Design", numbers)
    packages |= ada_binding(code.files["functional.h"], seen, "functional.h")
    for name, text in packages.items():
        (arguments.generated / name).write_text(text, encoding="utf-8")
    if arguments.results:
        result.write_results(arguments.results)
    for name, value in result.figures().items():
        print(f"{name:40} {value:.6g}")


if __name__ == "__main__":
    main()
