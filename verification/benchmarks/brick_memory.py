# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Memory, mappings and threads of a process that holds 2,000 bricks."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import virtual_brick

from verification.benchmarks.cliffs import compiled
from verification.benchmarks.figures import VEHICLE, Figure
from verification.built_examples import build_example
from verification.support.bricks.observe import bench
from verification.support.paths import ROOT

__all__ = ["brick_memory"]

BRICKS = 2_000
CYCLES = 10_000_000
GOAL_KB = 24 * 1024


def _resident_kb() -> int:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS:"))


def _held(elf: Path) -> tuple[int, int, int]:
    """Memory in KB, mappings and threads, more than without the bricks; each has run a while."""
    content, before, bricks = elf.read_bytes(), _counts(), []
    for _ in range(BRICKS):
        bricks.append(virtual_brick.VirtualBrick(json.dumps(bench()), content))
        bricks[-1].run_until(CYCLES)
    kb, mappings, threads = (now - old for now, old in zip(_counts(), before, strict=True))
    return kb, mappings, threads


def _counts() -> tuple[int, int, int]:
    mappings = Path("/proc/self/maps").read_text().count("\n")
    return _resident_kb(), mappings, len(list(Path("/proc/self/task").iterdir()))


def brick_memory() -> Iterator[Figure]:
    """Of each brick, with the vehicle and with a busy program that has JIT code."""
    build_example(VEHICLE.name)
    with tempfile.TemporaryDirectory() as folder:
        images = {
            "vehicle": ROOT / "build" / "vehicle" / "ram" / "vehicle.elf",
            "busy program": compiled(Path(folder), "BUSY"),
        }
        for name, elf in images.items():
            with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
                kb, mappings, threads = pool.submit(_held, elf).result()
            title = f"{BRICKS} bricks in a process, {name}"
            yield Figure(f"{title}, memory of each", kb / BRICKS, "KB", "the goal", GOAL_KB)
            yield Figure(f"{title}, mappings of each", mappings / BRICKS, "mappings")
            yield Figure(f"{title}, threads of each", threads / BRICKS, "threads")
