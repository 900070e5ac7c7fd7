# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Costs of the run-time in cycles, measured on the virtual brick.

`python -m verification.benchmarks.runtime.measure` from the project's folder prints them as JSON.
The programs
of this folder time themselves with a timer of the chip that counts every second cycle; releases
by `delay until` and the work of the idle processor are observed from outside, to the cycle.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

import numpy as np
import virtual_brick

from verification.support.bricks.programs import gprbuild
from verification.support.bricks.runtime_programs import (
    BENCH,
    CYCLES_PER_SECOND,
    EVENT,
    RUNTIMES,
    make_runtime,
)
from verification.support.paths import BUILD

__all__ = ["LONGEST_MASKED_CYCLES", "figures", "image_of"]

HERE = Path(__file__).resolve().parent

LONGEST_MASKED_CYCLES = 250
LIMIT_SECONDS = 90
LEAST_SAMPLES = 10_000

# Order of the program's figures, and those that are reduced by what the measuring costs
COSTS = (
    "two readings of the timer",
    "plain call",
    "protected procedure",
    "entry call, barrier open",
    "context switch, voluntary",
    "suspension object to task",
    "entry opened to task",
    "interrupt to handler",
    "interrupt to task",
)
LESS_READING = COSTS[3:]
TOGETHER = 6


class FigureRow(TypedDict):
    """One figure; `best`, `mean` and `worst` in `unit`."""

    figure: str
    best: float
    mean: float
    worst: float
    unit: str
    samples: int


@dataclass(frozen=True)
class Summary:
    """What a program keeps of its samples, in cycles."""

    count: int
    best: int
    worst: int
    total: int

    def row(self, figure: str, less: int = 0) -> FigureRow:
        """The summary with `less` cycles subtracted from each sample."""
        if self.count < LEAST_SAMPLES:
            raise RuntimeError(f"{figure}: {self.count} samples, expected {LEAST_SAMPLES}")
        mean = self.total / self.count
        return _row(figure, self.best - less, mean - less, self.worst - less, self.count)


def _row(figure: str, best: float, mean: float, worst: float, samples: int) -> FigureRow:
    return {
        "figure": figure,
        "best": best,
        "mean": round(mean, 1),
        "worst": worst,
        "unit": "cycles",
        "samples": samples,
    }


def image_of(program: str, image: str, code: str) -> Path:
    """The image of a program of this folder, built with the run-time in the same state.

    The linker's map stands beside it.
    """
    make_runtime(code)
    folder = BUILD / "runtime" / "benchmarks" / code
    elf = folder / program / image / f"{program}.elf"
    gprbuild(
        HERE / "benchmarks.gpr",
        f"--create-map-file={elf.with_suffix('.map')}",
        run_time=RUNTIMES[code],
        PROGRAM=program,
        IMAGE=image,
        CODE=code,
        BUILD=folder,
    )
    return elf


def _run(elf: Path) -> virtual_brick.VirtualBrick:
    """The brick when the program has finished its measurements."""
    brick = virtual_brick.VirtualBrick(json.dumps(BENCH), elf.read_bytes())
    for second in range(1, LIMIT_SECONDS + 1):
        stop = brick.run_until(round(second * CYCLES_PER_SECOND))
        if stop.reason != "reached":
            raise RuntimeError(f"benchmark '{elf.stem}' stopped: {stop.message}")
        if brick.read_int("finished", "u8"):
            return brick
    raise RuntimeError(f"benchmark '{elf.stem}' has not finished after {LIMIT_SECONDS} s")


def _summaries(brick: virtual_brick.VirtualBrick, count: int) -> list[Summary]:
    """The program's `results`: count, best, worst and sum of each figure."""
    address, _ = brick.symbol("results")
    words = np.frombuffer(brick.read_memory(address, 16 * count), "<u4").reshape(count, 4)
    return [Summary(*map(int, row)) for row in words]


def _costs(image: str, code: str) -> list[FigureRow]:
    """Primitives, less the reading of the timer; a protected procedure also less a plain call."""
    found = dict(
        zip(COSTS, _summaries(_run(image_of("costs", image, code)), len(COSTS)), strict=True)
    )
    reading = found["two readings of the timer"].best
    procedure = found["protected procedure"]
    rows = [
        procedure.row("protected procedure", found["plain call"].best),
        procedure.row("protected procedure with its call", reading),
    ]
    return rows + [found[name].row(name, reading) for name in LESS_READING]


def _load(image: str, code: str) -> list[FigureRow]:
    """Latency of the highest level under load, and the masked time that explains its growth."""
    (latency,) = _summaries(_run(image_of("load", image, code)), 1)
    masked = latency.row("masked section seen by the highest level", less=latency.best)
    return [latency.row("interrupt to handler under load"), masked]


