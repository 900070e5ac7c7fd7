# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""From the motor's constants to the controller in C.

`python design.py` writes generated/ and prints the figures; with `--results FILE` it also leaves
figures and step responses as JSON.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ravenbrick.codegen import NamedNumber, ada_package, generate_c
from ravenbrick.control import (
    Design,
    LoopSpecification,
    finish_design,
    pi_by_lambda,
    pi_with_estimator,
)
from ravenbrick.model import NXT_MOTOR, SpeedLoop
from ravenbrick.project.robot import read_robot
from ravenbrick.simulink import import_simulink

PROJECT = Path(__file__).resolve().parent
ROBOT = read_robot(PROJECT)
FIGURE_5 = PROJECT / "models" / "figure5.slx"

# Figure 4: 116 degrees/s correspond to 1 V.
DEGREES_PER_VOLT = ROBOT.degrees_per_volt()

# Section 5.3: the period of Control_Task, about a tenth of the motor's time constant.
SAMPLE_TIME_MS = ROBOT.period_ms("control_task")

# Section 5.2: the speed is the difference of two consecutive readings over the elapsed time. At
# 4 ms a count of 1 degree is 2.155 V in the loop. With 8, the difference spans eight periods, as
# in examples/vehicle: a count is 0.269 V, and the gains below follow.
SPEED_WINDOW = 1

# From the reading of the encoders to the motor's new voltage: 2.0 to 2.7 ms on the virtual brick.
ACTUATOR_DELAY = 0.0021

# Of the charged battery; at run time the application sets it to what it measures.
SUPPLY_VOLTAGE = ROBOT.battery.voltage.value


def design() -> Design:
    """The paper's section 5.2: one PI controller for both wheels."""
    # Equations 1 to 3 with table 1, to the digits of figure 4.
    gain = round(NXT_MOTOR.gain, 3)  # 2.029 rad/s per V
    time_constant = round(NXT_MOTOR.time_constant, 3)  # 0.037 s

    # Figure 4: PI, motor, speed as volts.
    loop = SpeedLoop(gain, time_constant, DEGREES_PER_VOLT)

    # Section 5.4: 400 ms with almost no overshoot.
    wanted = LoopSpecification(
        settling_time=0.4,
        overshoot=0.005,
        sample_time=SAMPLE_TIME_MS / 1000,
        window=SPEED_WINDOW,
        delay=ACTUATOR_DELAY,
    )

    # Gains in continuous time: the controller's zero cancels the motor's pole.
    continuous = pi_by_lambda(loop, wanted.settling_time)

    # Section 5.3: gains for the sampled loop, with the difference and the delay in it.
    discrete = pi_with_estimator(loop, wanted).rounded(6)

    return finish_design("paper", loop, wanted, continuous, discrete, SUPPLY_VOLTAGE)


def generate(result: Design, folder: Path) -> None:
    """Section 5.4: figure 5 with the tuned gains in C, and the design's constants in Ada."""
    variables = {
        "Kp": result.discrete.proportional,
        "Ki": result.discrete.gains.integral,
        "battery": SUPPLY_VOLTAGE,
    }
    sample_time = SAMPLE_TIME_MS / 1000
    model = import_simulink(FIGURE_5, sample_time, variables, name="functional")
    generate_c(model, only_used=True).write(folder)
    numbers = (
        NamedNumber("Sample_Time_Ms", SAMPLE_TIME_MS, "Period of the control task, ms."),
        NamedNumber("Speed_Window", SPEED_WINDOW, "Samples that a speed is measured over."),
        NamedNumber("Speed_Per_Volt", DEGREES_PER_VOLT, "Of a motor without load, (deg/s)/V."),
    )
    packages = ada_package("Controller_Design", numbers)
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
