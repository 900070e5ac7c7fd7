# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Time of the execution-time analysis, and how its work grows with the program."""

from __future__ import annotations

import time
from collections.abc import Iterator

from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.timing.analysis import analyse
from ravenbrick.timing.facts.facts import read_facts
from ravenbrick.timing.initial_state import elaborated

from verification.benchmarks import analysis_growth
from verification.benchmarks.figures import VEHICLE, Figure
from verification.built_examples import ravenbrick
from verification.support.paths import ROOT
from verification.timing.program_campaign import built, costs


def timing_analysis() -> Iterator[Figure]:
    """Seconds of `ravenbrick analyse` without the run, in a small and in a large program."""
    built()
    start = time.perf_counter()
    costs(8)
    seconds = time.perf_counter() - start
    yield Figure("timing analysis, periodic tasks", seconds, "s")
    ravenbrick("build", str(VEHICLE))
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, "drive"), robot)
    image = read_image(ROOT / "build" / "vehicle" / "ram" / "vehicle.elf")
    brick = elaborated(robot, scenario, image)
    start = time.perf_counter()
    analyse(robot, image, brick, read_facts(robot))
    seconds = time.perf_counter() - start
    yield Figure("timing analysis, vehicle", seconds, "s")


def timing_growth() -> Iterator[Figure]:
    """Exponents of the analysis' work over the size of the program; writes their page."""
    for name in analysis_growth.EXAMPLES:
        ravenbrick("build", str(ROOT / "examples" / name))
    points = analysis_growth.measured()
    analysis_growth.write(points)
    programs = [point for point in points if not point.name]
    steps = analysis_growth.exponent(programs, lambda point: point.steps)
    times = analysis_growth.exponent(programs, lambda point: point.relative_time)
    peer = "in proportion to the size of the code"
    yield Figure("growth of the timing analysis, steps", steps, "exponent", peer, 1.0)
    yield Figure("growth of the timing analysis, processor time", times, "exponent", peer, 1.0)
    vehicle = next(point for point in points if point.name == "vehicle")
    most = max(points, key=lambda point: point.steps / point.instructions)
    for point in {vehicle.name: vehicle, most.name: most}.values():
        each = point.steps / point.instructions
        name = f"steps of the timing analysis, {point.name or 'largest program'}"
        yield Figure(name, each, "steps each instruction")
