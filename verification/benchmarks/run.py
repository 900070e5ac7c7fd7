# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Measure figures beside their peers and write `verification/benchmarks/results.{json,md}`.

Times are taken in one run on one machine and written as ratios; guest cycles and bytes are exact.
A published peer is named with its source in `PUBLISHED`.
"""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from tools.docs import tables
from tools.docs.tables import Row, merge_rows
from verification.benchmarks.child_time import run_timed
from verification.benchmarks.cpu_speed import measurements

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
RESULTS = ROOT / "verification" / "benchmarks" / "results.json"
VEHICLE = ROOT / "examples" / "vehicle"
REPEATS = 5
GRADED = 40
PAGE_SECONDS = 5

# Value and source of peers that cannot run beside ours.
PUBLISHED = {
    "run-time text": (7292, "FreeRTOS 11.1 kernel with mutex, ARM -Os, compiled 2026"),
    "context switch, voluntary": (95.3, "ChibiOS/RT 3.1.0 on LPC2148, project's reports"),
    "protected procedure": (149, "ChibiOS/RT 2.4.0 mutex lock and unlock, AT91SAM7X256"),
    "suspension object to task": (535, "FreeRTOS ARM7 port, semaphore, textbook cycle model"),
    "entry opened to task": (439, "FreeRTOS ARM7 port, notification, textbook cycle model"),
    "interrupt to handler": (89, "FreeRTOS ARM7 port, textbook cycle model"),
    "interrupt to task": (512, "FreeRTOS ARM7 port, textbook cycle model"),
    "delay until, idle processor": (534, "FreeRTOS ARM7 port, delay, textbook cycle model"),
    "delay until, six tasks released together": (
        3932,
        "FreeRTOS ARM7 port, textbook cycle model",
    ),
    "timing event to handler": (917, "FreeRTOS ARM7 port, timer callback, textbook cycle model"),
    "work while idle, per second": (195_000, "FreeRTOS ARM7 port, ticks of 1 ms"),
    "control block": (72, "FreeRTOS 11.1 task control block"),
    "kernel and Ada layer with all its services, arm text": (
        7292,
        "FreeRTOS 11.1 with mutex, ARM -Os",
    ),
    "kernel and Ada layer with all its services, thumb text": (
        5324,
        "FreeRTOS 11.1 with mutex, Thumb -Os",
    ),
    "two tasks, thumb text": (5196, "FreeRTOS 11.1, two tasks, delay, semaphore, Thumb -Os"),
    "two tasks, arm text": (7104, "FreeRTOS 11.1, two tasks, delay, semaphore, ARM -Os"),
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
    """Virtual seconds per second for the drive, recorded, nothing drawn.

    Times real time is what a user waits for, so it is taken by the clock on the wall. A thread
    compiles JIT code beside the run: the second figure counts what both cost the processors.
    """
    from ravenbrick.brick.run import VirtualTarget
    from ravenbrick.image.elf import read_image
    from ravenbrick.project.robot import read_robot
    from ravenbrick.project.scenario import read_scenario, scenario_path

    ravenbrick("build", str(VEHICLE))
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, "drive"), robot)
    image = read_image(ROOT / "build" / "vehicle" / "ram" / "vehicle.elf")
    waited, worked = [], []
    for _ in range(REPEATS):
        start, start_worked = time.perf_counter(), time.process_time()
        recording = VirtualTarget().run(robot, scenario, image)
        virtual_seconds = recording.clock.seconds(recording.stop.at_cycles)
        waited.append(virtual_seconds / (time.perf_counter() - start))
        worked.append(virtual_seconds / (time.process_time() - start_worked))
    brick = ("virtual s per s", "the brick", 1.0)
    yield figure_row("vehicle drive, traced", statistics.median(waited), *brick)
    yield figure_row("vehicle drive, traced, by processor time", statistics.median(worked), *brick)


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
    from verification.benchmarks.runtime.measure import figures

    for measured in figures():
        name = measured["figure"]
        value, source = PUBLISHED.get(name, (None, None))
        if measured["mean"] is not None:
            unit = f"{measured['unit']}, mean"
            yield figure_row(name, measured["mean"], unit, source, value)
        yield figure_row(f"{name}, worst", measured["worst"], measured["unit"])


def run_time_footprints() -> Iterator[Row]:
    """Bytes of small programs in both states and of a task's control block."""
    from verification.benchmarks.runtime.footprints import footprints

    for figure, value in footprints():
        source = PUBLISHED.get(figure)
        peer, peer_value = (source[1], source[0]) if source else (None, None)
        yield figure_row(f"footprint of {figure}", value, "bytes", peer, peer_value)


