# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors with hidden parameters identified on the virtual brick: do the intervals hold them?"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.control.estimation.identification import fit_motor
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario
from ravenbrick.trace.motor_data import motor_data

from verification.commands import Counts
from verification.support.paths import ROOT

VEHICLE = ROOT / "examples" / "vehicle"
IMAGE = ROOT / "build" / "vehicle" / "ram" / "vehicle.elf"
MOTOR = "B"
RUNS, LEAST_HELD = 100, 95


def hidden_motor(seed: int, usual: dict[str, float]) -> dict[str, float]:
    """Hidden constants, which only the plant knows."""
    random = np.random.default_rng(seed)
    friction = float(random.uniform(0.001, 0.02))
    return {
        "viscous_friction": usual["viscous_friction"] * float(random.uniform(0.5, 2.0)),
        "inertia": usual["inertia"] * float(random.uniform(0.6, 1.6)),
        "torque_constant": usual["torque_constant"] * float(random.uniform(0.9, 1.1)),
        "coulomb_friction": friction,
        "static_friction": 1.2 * friction,
    }


def true_values(motor: dict[str, float]) -> dict[str, float]:
    """Gain, time constant and friction voltage of a motor's constants."""
    torque, resistance = motor["torque_constant"], motor["resistance"]
    damping = motor["viscous_friction"] * resistance + torque * motor["electric_constant"]
    return {
        "gain": torque / damping,
        "time_constant": resistance * motor["inertia"] / damping,
        "friction_voltage": motor["coulomb_friction"] * resistance / torque,
    }


def held(seed: int, robot: Robot, experiment: Scenario, image: ElfImage) -> dict[str, bool]:
    """By parameter: whether the interval of one seeded run holds the true value."""
    usual = {name: q.value for name, q in robot.motors[robot.motor_ports[MOTOR].motor].items()}
    hidden = hidden_motor(seed, usual)
    scenario = replace(experiment, seed=seed, deviations={MOTOR: hidden})
    found = fit_motor(motor_data(VirtualTarget().run(robot, scenario, image), MOTOR))
    true = true_values(usual | hidden)
    return {one.name: one.holds(true[one.name]) for one in found.parameters}


def campaign(runs: int) -> dict[str, int]:
    """How many runs' intervals hold the true value, by parameter."""
    robot = read_robot(VEHICLE)
    experiment = read_scenario(VEHICLE / "experiments" / "identify.toml", robot)
    image = read_image(IMAGE)
    total: dict[str, int] = {}
    for seed in range(runs):
        for name, good in held(seed, robot, experiment, image).items():
            total[name] = total.get(name, 0) + int(good)
    return total


def suite() -> Counts:
    """Parameters, and those whose interval held the true value often enough."""
    total = campaign(RUNS)
    print(f"  of {RUNS} runs the interval held the true value: {total}", file=sys.stderr)
    return Counts(len(total), sum(count >= LEAST_HELD for count in total.values()))
