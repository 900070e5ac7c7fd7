# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""From the motor's constants to the controller in C.

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
from ravenbrick.model import NXT_MOTOR, SpeedLoop
from ravenbrick.project.robot import read_robot

PROJECT = Path(__file__).resolve().parent
ROBOT = read_robot(PROJECT)

# The fed-back speed is stated in volts: a motor without load turns with 116 deg/s per volt.
DEGREES_PER_VOLT = ROBOT.degrees_per_volt()

# Period of Control_Task, 4 ms: about a tenth of the motor's time constant.
SAMPLE_TIME_MS = ROBOT.period_ms("control_task")

# One encoder count is 1 degree. Over one sample that is 250 deg/s = 2.155 V in the loop; over
# eight samples 0.269 V. Then a count moves the motor voltage by Kp * 0.269 V = 0.085 V, about one
# percent of duty cycle, which is all that the motor output can resolve.
SPEED_WINDOW = 8

# The co-processor task sends a new motor voltage in the middle of the control period; the transfer
# takes another 0.3 ms.
ACTUATOR_DELAY = 0.0023

# Of a step of the set-point, to within 2 %.
SETTLING_TIME = 0.4

# Of the charged battery; at run time the application sets it to what it measures.
SUPPLY_VOLTAGE = ROBOT.battery.voltage.value


def design() -> Design:
    """Design the speed controller of both wheels."""
    # 1. The motor as a transfer function K / (tau s + 1), to the digits that the paper keeps.
    gain = round(NXT_MOTOR.gain, 3)  # 2.029 rad/s per V
    time_constant = round(NXT_MOTOR.time_constant, 3)  # 0.037 s

    # 2. The loop: PI, motor, speed as volts.
    loop = SpeedLoop(gain, time_constant, DEGREES_PER_VOLT)

    # 3. What it must do, and what is in it besides the motor.
    wanted = LoopSpecification(
        settling_time=SETTLING_TIME,
        overshoot=0.005,
        sample_time=SAMPLE_TIME_MS / 1000,
        window=SPEED_WINDOW,
        delay=ACTUATOR_DELAY,
    )

    # 4. Gains in continuous time: the controller's zero cancels the motor's pole.
    continuous = pi_by_lambda(loop, wanted.settling_time)

    # 5. Gains for the sampled loop, with the speed estimate and the delay in it.
    discrete = pi_with_estimator(loop, wanted).rounded(6)

    # 6. Simulation with encoder counts and single precision, as on the brick.
    return finish_design("vehicle", loop, wanted, continuous, discrete, SUPPLY_VOLTAGE)


def generate(result: Design, folder: Path) -> None:
    """Write the controller in C, and what the application sees of it: calls and constants."""
    code = generate_c(result.controller, only_used=True)
    code.write(folder)
    numbers = (
        NamedNumber("Sample_Time_Ms", SAMPLE_TIME_MS, "Period of the control task, ms."),
        NamedNumber("Speed_Window", SPEED_WINDOW, "Samples that a speed is measured over."),
        NamedNumber("Speed_Per_Volt", DEGREES_PER_VOLT, "Of a motor without load, (deg/s)/V."),
    )
    seen = AdaBinding(
        "Speed_Controller",
        names={"correctedvoltage": "Corrected_Voltage"},
        types={"V": "Quantities.Volts"},
    )
    packages = ada_package("Controller_Design", numbers)
    packages |= ada_binding(code.files["functional.h"], seen, "functional.h")
    for name, text in packages.items():
        (folder / name).write_text(text, encoding="utf-8")


def main() -> None:
    """Design, generate, and print the figures."""
    parser = argparse.ArgumentParser(description="Design the vehicle's speed controller.")
    parser.add_argument("--results", type=Path, help="JSON file for figures and step responses")
    parser.add_argument("--generated", type=Path, default=PROJECT / "generated", help="C folder")
    arguments = parser.parse_args()
    result = design()
    generate(result, arguments.generated)
    if arguments.results:
        result.write_results(arguments.results)
    for name, value in result.figures().items():
        print(f"{name:40} {value:.6g}")


if __name__ == "__main__":
    main()
