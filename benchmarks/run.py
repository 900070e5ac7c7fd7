# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Measure figures beside their peers and write `benchmarks/results.{json,md}`.

Times are taken in one run on one machine and written as ratios; guest cycles and bytes are exact.
A published peer is named with its source in `PUBLISHED`.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks.cpu_speed import measurements
from tools import tables
from tools.tables import Row, merge_rows

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "benchmarks" / "results.json"
VEHICLE = ROOT / "examples" / "vehicle"
REPEATS = 5
GRADED = 40

# Value and source of peers that cannot run beside ours.
PUBLISHED = {
    "run-time text": (7292, "FreeRTOS 11.1 kernel with mutex, ARM -Os, compiled 2026"),
    "voluntary switch": (95.3, "ChibiOS/RT 3.1.0 on LPC2148, project's reports"),
    "protected procedure": (149, "ChibiOS/RT 2.4.0 mutex lock and unlock, AT91SAM7X256"),
    "entry opened to task": (439, "FreeRTOS ARM7 port, notification, textbook cycle model"),
    "interrupt to handler": (89, "FreeRTOS ARM7 port, textbook cycle model"),
    "interrupt to task": (512, "FreeRTOS ARM7 port, textbook cycle model"),
    "delay until, idle processor": (534, "FreeRTOS ARM7 port, delay, textbook cycle model"),
}


def figure_row(
    figure: str, value: float, unit: str, peer: str | None = None, peer_value: float | None = None
) -> Row:
    """One row; the ratio is ours divided by the peer's."""
    ratio = None if peer_value is None else value / peer_value
    return {
        "figure": figure,
        "value": value,
        "unit": unit,
        "peer": peer,
        "peer_value": peer_value,
        "ratio": ratio,
    }


def ravenbrick(*arguments: str) -> Row:
    """The JSON answer of a command."""
    command = [str(ROOT / ".venv" / "bin" / "ravenbrick"), *arguments, "--json"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if result.returncode != 0:
        raise SystemExit(f"{' '.join(command)}: {result.stdout}{result.stderr}")
    answer: Row = json.loads(result.stdout)
    return answer


def vehicle_speed() -> Iterator[Row]:
    """Virtual seconds per second of the drive, recording on, without building or drawing."""
    from ravenbrick.target.elf_image import read_image
    from ravenbrick.target.robot import read_robot
    from ravenbrick.target.scenario import read_scenario, scenario_path
    from ravenbrick.target.virtual import VirtualTarget

    ravenbrick("build", str(VEHICLE))
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, "drive"), robot)
    image = read_image(ROOT / "build" / "vehicle" / "ram" / "vehicle.elf")
    ratios = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        recording = VirtualTarget().run(robot, scenario, image)
        elapsed = time.perf_counter() - start
        ratios.append(recording.clock.seconds(recording.stop.at_cycles) / elapsed)
    value = statistics.median(ratios)
    yield figure_row("vehicle drive, traced", value, "virtual s per s", "the brick", 1.0)


def vehicle_memory() -> Iterator[Row]:
    """Bytes of the vehicle's RAM image and of the run-time in it."""
    memory = ravenbrick("build", str(VEHICLE))["memory"]
    free = "56 KB below the boot monitor"
    yield figure_row("vehicle RAM image", memory["used"], "bytes", free, memory["available"])
    value, source = PUBLISHED["run-time text"]
    text = memory["parts"]["run-time"]["text"]
    yield figure_row("run-time in the vehicle, ARM text", text, "bytes", source, value)


def run_time() -> Iterator[Row]:
    """Cycles of the run-time's operations: mean and worst of thousands of random phases."""
    from runtime.benchmarks.measure import figures

    for measured in figures():
        name = measured["figure"]
        value, source = PUBLISHED.get(name, (None, None))
        if measured["mean"] is not None:
            unit = f"{measured['unit']}, mean"
            yield figure_row(name, measured["mean"], unit, source, value)
        yield figure_row(f"{name}, worst", measured["worst"], measured["unit"])


def cpu_speed() -> Iterator[Row]:
    """The processor on a busy program beside unicorn and qemu, on the same files."""
    for figure, value, unit, peer, peer_value in measurements():
        yield figure_row(figure, value, unit, peer, peer_value)


def grading() -> Iterator[Row]:
    """Submissions graded per minute, images built before: two workers and Dask against one."""
    from conformance.course.grade_campaign import measure

    answer = measure(GRADED)
    per_minute = {
        way: 60 * GRADED / answer[f"{way}_seconds"]
        for way in ("build", "one_worker", "two_workers", "dask")
        if f"{way}_seconds" in answer
    }
    one = per_minute["one_worker"]
    yield figure_row("grading with builds, two workers", per_minute["build"], "submissions per min")
    peer = ("one worker", one)
    yield figure_row("grading, two workers", per_minute["two_workers"], "per min", *peer)
    if "dask" in per_minute:
        yield figure_row("grading, local Dask cluster of two", per_minute["dask"], "per min", *peer)


FIGURES: list[Callable[[], Iterator[Row]]] = [
    cpu_speed,
    vehicle_speed,
    vehicle_memory,
    run_time,
    grading,
]


def main() -> int:
    """Measure, write results and tables."""
    for number, measure in enumerate(FIGURES, 1):
        rows = list(measure())
        for row in rows:
            print(f"[{number}/{len(FIGURES)}] {row['figure']}: {row['value']:.5g} {row['unit']}")
        merge_rows(RESULTS, rows, ("figure", "peer"))
    tables.main([])
    return 0


if __name__ == "__main__":
    sys.exit(main())
