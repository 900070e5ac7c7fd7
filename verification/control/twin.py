# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Robots with hidden constants: does the model of one record foretell another manoeuvre?

The plant knows the constants, the fit only duty cycles, battery voltage and counts of one run. Half
of the robots have friction and a bridge that the fitted model does not have.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.control.estimation.identification import MotorData, fit_motor, predict_counts
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario
from ravenbrick.trace.motor_data import motor_data

from verification.commands import Counts
from verification.control.identification import IMAGE, MOTOR, VEHICLE

ROBOTS, LEAST_COVERED = 200, 190
Draw = Callable[[float, float], float]


@dataclass(frozen=True)
class Manoeuvres:
    """What each robot does: the record, and the manoeuvre that nobody fitted to."""

    robot: Robot
    image: ElfImage
    record: Scenario
    unseen: Scenario

    @classmethod
    def of_vehicle(cls) -> Manoeuvres:
        """The vehicle's two experiments, wheels off the floor."""
        robot = read_robot(VEHICLE)
        folder = VEHICLE / "experiments"
        record, unseen = (
            read_scenario(folder / f"{name}.toml", robot) for name in ("identify", "identify-check")
        )
        return cls(robot, read_image(IMAGE), record, unseen)

    def data(self, scenario: Scenario, seed: int, hidden: dict[str, float]) -> MotorData:
        """Voltages and counts of one run."""
        chosen = replace(scenario, seed=seed, deviations={MOTOR: hidden})
        return motor_data(VirtualTarget().run(self.robot, chosen, self.image), MOTOR)


def hidden_robot(seed: int, usual: dict[str, float]) -> dict[str, float]:
    """Constants of a robot; those with an odd seed have Stribeck's friction and a real bridge."""
    draw: Draw = np.random.default_rng([20, 190, seed]).uniform
    spread = {
        "resistance": (0.85, 1.15), "torque_constant": (0.9, 1.1), "electric_constant": (0.9, 1.1),
        "viscous_friction": (0.5, 2.0), "inertia": (0.6, 3.0),
    }  # fmt: skip
    hidden = {name: usual[name] * float(draw(*limits)) for name, limits in spread.items()}
    coulomb = float(draw(0.001, 0.02))
    hidden |= {
        "coulomb_friction": coulomb,
        "static_friction": coulomb * float(draw(1.0, 2.0)),
        "backlash": float(draw(0.0, 0.07)),
    }
    if seed % 2:
        hidden |= {
            "stribeck_velocity": float(draw(0.5, 8.0)),
            "gear_friction": float(draw(0.0, 0.2)),
            "driver_drop": float(draw(0.0, 0.1)),
            "driver_resistance": float(draw(0.0, 1.2)),
        }
    return hidden


def covered(seed: int, manoeuvres: Manoeuvres) -> tuple[bool, float]:
    """Whether the band of one robot holds every count of the manoeuvre, and its half width."""
    robot = manoeuvres.robot
    usual = {name: q.value for name, q in robot.motors[robot.motor_ports[MOTOR].motor].items()}
    hidden = hidden_robot(seed, usual)
    found = fit_motor(manoeuvres.data(manoeuvres.record, 2 * seed, hidden))
    unseen = manoeuvres.data(manoeuvres.unseen, 2 * seed + 1, hidden)
    band = predict_counts(found, unseen)
    return band.covers(unseen.count), band.half_width


def campaign(robots: int) -> list[tuple[bool, float]]:
    """Of each robot whether it was covered, and the half width of its band in counts."""
    manoeuvres = Manoeuvres.of_vehicle()
    return [covered(seed, manoeuvres) for seed in range(robots)]


def suite() -> Counts:
    """Robots, and those whose band held the unseen manoeuvre; the goal is `LEAST_COVERED`."""
    found = campaign(ROBOTS)
    for name, half in (("of the fitted form", found[::2]), ("with other friction", found[1::2])):
        widths = np.array([width for _, width in half])
        print(
            f"  {name}: {sum(good for good, _ in half)} of {len(half)} covered, half width of the "
            f"band {np.median(widths):.1f} counts in the median, {widths.max():.1f} at most",
            file=sys.stderr,
        )
    total = sum(good for good, _ in found)
    missed = ROBOTS - total
    reason = "a band of 95 % may miss one in twenty"
    allowed = [{"count": missed, "reason": reason}] if 0 < missed <= ROBOTS - LEAST_COVERED else []
    return Counts(ROBOTS, total, allowed)
