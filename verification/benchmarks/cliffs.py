# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs on which an engine can be slower than another: the default engine beside the best.

The programs are in `cliffs/programs.S`. Each runs on all engines in turn, in rounds; a time is the
processor time of all threads, the median of the rounds. The figure of a program is the time of the
default engine over that of the best one in the same round, the median too: a machine that is slow
for a minute is so for all engines. `python -m verification.benchmarks.cliffs` prints them; names of
programs, as in the table or in `programs.S`, may follow.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from verification.benchmarks.figures import REPEATS, Figure
from verification.commands import NoResultError
from verification.support.paths import ROOT

__all__ = ["figures"]

SOURCES = ROOT / "verification" / "benchmarks" / "cliffs"
RAM_BASE, FLASH_BASE = 0x0020_2000, 0x0010_0000
IN_FLASH = ("BRANCHY_FLASH", "FLASH_MODE_CHANGES", "FLASH_TABLES", "STRAIGHT_ON")
CYCLES = 96_000_000
ENGINES = ("fast", "blocks", "reference")
ROUNDS = REPEATS + 2
# A short run has other costs than a long one, and a sleeping processor passes much time. A short
# one has more rounds.
CYCLES_OF = {"SHORT_RUN": 3_800_000, "SLEEP": 480_000_000}


def programs() -> list[str]:
    """The names in `programs.S`."""
    lines = (SOURCES / "programs.S").read_text().splitlines()
    chosen = [line for line in lines if line.startswith(("#if defined ", "#elif defined "))]
    words = [word for line in chosen for word in line.split()]
    return list(dict.fromkeys(word for word in words if word.isupper()))


def compiled(folder: Path, name: str) -> Path:
    """The ELF file of a program."""
    elf = folder / f"{name}.elf"
    in_flash = name in IN_FLASH
    command = ["arm-none-eabi-gcc", "-mcpu=arm7tdmi", "-marm", "-nostdlib", "-w"]
    command += ["-Wl,--build-id=none", f"-D{name}", f"-I{SOURCES}"]
    command += ["-DIN_FLASH"] if in_flash else []
    command += [f"-Wl,--defsym=BASE={FLASH_BASE if in_flash else RAM_BASE:#x}"]
    command += ["-T", str(SOURCES / "program.ld"), str(SOURCES / "programs.S"), "-o", str(elf)]
    subprocess.run(command, check=True)
    return elf


def measured(elf: Path, cycles: int, rounds: int) -> dict[str, list[float]]:
    """Processor time of each engine in each round, in seconds."""
    command = ["cargo", "run", "--locked", "--quiet", "--release", "-p", "virtual-brick"]
    command += ["--example", "brick_speed", "--", str(elf), str(cycles), str(rounds)]
    result = subprocess.run(command, cwd=ROOT / "virtual-brick", capture_output=True, text=True)
    if result.returncode != 0:
        raise NoResultError(f"brick_speed {elf.name}: {result.stderr}")
    answer: dict[str, Any] = json.loads(result.stdout)
    return {engine: answer[engine]["rounds"] for engine in ENGINES}


def worst_ratio(times: dict[str, list[float]]) -> float:
    """The default engine's time over that of another one in the same round, the median of the
    rounds: the largest of these, at least 1."""
    pairs = (zip(times[ENGINES[0]], times[engine], strict=True) for engine in ENGINES)
    return max(median(own / other for own, other in pair) for pair in pairs)


def measure(names: Sequence[str]) -> Iterator[tuple[str, dict[str, float], float]]:
    """Each program, its median times, and the default engine's time over the best."""
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            cycles = CYCLES_OF.get(name, CYCLES)
            rounds = ROUNDS * max(1, CYCLES // cycles)
            times = measured(compiled(Path(folder), name), cycles, rounds)
            medians = {engine: median(rounds) for engine, rounds in times.items()}
            yield name, medians, worst_ratio(times)


def figures() -> Iterator[Figure]:
    """The ratio of each program, and the worst."""
    worst = 0.0
    for name, times, ratio in measure(programs()):
        title = "processor time, " + name.lower().replace("_", " ")
        yield Figure(title, times[ENGINES[0]], "s", "the best engine", times[ENGINES[0]] / ratio)
        worst = max(worst, ratio)
    yield Figure("processor time, worst program", worst, "of the best engine", "the best engine", 1)


if __name__ == "__main__":
    rows = []
    wanted = [name.upper().replace(" ", "_") for name in sys.argv[1:]]
    unknown = sorted(set(wanted) - set(programs()))
    if unknown:
        sys.exit(f"{SOURCES / 'programs.S'}: no program {', '.join(unknown)}")
    for name, times, ratio in measure(wanted or programs()):
        rows.append((ratio, name))
        engines = (f"{times[engine] * 1000:9.1f}" for engine in ENGINES)
        print(f"{name:20}{''.join(engines)} ms  {ratio:6.2f}", flush=True)
    print(f"worst: {max(rows)[1]}, {max(rows)[0]:.2f} times the best engine; {len(rows)} programs")
