# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""From the motor's constants to the controllers of NXT.Regulated_Motors, as generated Ada.

`python -m drivers.regulation.design` writes drivers/generated/ and prints the figures.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from ravenbrick import model
from ravenbrick.catalogue import part_values
from ravenbrick.codegen import NamedNumber, ada_package, generate_ada
from ravenbrick.control import (
    Design,
    LoopSpecification,
    finish_design,
    pi_by_lambda,
    pi_diagram,
    pi_with_estimator,
)

GENERATED = Path(__file__).resolve().parent.parent / "generated"

# A speed in the loop is the voltage that keeps it up without load.
DEGREES_PER_VOLT = round(math.degrees(model.NXT_MOTOR.gain), 1)

# The task runs every second exchange of the co-processor link.
SAMPLE_TIME_MS = 4

# One count over eight samples is 31 deg/s, 0.27 V in the loop.
SPEED_WINDOW = 8

# The new voltage leaves with the next exchange and takes 0.3 ms more.
ACTUATOR_DELAY = 0.0023

# Of the charged battery; at run time it is what is measured.
SUPPLY_VOLTAGE = part_values("batteries", "li_ion")["voltage"]

# A loaded motor reaches this with every battery.
LARGEST_SPEED = 700.0


def design() -> Design:
    """The speed controller: PI, settled in 0.15 s with the estimator and the delay in the loop."""
    loop = model.SpeedLoop(
        round(model.NXT_MOTOR.gain, 3), round(model.NXT_MOTOR.time_constant, 3), DEGREES_PER_VOLT
    )
    wanted = LoopSpecification(
        settling_time=0.15,
        overshoot=0.02,
        sample_time=SAMPLE_TIME_MS / 1000,
        window=SPEED_WINDOW,
        delay=ACTUATOR_DELAY,
    )
    continuous = pi_by_lambda(loop, wanted.settling_time)
    discrete = pi_with_estimator(loop, wanted).rounded(6)
    return finish_design("regulated motor", loop, wanted, continuous, discrete, SUPPLY_VOLTAGE)


def position_gain(result: Design) -> float:
    """Speed per angle to go, 1/s: a quarter of the speed loop's bandwidth keeps the two apart.

    Cascade control, Astrom and Hagglund, Advanced PID Control, section 12.4.
    """
    time_constant = result.specification.settling_time / math.log(50.0)
    return round(1.0 / (4.0 * time_constant), 2)


def position_diagram(gain: float) -> model.Diagram:
    """From the angle to go (deg) to the speed wanted (deg/s)."""
    diagram = model.Diagram("nxt_position_regulator", SAMPLE_TIME_MS / 1000)
    error = diagram.add(model.Inport("Angle_To_Go", unit="deg", description="target less angle"))
    parameter = model.Parameter("Gain", gain, "1/s", "speed per angle to go")
    proportional = diagram.add(model.Gain("Proportional", gain=parameter))
    limit = model.Parameter("Largest_Speed", LARGEST_SPEED, "deg/s", "that the motor keeps up")
    saturation = diagram.add(model.Saturation("Limited", limit=limit))
    wanted = diagram.add(model.Outport("Wanted_Speed", unit="deg/s", description="set-point"))
    diagram.connect_chain(error, proportional, saturation, wanted)
    return diagram


def generate(result: Design, folder: Path) -> None:
    """Write both controllers and the constants that the driver shares with them."""
    speed = pi_diagram(
        result.discrete, SUPPLY_VOLTAGE, result.loop.time_constant, "nxt_speed_regulator"
    )
    generate_ada(speed).write(folder)
    generate_ada(position_diagram(position_gain(result))).write(folder)
    numbers = (
        NamedNumber("Sample_Time_Ms", SAMPLE_TIME_MS, "Period of the regulators, ms."),
        NamedNumber("Speed_Window", SPEED_WINDOW, "Samples that a speed is measured over."),
        NamedNumber("Speed_Per_Volt", DEGREES_PER_VOLT, "Of a motor without load, (deg/s)/V."),
    )
    for name, text in ada_package("Nxt_Regulation_Design", numbers).items():
        (folder / name).write_text(text, encoding="utf-8")


def main() -> None:
    """Design, generate, and print the figures."""
    parser = argparse.ArgumentParser(description="Design the regulated motors.")
    parser.add_argument("--generated", type=Path, default=GENERATED, help="folder for the Ada")
    arguments = parser.parse_args()
    result = design()
    generate(result, arguments.generated)
    for name, value in {**result.figures(), "position_gain": position_gain(result)}.items():
        print(f"{name:40} {value:.6g}")


if __name__ == "__main__":
    main()
