# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How the work of the execution-time analysis grows with the size of the program.

`python -m benchmarks.analysis_growth` generates programs of 1 to 720 controllers, each with a
filter, a state machine, a table search and calls of a shared library, compiles them, bounds each
and writes docs/reference/analysis-growth.{md,svg}. Counted are the instructions that the analysis
executes on abstract values; times are relative to the smallest program, the least of two runs.
"""

from __future__ import annotations

import json
import random
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import matplotlib as mpl
from elftools.elf.elffile import ELFFile
from ravenbrick.timing.bounds import execution_times

mpl.use("Agg")
from matplotlib import pyplot as plt

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reference" / "analysis-growth.md"
PICTURE = PAGE.with_suffix(".svg")
COUNTS = (1, 2, 4, 8, 16, 32, 64, 96, 128, 192, 256, 384, 720)
OPTIONS = (
    "-mcpu=arm7tdmi", "-marm", "-Os", "-g", "-nostdlib", "-ffreestanding",
    "-Wl,-Ttext=0x100000", "-Wl,-Tbss=0x200000", "-Wl,-Tdata=0x208000", "-Wl,-estep",
)  # fmt: skip
FLASH_BYTES = 256 * 1024
RUNS = 2


@dataclass(frozen=True)
class Point:
    """One program and what its analysis went through."""

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


def measured() -> list[Point]:
    """All programs."""
    points, times = [], []
    for count in COUNTS:
        with tempfile.TemporaryDirectory() as folder:
            elf, size = _compiled(count, Path(folder))
        if size > FLASH_BYTES:
            raise SystemExit(f"{count} controllers: {size} bytes do not fit the flash")
        spent = []
        for _ in range(RUNS):
            begin = time.process_time()
            found = execution_times(elf, functions=["step"])
            spent.append(time.process_time() - begin)
        times.append(min(spent))
        work = found.work
        points.append(
            Point(
                count,
                size,
                work["functions"],
                work["blocks"],
                work["loops"],
                work["instructions"],
                work["steps"],
                found.functions[0].cycles,
                round(times[-1] / times[0], 1),
            )
        )
        print(asdict(points[-1]), file=sys.stderr, flush=True)
    return points


def _draw(points: list[Point]) -> None:
    figure, axes = plt.subplots(figsize=(7, 4.2))
    sizes = [point.text_bytes / 1024 for point in points]
    first = points[0]
    axes.loglog(sizes, [p.steps / first.steps for p in points], "o-", label="abstract steps")
    axes.loglog(sizes, [p.relative_time for p in points], "s-", label="processor time")
    straight = [p.text_bytes / first.text_bytes for p in points]
    axes.loglog(sizes, straight, "k:", label="in proportion to the size")
    axes.set_xlabel("machine code, KB")
    axes.set_ylabel("times the smallest program")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    figure.tight_layout()
    with mpl.rc_context({"svg.hashsalt": "growth"}):
        figure.savefig(PICTURE, metadata={"Date": None})
    plt.close(figure)


def _page(points: list[Point]) -> str:
    lines = [
        "<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->",
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        "# Growth of the execution-time analysis",
        "",
        "Generated by `python -m benchmarks.analysis_growth`: programs of 1 to 720 controllers, up",
        "to what fits the chip's flash. Steps are instructions that the analysis executes on",
        "abstract values, *each* is their number by instruction; time is processor time relative",
        "to the smallest program.",
        "",
        "![Growth](analysis-growth.svg)",
        "",
        "| controllers | bytes | functions | blocks | loops | instructions | steps | each | time |",
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    lines += [
        f"| {p.controllers} | {p.text_bytes} | {p.functions} | {p.blocks} | {p.loops} | "
        f"{p.instructions} | {p.steps} | {p.steps / p.instructions:.1f} | {p.relative_time} |"
        for p in points
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write the page and the picture, print the points."""
    points = measured()
    _draw(points)
    PAGE.write_text(_page(points))
    print(json.dumps([asdict(point) for point in points], indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
