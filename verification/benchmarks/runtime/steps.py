# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every step of the processor while a program runs on the virtual brick, with its function."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
import virtual_brick

from verification.support.rust_examples import rust_example

__all__ = ["BENCH", "Steps", "steps_in", "steps_of"]

BENCH = {
    "seed": 1,
    "battery": {"kind": "li_ion", "voltage": 8.0, "internal_resistance": 0.0},
    "body": {"kind": "bench"},
}
RECORD = np.dtype(
    [("at", "<u8"), ("address", "<u4"), ("status", "<u4"), ("stack", "<u4"), ("link", "<u4")]
)
VECTORS_SIZE = 512
IRQ_VECTOR = 0x18
EXCEPTION_CYCLES = 3
MASKED_BIT = 0x80


@dataclass(frozen=True)
class Steps:
    """Records before each step: cycles, address of the instruction, status, r13 and r14."""

    brick: virtual_brick.VirtualBrick
    records: np.ndarray

    @cached_property
    def vectors(self) -> int:
        """Where the vectors were linked; they are executed at address 0."""
        return self.brick.symbol("ravenbrick_vectors")[0]

    def function(self, address: int) -> str:
        """Name of the function at an address."""
        linked = address + self.vectors if address < VECTORS_SIZE else address
        found = self.brick.nearest_code(linked)
        return found[0] if found else f"0x{address:08x}"

    def masked(self) -> list[tuple[int, int, int]]:
        """Sections with masked interrupts: cycles, where they begin, where they end.

        A section begins behind the instruction that masks, or with the exception, and ends behind
        the instruction that unmasks.
        """
        masked = (self.records["status"] & MASKED_BIT) != 0
        edges = np.flatnonzero(np.diff(masked.astype(np.int8)))
        found = []
        for first, last in pairwise(edges):
            begin, end = self.records[first + 1], self.records[last + 1]
            if masked[first + 1]:
                entry = EXCEPTION_CYCLES if begin["address"] == IRQ_VECTOR else 0
                cycles = int(end["at"]) - int(begin["at"]) + entry
                found.append((cycles, int(begin["address"]), int(self.records[last]["address"])))
        return found


def steps_of(elf: Path, first_cycle: int, last_cycle: int) -> Steps:
    """Run an image and record its steps between two cycles.

    Raises:
        subprocess.CalledProcessError: The recorder could not be built or failed.
    """
    return steps_in(elf, [(first_cycle, last_cycle)])[0]


def steps_in(elf: Path, windows: Sequence[tuple[int, int]]) -> list[Steps]:
    """Run an image once and record its steps in each of some windows, earlier ones first.

    Raises:
        subprocess.CalledProcessError: The recorder could not be built or failed.
    """
    # With the features of the compiled module, whose crates then need not be compiled again.
    packages = ("-p", "virtual-brick", "-p", "virtual-brick-python", "--no-default-features")
    command = [str(rust_example("steps", *packages)), json.dumps(BENCH), str(elf)]
    command += [str(cycle) for window in windows for cycle in window]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout
    brick = virtual_brick.VirtualBrick(json.dumps(BENCH), elf.read_bytes())
    records = np.frombuffer(done, RECORD)
    begins = np.searchsorted(records["at"], [first for first, _ in windows])
    return [Steps(brick, part) for part in np.split(records, begins)[1:]]
