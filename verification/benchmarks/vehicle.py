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
    waited: dict[str, list[float]] = {"fast": [], "reference": []}
    worked: dict[str, list[float]] = {"fast": [], "reference": []}
    for engine in list(waited) * REPEATS:
        start, start_worked = time.perf_counter(), time.process_time()
        recording = VirtualTarget(settings={"engine": engine}).run(robot, scenario, image)
        virtual_seconds = recording.clock.seconds(recording.stop.at_cycles)
        waited[engine].append(virtual_seconds / (time.perf_counter() - start))
        worked[engine].append(virtual_seconds / (time.process_time() - start_worked))
    brick = ("virtual s per s", "the brick", 1.0)
    by_processor = statistics.median(worked["fast"])
    yield Figure("vehicle drive, traced", statistics.median(waited["fast"]), *brick)
    yield Figure("vehicle drive, traced, by processor time", by_processor, *brick)
    reference = ("virtual s per s", "reference engine", statistics.median(worked["reference"]))
    yield Figure("vehicle drive, traced, by processor time", by_processor, *reference)


def vehicle_memory() -> Iterator[Figure]:
    """Bytes of the vehicle's RAM image and of the run-time in it."""
    memory = ravenbrick("build", str(VEHICLE))["memory"]
    free = "56 KB below the boot monitor"
    yield Figure("vehicle RAM image", memory["used"], "bytes", free, memory["available"])
    value, source = PUBLISHED["run-time text"]
    text = memory["parts"]["run-time"]["text"]
    yield Figure("run-time in the vehicle, ARM text", text, "bytes", source, value)
