# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The paper's vehicle: how fast its drive runs, and the bytes of its image.

Published peers of the run-time are in `runtime/published.py`.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path

from verification.benchmarks.figures import REPEATS, VEHICLE, Figure
from verification.benchmarks.runtime.published import PUBLISHED
from verification.built_examples import ravenbrick
from verification.support.paths import ROOT


def vehicle_speed() -> Iterator[Figure]:
    """Virtual seconds per second for the drive, recorded, nothing drawn.

    Times real time is what a user waits for, so it is taken by the clock on the wall. A thread
    compiles JIT code beside the run: the other figures count what both cost the processors, the
    last one beside the reference engine, on whatever machine this is.
    """
    ravenbrick("build", str(VEHICLE))
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, "drive"), robot)
    image = read_image(ROOT / "build" / "vehicle" / "ram" / "vehicle.elf")

    def driven(engine: str) -> tuple[float, float]:
        start, start_worked = time.perf_counter(), time.process_time()
        recording = VirtualTarget(settings={"engine": engine}).run(robot, scenario, image)
        virtual_seconds = recording.clock.seconds(recording.stop.at_cycles)
        waited = virtual_seconds / (time.perf_counter() - start)
        return waited, virtual_seconds / (time.process_time() - start_worked)

    rounds = [(*driven("fast"), driven("reference")[1]) for _ in range(REPEATS)]
    waited, worked, of_reference = map(statistics.median, zip(*rounds, strict=True))
    unit, title = "virtual s per s", "vehicle drive, traced"
    yield Figure(title, waited, unit, "the brick", 1.0)
    yield Figure(f"{title}, by processor time", worked, unit, "the brick", 1.0)
    yield Figure(f"{title}, by processor time", worked, unit, "reference engine", of_reference)


def vehicle_memory() -> Iterator[Figure]:
    """Bytes of the vehicle's RAM image and of the run-time in it."""
    memory = ravenbrick("build", str(VEHICLE))["memory"]
    free = "56 KB below the boot monitor"
    yield Figure("vehicle RAM image", memory["used"], "bytes", free, memory["available"])
    value, source = PUBLISHED["run-time text"]
    text = memory["parts"]["run-time"]["text"]
    yield Figure("run-time in the vehicle, ARM text", text, "bytes", source, value)