def cpu_speed() -> Iterator[Row]:
    """The processor on a busy program beside unicorn and qemu, on the same files."""
    for figure, value, unit, peer, peer_value in measurements():
        yield figure_row(figure, value, unit, peer, peer_value)


def grading() -> Iterator[Row]:
    """Submissions built, run and judged per minute, in each way beside one worker."""
    from verification.course.grade_campaign import measure

    ways = measure(GRADED)
    single = 60 * GRADED / sum(ways[0].seconds)
    for way in ways:
        rate = 60 * GRADED / sum(way.seconds)
        yield figure_row(f"grading, {way.name}", rate, "per min", ways[0].name, single)


def busy_image(folder: Path) -> Path:
    """A program whose processor never rests, at the start of RAM that the boot monitor leaves."""
    image = folder / "busy.elf"
    command = ["arm-none-eabi-gcc", "-mcpu=arm7tdmi", "-O2", "-g", "-nostdlib", "-ffreestanding"]
    command += ["-fno-exceptions", "-fno-unwind-tables", "-fno-asynchronous-unwind-tables"]
    command += ["-Wl,-Ttext=0x202000", "-Wl,--build-id=none", "-o", str(image)]
    subprocess.run([*command, str(HERE / "busy" / "busy.c")], check=True)
    return image


def page_figures(image: Path | None, key: str | None) -> Row:
    """What `web/e2e/speed.mjs` measures in headless Chromium, as fast as the page can."""
    command = [str(ROOT / ".venv" / "bin" / "ravenbrick"), "view", str(VEHICLE), "--no-browser"]
    command += ["--port", "0", *(["--elf", str(image)] if image else [])]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as server:
        assert server.stdout is not None
        address = re.search(r"http://\S+/", server.stdout.readline())
        if address is None:
            raise SystemExit("ravenbrick view says no address")
        words = [
            "node",
            "e2e/speed.mjs",
            address.group(),
            str(PAGE_SECONDS),
            *([key] if key else []),
        ]
        done = subprocess.run(words, cwd=ROOT / "web", capture_output=True, text=True)
        server.terminate()
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(words)}: {done.stderr}")
    figures: Row = json.loads(done.stdout)
    return figures


def page_speed() -> Iterator[Row]:
    """Times real speed in the browser's tab; nothing where the page is not built."""
    if not (ROOT / "build" / "page" / "index.html").is_file() or not shutil.which("chromium"):
        print("in the tab: not measured: it needs 'make page' and the Debian package chromium")
        return
    with tempfile.TemporaryDirectory() as folder:
        busy = page_figures(busy_image(Path(folder)), None)
    brick = ("virtual s per s", "the brick", 1.0)
    yield figure_row("in the tab, busy program", busy["ratio"], *brick)
    moving = page_figures(None, "t")
    yield figure_row("in the tab, vehicle driving", moving["ratio"], *brick)
    yield figure_row("page, first contentful paint", moving["paint_ms"], "ms")
    yield figure_row("page, brick ready to run", moving["ready_ms"], "ms")
    files = [path for path in (ROOT / "build" / "page").rglob("*") if path.is_file()]
    packed = sum(len(gzip.compress(path.read_bytes())) for path in files)
    yield figure_row("page, all files packed", packed, "bytes")


def timing_analysis() -> Iterator[Row]:
    """Seconds of `ravenbrick analyse` without the run, in a small and in a large program."""
    from ravenbrick.image.elf import read_image
    from ravenbrick.project.robot import read_robot
    from ravenbrick.project.scenario import read_scenario, scenario_path
    from ravenbrick.timing.analysis import analyse
    from ravenbrick.timing.facts import read_facts
    from ravenbrick.timing.started import elaborated

    from verification.timing.program_campaign import built, costs

    built()
    start = time.perf_counter()
    costs(8)
    seconds = time.perf_counter() - start
    yield figure_row("timing analysis, periodic tasks", seconds, "s")
    ravenbrick("build", str(VEHICLE))
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, "drive"), robot)
    image = read_image(ROOT / "build" / "vehicle" / "ram" / "vehicle.elf")
    brick = elaborated(robot, scenario, image)
    start = time.perf_counter()
    analyse(robot, image, brick, read_facts(robot))
    seconds = time.perf_counter() - start
    yield figure_row("timing analysis, vehicle", seconds, "s")


