# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How the work of the execution-time analysis grows with the size of the program.

`python -m verification.benchmarks.analysis_growth` generates programs of 1 to 720 controllers,
each with a
filter, a state machine, a table search and calls of a shared library, compiles them, bounds each,
bounds the jobs of all examples, and writes docs/reference/analysis-growth.md. Counted are the
instructions that the analysis executes on abstract values; times are relative to the smallest
program, the least of two runs. `make bench` does the same and keeps the fitted exponents.
"""

from __future__ import annotations

import json
import math
import random
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import matplotlib as mpl
from elftools.elf.elffile import ELFFile
from ravenbrick.timing.bounds import Bounds, execution_times

from verification.timing.examples import EXAMPLES
from verification.timing.known_examples import known_example

mpl.use("Agg")
from matplotlib import pyplot as plt

from verification.support.paths import ROOT

PAGE = ROOT / "docs" / "reference" / "analysis-growth.md"
PICTURE = ROOT / "docs" / "pictures" / "analysis-growth.png"
COUNTS = (1, 2, 4, 8, 16, 32, 64, 96, 128, 192, 256, 384, 720)
OPTIONS = (
    "-mcpu=arm7tdmi", "-marm", "-Os", "-g", "-nostdlib", "-ffreestanding",
    "-Wl,-Ttext=0x100000", "-Wl,-Tbss=0x200000", "-Wl,-Tdata=0x208000", "-Wl,-estep",
)  # fmt: skip
FLASH_BYTES = 256 * 1024
RUNS = 2


@dataclass(frozen=True)
class Point:
    """One program and what its analysis went through; `name` is that of an example, else empty."""

    name: str
    controllers: int
    text_bytes: int
    functions: int
    blocks: int
    loops: int
    instructions: int
    steps: int
    bound_cycles: int
    relative_time: float = 0.0


LIBRARY = """
static int clamp(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}
__attribute__((noinline)) int interpolate(const int *table, int count, int value)
{
    int place = 0;
    while (place < 6 && place < count - 2 && table[place + 1] < value)
        place++;
    return clamp(table[place] + (value - table[place] >> 2), -4096, 4095);
}
"""


def _controller(number: int, dice: random.Random) -> str:
    taps = [dice.randint(-255, 255) for _ in range(dice.randint(4, 10))]
    states = dice.randint(4, 9)
    cases = "".join(
        f"    case {state}: if (sum > {dice.randint(-900, 900)}) state{number} = "
        f"{dice.randrange(states)}; else sum += {dice.randint(1, 99)} * input{number}; break;\n"
        for state in range(states)
    )
    points = sorted(dice.randint(-4000, 4000) for _ in range(8))
    return f"""
volatile int input{number};
static int line{number}[{len(taps)}], state{number};
static const int taps{number}[] = {{ {", ".join(map(str, taps))} }};
static const int curve{number}[] = {{ {", ".join(map(str, points))} }};
__attribute__((noinline)) int control{number}(void)
{{
    int sum = 0;
    for (int place = {len(taps) - 1}; place > 0; place--)
        line{number}[place] = line{number}[place - 1];
    line{number}[0] = input{number};
    for (int place = 0; place < {len(taps)}; place++)
        sum += taps{number}[place] * line{number}[place] >> 6;
    switch (state{number}) {{
{cases}    }}
    return interpolate(curve{number}, 8, sum);
}}
"""


def program(count: int) -> str:
    """C text of a program with this many controllers; always the same."""
    dice = random.Random(count)
    parts = [_controller(number, dice) for number in range(count)]
    calls = " + ".join(f"control{number}()" for number in range(count))
    return LIBRARY + "".join(parts) + f"\nint step(void)\n{{\n    return {calls};\n}}\n"


def _compiled(count: int, folder: Path) -> tuple[bytes, int]:
    source, output = folder / "program.c", folder / "program.elf"
    source.write_text(program(count))
    command = ["arm-none-eabi-gcc", *OPTIONS, str(source), "-lgcc", "-o", str(output)]
    subprocess.run(command, check=True, capture_output=True)
    with output.open("rb") as stream:
        text = ELFFile(stream).get_section_by_name(".text")
        size = int(text["sh_size"]) if text is not None else 0
    return output.read_bytes(), size


def _timed(analyse: Callable[[], Bounds]) -> tuple[Bounds, float]:
    """What is found, and the least of the processor's seconds."""
    spent = []
    for _ in range(RUNS):
        begin = time.process_time()
        found = analyse()
        spent.append(time.process_time() - begin)
    return found, min(spent)


def _point(name: str, count: int, size: int, found: Bounds, relative_time: float) -> Point:
    effort = found.effort
    cycles = sum(bound.cycles for bound in (*found.functions, *found.jobs))
    point = Point(
        name,
        count,
        size,
        effort["functions"],
        effort["blocks"],
        effort["loops"],
        effort["instructions"],
        effort["steps"],
        cycles,
        round(relative_time, 1),
    )
    print(asdict(point), file=sys.stderr, flush=True)
    return point


