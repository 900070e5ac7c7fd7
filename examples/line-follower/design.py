# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Steering of the line follower: geometry to poles to C.

`python design.py` writes generated/ and prints the figures; with `--results FILE` it also leaves
figures and step responses as JSON.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import control
from ravenbrick.codegen import AdaBinding, NamedNumber, ada_binding, ada_package, generate_c
from ravenbrick.control import write_loop_results
from ravenbrick.model import (
    NXT_MOTOR,
    Diagram,
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

SAMPLE_TIME_MS = ROBOT.period_ms("control_task")
SAMPLE_TIME = SAMPLE_TIME_MS / 1000

# The chassis, and the sensor before the axle.
WHEEL_RADIUS = ROBOT.body.quantities["wheel_radius"].value
TRACK = ROBOT.body.quantities["track"].value
MOUNT = ROBOT.sensor_ports["3"].mount
assert MOUNT is not None
SENSOR_ARM = MOUNT.x

# Cruise: half of the battery's 8 V less friction, about 0.23 m/s.
CRUISE_VOLTAGE = 4.0

# The spot of 8 mm crosses the edge: brightness, 0 on black to 1 on white, per m.
EDGE_SLOPE = 1.0 / 0.008

# The sensor's arm gives the damping: no derivative is needed. With more than critical damping the
# gain is high enough for a half circle of 0.3 m radius, see `curve_error`.
DAMPING = 1.5

# The light reading is that of the last frame of the co-processor, and half a period old.
READING_DELAY_SAMPLES = 1


def plant(speed: float) -> control.TransferFunction:
    """From the difference of the wheels' voltages (V) to the sensor's offset (m).

    Yaw rate w = r K u / track; the offset e of a sensor at `arm` before the axle moves with
    e' = v psi + arm w, psi' = w. The motors' time constant is neglected.
    """
    gain = WHEEL_RADIUS * NXT_MOTOR.gain / TRACK
    return control.tf([gain * SENSOR_ARM, gain * speed], [1.0, 0.0, 0.0])


def proportional_gain(speed: float) -> float:
    """V per brightness such that s^2 + s g arm k + g v k has the wanted damping.

    g = r K / track; 2 D w = w^2 arm / v, so w = 2 D v / arm and k = w^2 / (g v).
    """
    gain = WHEEL_RADIUS * NXT_MOTOR.gain / TRACK
    frequency = 2 * DAMPING * speed / SENSOR_ARM
    return frequency**2 / (gain * speed) / EDGE_SLOPE


def curve_error(speed: float, gain: float, radius: float) -> float:
    """Difference of brightness that steers around a curve; must stay well below 0.5."""
    return speed / radius / (WHEEL_RADIUS * NXT_MOTOR.gain / TRACK) / gain


def closed_loops(speed: float, gain: float) -> tuple[control.StateSpace, control.StateSpace]:
    """From the wanted to the true offset of the sensor, continuous and sampled with the delay."""
    system = plant(speed)
    law = gain * EDGE_SLOPE
    continuous = control.feedback(law * system)
    delay = control.tf([1.0], [1.0, *([0.0] * READING_DELAY_SAMPLES)], SAMPLE_TIME)
    sampled = control.sample_system(system, SAMPLE_TIME, "zoh")
    return control.ss(continuous), control.ss(control.feedback(law * delay * sampled))


def open_loop(speed: float, gain: float) -> control.StateSpace:
    """The sampled loop cut at the error, with the delay of the reading."""
    delay = control.tf([1.0], [1.0, *([0.0] * READING_DELAY_SAMPLES)], SAMPLE_TIME)
    sampled = control.sample_system(plant(speed), SAMPLE_TIME, "zoh")
    return control.ss(gain * EDGE_SLOPE * delay * sampled)


def controller(gain: float) -> Diagram:
    """From brightness and its set-point to the difference of the wheels' voltages."""
    diagram = Diagram("functional", SAMPLE_TIME)
    wanted = diagram.add(Inport("Wanted_Brightness", description="on the edge, 0 to 1"))
    seen = diagram.add(Inport("Brightness", description="0 on black, 1 on white"))
    error = diagram.add(Sum("Error", signs="+-"))
    steer = diagram.add(Gain("Proportional", gain=Parameter("Kp", gain, "V", "per brightness")))
    limit = Parameter("Saturation", 2 * CRUISE_VOLTAGE, "V", "the inner wheel stands")
    limited = diagram.add(Saturation("Limited", limit=limit))
    output = diagram.add(Outport("steering", unit="V", description="half goes to each wheel"))
    diagram.connect(wanted, error, 0)
    diagram.connect(seen, error, 1)
    diagram.connect_chain(error, steer, limited, output)
    return diagram


def cruise() -> tuple[float, float]:
    """Speed on a straight, m/s, and the gain for it as generated, V per brightness."""
    speed = WHEEL_RADIUS * NXT_MOTOR.gain * CRUISE_VOLTAGE
    gain = round(proportional_gain(speed), 4)
    return speed, gain


def design() -> Diagram:
    """The controller as it is generated."""
    return controller(cruise()[1])


def main() -> None:
    """Design, generate, and print the figures."""
    parser = argparse.ArgumentParser(description="Design the line follower's steering.")
    parser.add_argument("--results", type=Path, help="JSON file for figures and step responses")
    parser.add_argument("--generated", type=Path, default=PROJECT / "generated", help="C folder")
    arguments = parser.parse_args()
    speed, gain = cruise()
    code = generate_c(design())
    code.write(arguments.generated)
    numbers = (
        NamedNumber("Sample_Time_Ms", SAMPLE_TIME_MS, "Period of the control task, ms."),
        NamedNumber("Cruise_Voltage", CRUISE_VOLTAGE, "Of both wheels on a straight, V."),
    )
    packages = ada_package("Controller_Design", numbers)
    packages |= ada_binding(code.files["functional.h"], AdaBinding("Steering"), "functional.h")
    for name, text in packages.items():
        (arguments.generated / name).write_text(text, encoding="utf-8")
    figures = {"speed": speed, "proportional_gain": gain}
    figures["curve_error"] = curve_error(speed, gain, 0.3)
    loops = closed_loops(speed, gain)
    figures["largest_sampled_pole"] = float(max(abs(loops[1].poles())))
    if arguments.results:
        opened = open_loop(speed, gain)
        write_loop_results(
            arguments.results, "line-follower", loops, figures, 3.0, opened, design()
        )
    for name, value in figures.items():
        print(f"{name:40} {value:.6g}")


if __name__ == "__main__":
    main()