def timing_growth() -> Iterator[Row]:
    """Exponents of the analysis' work over the size of the program; writes their page."""
    from verification.benchmarks import analysis_growth

    for name in analysis_growth.EXAMPLES:
        ravenbrick("build", str(ROOT / "examples" / name))
    points = analysis_growth.measured()
    analysis_growth.write(points)
    programs = [point for point in points if not point.name]
    steps = analysis_growth.exponent(programs, lambda point: point.steps)
    times = analysis_growth.exponent(programs, lambda point: point.relative_time)
    peer = "in proportion to the size of the code"
    yield figure_row("growth of the timing analysis, steps", steps, "exponent", peer, 1.0)
    yield figure_row("growth of the timing analysis, processor time", times, "exponent", peer, 1.0)
    vehicle = next(point for point in points if point.name == "vehicle")
    most = max(points, key=lambda point: point.steps / point.instructions)
    for point in {vehicle.name: vehicle, most.name: most}.values():
        each = point.steps / point.instructions
        name = f"steps of the timing analysis, {point.name or 'largest program'}"
        yield figure_row(name, each, "steps each instruction")


# Whole processes that a user waits for; imports as the command makes them, without threads of BLAS.
ALONE = ["env", "OPENBLAS_NUM_THREADS=1"]
COMPLETION = ["_RAVENBRICK_COMPLETE=complete_bash", "COMP_WORDS=ravenbrick re", "COMP_CWORD=1"]
START_UP = {
    "ravenbrick --version": ["ravenbrick", "--version"],
    "ravenbrick --help": ["ravenbrick", "--help"],
    "completion of a command": ["env", *COMPLETION, "ravenbrick"],
    "import of the command run": [*ALONE, "python", "-c", "import ravenbrick.cli.run"],
    "import of the command build": [*ALONE, "python", "-c", "import ravenbrick.cli.build"],
    "build of the vehicle, nothing changed": ["ravenbrick", "build", str(VEHICLE)],
    "design of the vehicle": ["ravenbrick", "design", str(VEHICLE)],
}
SCRIPTS = {name: str(ROOT / ".venv" / "bin" / name) for name in ("python", "ravenbrick")}
BARE = {
    "the interpreter alone": ["python", "-c", "pass"],
    "the interpreter with NumPy": ["python", "-c", "import numpy"],
}


def start_up() -> Iterator[Row]:
    """Seconds of processor time, user and system, beside the bare interpreter's; medians."""
    ravenbrick("build", str(VEHICLE))
    taken: dict[str, list[float]] = {name: [] for name in (*BARE, *START_UP)}
    for _ in range(REPEATS):
        for name, words in (BARE | START_UP).items():
            command = [SCRIPTS.get(word, word) for word in words]
            seconds, code = run_timed(command, 120)
            if code:
                raise SystemExit(f"{' '.join(command)}: ended with {code}")
            taken[name].append(seconds)
    medians = {name: statistics.median(seconds) for name, seconds in taken.items()}
    for name in START_UP:
        for peer in BARE:
            yield figure_row(name, medians[name], "s of processor time", peer, medians[peer])


FIGURES: list[Callable[[], Iterator[Row]]] = [
    start_up,
    cpu_speed,
    vehicle_speed,
    vehicle_memory,
    run_time,
    run_time_footprints,
    grading,
    page_speed,
    timing_analysis,
    timing_growth,
]


def main(names: list[str]) -> int:
    """Measure what is named, or all; write results and tables."""
    chosen = [measure for measure in FIGURES if not names or measure.__name__ in names]
    for number, measure in enumerate(chosen, 1):
        rows = list(measure())
        for row in rows:
            print(f"[{number}/{len(chosen)}] {row['figure']}: {row['value']:.5g} {row['unit']}")
        merge_rows(RESULTS, rows, ("figure", "peer"))
    tables.main([])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