def _example(name: str) -> tuple[int, Callable[[], Bounds]]:
    """Size of an example's code, and how its jobs are bounded."""
    known = known_example(name)
    facts = [*known.annotations, (f"{known.facts.name}, [[outside]]", known.facts.outside)]
    return known.image.size_of("text"), lambda: execution_times(
        known.image.content, jobs=known.jobs, annotations=facts
    )


def measured() -> list[Point]:
    """All programs, then the examples, which must have been built, by their size."""
    points: list[Point] = []
    first = 0.0
    for count in COUNTS:
        with tempfile.TemporaryDirectory() as folder:
            elf, size = _compiled(count, Path(folder))
        if size > FLASH_BYTES:
            raise SystemExit(f"{count} controllers: {size} bytes do not fit the flash")
        found, seconds = _timed(partial(execution_times, elf, functions=["step"]))
        first = first or seconds
        points.append(_point("", count, size, found, seconds / first))
    examples = []
    for name in EXAMPLES:
        size, analyse = _example(name)
        found, seconds = _timed(analyse)
        examples.append(_point(name, 0, size, found, seconds / first))
    return points + sorted(examples, key=lambda point: point.text_bytes)


def exponent(points: Sequence[Point], value: Callable[[Point], float]) -> float:
    """Slope of the value over the size, both as logarithms, by least squares."""
    sizes = [math.log(point.text_bytes) for point in points]
    fitted = statistics.linear_regression(sizes, [math.log(value(point)) for point in points])
    return fitted.slope


def _draw(points: Sequence[Point]) -> None:
    programs = [point for point in points if not point.name]
    examples = [point for point in points if point.name]
    figure, axes = plt.subplots(figsize=(7, 4.2))
    first = programs[0]
    for shown, label, mark in ((programs, "", "-"), (examples, ", examples", "")):
        sizes = [point.text_bytes / 1024 for point in shown]
        face = None if mark else "none"
        steps = [p.steps / first.steps for p in shown]
        axes.loglog(sizes, steps, f"C0o{mark}", mfc=face, label=f"abstract steps{label}")
        times = [p.relative_time for p in shown]
        axes.loglog(sizes, times, f"C1s{mark}", mfc=face, label=f"processor time{label}")
    sizes = [point.text_bytes / 1024 for point in programs]
    straight = [p.text_bytes / first.text_bytes for p in programs]
    axes.loglog(sizes, straight, "k:", label="in proportion to the size")
    axes.set_xlabel("machine code, KB")
    axes.set_ylabel("times the smallest program")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    figure.tight_layout()
    figure.savefig(PICTURE, dpi=144, metadata={"Software": None})
    plt.close(figure)


def _row(point: Point) -> str:
    each = f"{point.steps / point.instructions:.1f}"
    cells = (point.name or point.controllers, point.text_bytes, point.functions, point.blocks)
    more = (point.loops, point.instructions, point.steps, each, point.relative_time)
    return "| " + " | ".join(map(str, (*cells, *more))) + " |"


def _page(points: Sequence[Point]) -> str:
    columns = "bytes | functions | blocks | loops | instructions | steps | each | time |"
    rule = "| ---: " * 9 + "|"
    programs = [point for point in points if not point.name]
    examples = [point for point in points if point.name]
    steps = exponent(programs, lambda point: point.steps)
    times = exponent(programs, lambda point: point.relative_time)
    deeper = exponent(examples, lambda point: point.steps)
    lines = [
        "<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->",
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        "# Growth of the execution-time analysis",
        "",
        "Generated by `python -m verification.benchmarks.analysis_growth` for programs of 1 to",
        "720 controllers; the largest fills the chip's flash. A step is an instruction that the",
        "analysis executes on abstract values, and *each* is the number of steps per instruction.",
        "Time is processor time relative to the smallest program.",
        "",
        "![Growth](../pictures/analysis-growth.png)",
        "",
        "Fitted over the programs, the number of steps grows with the size to the power of",
        f"{steps:.2f} and the processor time to the power of {times:.2f}.",
        "",
        f"| controllers | {columns}",
        rule,
        *(_row(point) for point in programs),
        "",
        "The next table has the examples, with the jobs of all tasks and the run-time services. A",
        "routine is analysed again for each call with different known values ([decision",
        "50](../decisions/0050-execution-times-by-abstract-interpretation.md)), and larger",
        "examples have deeper calls: the number of steps grows with the size to the power of",
        f"{deeper:.1f}.",
        "",
        f"| example | {columns}",
        rule.replace("---:", ":---", 1),
        *(_row(point) for point in examples),
    ]
    return "\n".join(lines) + "\n"


def write(points: Sequence[Point]) -> None:
    """The page and the picture."""
    _draw(points)
    PAGE.write_text(_page(points))


def main() -> int:
    """Write the page and the picture, print the points."""
    points = measured()
    write(points)
    print(json.dumps([asdict(point) for point in points], indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
