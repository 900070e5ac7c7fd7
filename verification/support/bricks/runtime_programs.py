# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Builds the test programs and runs them on the virtual brick."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import virtual_brick
from ravenbrick.clock import MASTER_CLOCK

from verification.support.bricks.programs import gprbuild
from verification.support.paths import BUILD, ROOT

__all__ = [
    "BENCH",
    "CYCLES_PER_MS",
    "CYCLES_PER_SECOND",
    "EVENT",
    "IDLE",
    "PROGRAMS",
    "RUNTIMES",
    "UNITS_PER_SECOND",
    "Run",
    "Runner",
    "assert_repeats",
    "build",
    "is_in",
    "make_runtime",
]

TESTS = ROOT / "runtime" / "tests"
PROGRAMS = TESTS / "programs"
PRODUCTS = BUILD / "runtime"
RUNTIMES = {
    "arm": PRODUCTS / "ravenscar",
    "thumb": PRODUCTS / "ravenscar-thumb",
    "jorvik": PRODUCTS / "jorvik",
    "jorvik-priority": PRODUCTS / "jorvik-priority",
    "timed": PRODUCTS / "ravenscar-timed",
    "contracts": PRODUCTS / "ravenscar-contracts",
}
MAKE_VARIABLES = {
    "arm": (),
    "thumb": ("CODE=thumb",),
    "jorvik": ("PROFILE=jorvik",),
    "jorvik-priority": ("PROFILE=jorvik", "QUEUING=priority"),
    "timed": ("EXECUTION_TIME=yes",),
    "contracts": ("CONTRACTS=yes",),
}
CYCLES_PER_SECOND = float(MASTER_CLOCK.hertz)
CYCLES_PER_MS = 48_055
UNITS_PER_SECOND = 21_024_000
IDLE = 0xFFFF_FFFF

BENCH = {
    "seed": 1,
    "battery": {"kind": "li_ion", "voltage": 8.0, "internal_resistance": 0.0},
    "body": {"kind": "bench"},
}

EVENT = np.dtype([("at", "<u8"), ("kind", "<u4"), ("subject", "<u4"), ("value", "<i8")])


@cache
def make_runtime(runtime: str) -> None:
    """Build the library of one of RUNTIMES; make takes no folder with a space in its name."""
    products = f"BUILD={os.path.relpath(PRODUCTS, ROOT / 'runtime')}"
    subprocess.run(
        ["make", "-s", "-j2", "-C", str(ROOT / "runtime"), products, *MAKE_VARIABLES[runtime]],
        check=True,
    )


@cache
def build(
    name: str,
    image: str = "ram",
    code: str = "arm",
    runtime: str = "arm",
    options: tuple[str, ...] = (),
) -> Path:
    """Path of the program `name` of this folder, built with one call of gprbuild.

    `code`: "arm" or "thumb", the state of the program. `runtime`: the same for the run-time of the
    Ravenscar profile, "jorvik" for the other one, "jorvik-priority" for its queues by priority,
    "timed" for the one with execution times.
    `options`: of gprbuild. The linker's map stands beside the image.
    """
    make_runtime(runtime)
    folder = PRODUCTS / "tests" / f"{code}-on-{runtime}"
    elf = folder / name / image / f"{name}.elf"
    gprbuild(
        TESTS / "test.gpr",
        *options,
        f"--create-map-file={elf.with_suffix('.map')}",
        run_time=RUNTIMES[runtime],
        TEST=name,
        IMAGE=image,
        CODE=code,
        BUILD=folder,
    )
    return elf


@dataclass
class Run:
    """A program on the virtual brick after a number of cycles."""

    brick: virtual_brick.VirtualBrick
    stop: virtual_brick.Stop

    def journal(self) -> str:
        """Marks that the program noted, in their order."""
        address, _ = self.brick.symbol("journal")
        length = self.brick.read_int("journal_length", "u32")
        return self.brick.read_memory(address, length).decode("ascii")

    def words(self, symbol: str, count: int, kind: str = "<u4") -> list[int]:
        """Array of integers of the program."""
        address, _ = self.brick.symbol(symbol)
        size = np.dtype(kind).itemsize
        return np.frombuffer(self.brick.read_memory(address, size * count), kind).tolist()

    def failure(self) -> tuple[str, int] | None:
        """Text and line that the last-chance handler got; None when the program did not fail."""
        text, line = self.words("ravenbrick_failure", 2)
        if text == 0:
            return None
        return self.text_at(text), line

    def text_at(self, address: int) -> str:
        """Text that ends with NUL."""
        return self.brick.read_memory(address, 64).split(b"\0")[0].decode("ascii")

    def thread_index(self, symbol: str) -> int:
        """Subject in the events of the task whose object is `symbol`."""
        address, size = self.brick.symbol(symbol)
        matches = [
            index
            for index, thread in enumerate(self.brick.threads())
            if address <= thread.address < address + size
        ]
        assert len(matches) == 1, f"{symbol}: {matches}"
        return matches[0]

    def events(self, kind: str, subject: int | None = None) -> np.ndarray:
        """Events of one kind in the order of time, optionally of one subject."""
        numbers = {name: number for number, name in self.brick.event_kinds().items()}
        events = np.frombuffer(self.brick.events(), EVENT)
        events = events[events["kind"] == numbers[kind]]
        return events if subject is None else events[events["subject"] == subject]


def is_in(result: Run, symbol: str, address: int) -> bool:
    """Whether an address belongs to an object of the program."""
    first, size = result.brick.symbol(symbol)
    return first <= address < first + size


Runner = Callable[..., Run]


def assert_repeats(journal: str, pattern: str, at_least: int) -> None:
    """`journal` is `pattern` over and over, cut anywhere, and holds it `at_least` times."""
    assert journal.count(pattern) >= at_least
    assert (pattern * (len(journal) // len(pattern) + 1)).startswith(journal)