@dataclass(frozen=True)
class Observed:
    """Events of the threads of a program that ran."""

    elf: Path
    brick: virtual_brick.VirtualBrick
    events: np.ndarray
    kinds: dict[str, int]

    @classmethod
    def of(cls, program: str, image: str, code: str) -> Observed:
        """Run a program."""
        elf = image_of(program, image, code)
        brick = _run(elf)
        kinds = {name: number for number, name in brick.event_kinds().items()}
        return cls(elf, brick, np.frombuffer(brick.events(), EVENT), kinds)

    def jobs(self, symbol: str, code: str) -> tuple[np.ndarray, np.ndarray]:
        """Nominal releases of a task but its first, and when its `code` went on after each.

        The kernel's selection of the task is an event; from there to the task's own instruction
        every release takes the same way, so its length is seen once.
        """
        address, size = self.brick.symbol(symbol)
        (task,) = (
            index
            for index, thread in enumerate(self.brick.threads())
            if address <= thread.address < address + size
        )
        mine = self.events[self.events["subject"] == task]
        nominal = mine["value"][mine["kind"] == self.kinds["release"]][1:]
        starts = mine["at"][mine["kind"] == self.kinds["thread_running"]].astype(np.int64)
        positions = np.searchsorted(starts, nominal)
        begun = positions < len(starts)
        selected = starts[positions[begun]]
        return nominal[begun], selected + self._way_to(code, int(selected[1]))

    def _way_to(self, code: str, selected: int) -> int:
        """Cycles from the instant at which a task was selected to an instruction of `code`."""
        brick = virtual_brick.VirtualBrick(json.dumps(BENCH), self.elf.read_bytes())
        address, size = brick.symbol(code)
        brick.run_until(selected)
        while not address & ~1 <= brick.program_counter < (address & ~1) + size:
            brick.run_until(brick.cycles + 1)
        return int(brick.cycles) - selected


def _delays(image: str, code: str) -> list[FigureRow]:
    """From the nominal wake-up time to the task's first instruction, and work while idle.

    Between arbitrary wake-up times and the next tick of the clock lie up to 16 cycles; the
    wake-up times of the first series are ticks. Work while idle is the cycles per second in which
    the processor is not stopped though no task is ready.
    """
    observed = Observed.of("delays", image, code)
    nominal, starts = observed.jobs("released__delayed", "released__delay_at_random")
    latencies = starts - nominal
    first, second = sorted(np.argsort(np.diff(nominal))[-2:] + 1)
    begin, end = int(starts[first - 1]), int(nominal[first])
    return [
        _latency_row("delay until, idle processor, from the clock's tick", latencies[1:first]),
        _latency_row("delay until, idle processor", latencies[first + 1 : second]),
        _latency_row("delay until, busy processor", latencies[second + 1 :]),
        _idle_row(observed.events, observed.kinds, begin, end),
    ]


def _together(image: str, code: str) -> list[FigureRow]:
    """From the common release of six tasks to the first instruction of the last of them."""
    observed = Observed.of("simultaneous_releases", image, code)
    first, _ = observed.jobs("six_tasks__t1", "six_tasks__cyclicTB")
    nominal, starts = observed.jobs(f"six_tasks__t{TOGETHER}", "six_tasks__cyclicTB")
    count = min(len(first), len(nominal))
    if not np.array_equal(first[:count], nominal[:count]):
        raise RuntimeError("benchmark 'simultaneous_releases': the tasks are not released together")
    return [_latency_row("delay until, six tasks released together", starts - nominal)]


def _events(image: str, code: str) -> list[FigureRow]:
    """From a timing event's time until its handler's first statement."""
    (latency,) = _summaries(_run(image_of("events", image, code)), 1)
    return [latency.row("timing event to handler")]


def _latency_row(figure: str, latencies: np.ndarray) -> FigureRow:
    if len(latencies) < LEAST_SAMPLES:
        raise RuntimeError(f"{figure}: {len(latencies)} samples, expected {LEAST_SAMPLES}")
    best, worst = int(latencies.min()), int(latencies.max())
    return _row(figure, best, float(latencies.mean()), worst, len(latencies))


def _idle_row(events: np.ndarray, numbers: dict[str, int], begin: int, end: int) -> FigureRow:
    """Cycles of each wake-up between `begin` and `end`, by second."""
    inside = events[(events["at"] > begin) & (events["at"] < end)]
    stopped = inside["at"][inside["kind"] == numbers["processor_stopped"]].astype(np.int64)
    resumed = inside["at"][inside["kind"] == numbers["processor_resumed"]].astype(np.int64)
    awake = [
        int(stopped[stopped > instant].min()) - int(instant)
        for instant in resumed
        if (stopped > instant).any()
    ]
    per_second = sum(awake) / ((end - begin) / CYCLES_PER_SECOND)
    mean = round(per_second, 1)
    row = _row("work while idle, per second", mean, mean, mean, len(awake))
    return {**row, "unit": "cycles/s"}


def figures(image: str = "ram", code: str = "arm") -> list[FigureRow]:
    """All figures, programs and run-time in one image and state ("arm" or "thumb").

    `image` is "ram" or "flash".

    Raises:
        RuntimeError: A program failed or took fewer samples than it should.
        subprocess.CalledProcessError: A program could not be built.
    """
    parts = (_costs, _load, _delays, _together, _events)
    return [row for part in parts for row in part(image, code)]


if __name__ == "__main__":
    print(json.dumps(figures(), indent=2))
