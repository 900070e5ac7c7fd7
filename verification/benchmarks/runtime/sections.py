# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Measures every critical section of the run-time and writes the table of the longest.

`python -m verification.benchmarks.runtime.sections` writes docs/reference/critical-sections.md.
Programs that
use all services run step by step on the virtual brick; each stretch with masked interrupts belongs
to the function that masked them. Functions of the library that mask but were not met are listed.
How the sections grow with the number of tasks is measured with sixteen of them.
"""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from verification.benchmarks.runtime import measure
from verification.benchmarks.runtime.steps import IRQ_VECTOR, Steps, steps_of
from verification.support.bricks.runtime_programs import RUNTIMES, build
from verification.support.paths import ROOT

__all__ = ["PAGE", "Section", "growth", "page"]

PAGE = ROOT / "docs" / "reference" / "critical-sections.md"
PROGRAMS = (
    ("load", "benchmark", 6_000_000),
    ("stress", "arm", 3_000_000),
    ("six_tasks", "arm", 1_500_000),
    ("timing_events", "arm", 2_000_000),
    ("fifo", "arm", 1_000_000),
    ("second_suspended", "arm", 1_000_000),
    ("yield", "arm", 1_000_000),
    ("termination", "arm", 1_000_000),
    ("jorvik_queues", "jorvik", 1_000_000),
    ("entry_order", "jorvik", 1_500_000),
)
EQUAL_PRIORITIES = ("equal_priorities", 1_500_000)
DELAY = "ravenbrick__delays__delay_until"
RING = "ravenbrick__delays__ring"
STEPS = 10
"""Of tasks, over which growth is measured."""
INTERRUPT = "ravenbrick_interrupt"
BEFORE_TASKS = ("ravenbrick_reset", "ravenbrick_start", "ravenbrick_initialize", "main", "adainit")
NO_SECTION = (
    *("__gnat_last_chance_handler", "preempt", "resume", "ravenbrick_reset"),
    "ravenbrick__execution_times",
)
"""The end of the program, parts of the exit of an interrupt, the start, and what the ordinary
kernel does not link."""
MASK = re.compile(r"\tmsr\tCPSR_c, #(?:223|211|210)\b|\torr\tr\d+, r\d+, #128\b")
FUNCTION = re.compile(r"^[0-9a-f]+ <([^>]+)>:$", re.MULTILINE)


@dataclass
class Section:
    """A function that masks interrupts, and its stretches in all programs."""

    function: str
    longest_cycles: int = 0
    ends_in: str = ""
    program: str = ""
    count: int = 0
    total_cycles: int = field(default=0, repr=False)

    def note(self, cycles: int, ends_in: str, program: str) -> None:
        """Take in one stretch."""
        self.count += 1
        self.total_cycles += cycles
        if cycles > self.longest_cycles:
            self.longest_cycles, self.ends_in, self.program = cycles, ends_in, program


def _image(program: str, kind: str) -> Path:
    if kind == "benchmark":
        return measure.image_of(program, "ram", "arm")
    return build(program, runtime=kind)


def _name(steps: Steps, begin: int) -> str:
    name = steps.function(begin)
    if name != INTERRUPT:
        return name
    return f"{name}, {'entry' if begin == IRQ_VECTOR else 'exit'}"


def longest_sections() -> dict[str, Section]:
    """Sections by function from `PROGRAMS`."""
    found: dict[str, Section] = {}
    for program, kind, cycles in PROGRAMS:
        steps = steps_of(_image(program, kind), 0, cycles)
        for length, begin, end in steps.masked():
            name = _name(steps, begin)
            if not name.startswith(BEFORE_TASKS):
                section = found.setdefault(name, Section(name))
                section.note(length, steps.function(end), program)
    return found


def growth() -> tuple[float, float]:
    """Cycles that each delayed task which wakes up no later adds to `delay until`, and each ready
    task as urgent to a release."""
    program, cycles = EQUAL_PRIORITIES
    steps = steps_of(measure.image_of(program, "ram", "arm"), 0, cycles)
    found: dict[str, list[int]] = {DELAY: [], RING: []}
    for length, begin, _ in steps.masked():
        found.setdefault(steps.function(begin), []).append(length)
    delays, rings = found[DELAY], found[RING]
    last = rings.index(max(rings))
    return (
        (delays[1 + STEPS] - delays[1]) / STEPS,
        (rings[last] - rings[last - STEPS]) / STEPS,
    )


def maskers(library: Path) -> set[str]:
    """Functions of a library with an instruction that masks interrupts."""
    text = subprocess.run(
        ["arm-none-eabi-objdump", "-d", str(library)], capture_output=True, text=True, check=True
    ).stdout
    pieces = FUNCTION.split(text)
    pairs = zip(pieces[1::2], pieces[2::2], strict=True)
    names = {name for name, code in pairs if MASK.search(code) and "msr" in code}
    return {name for name in names if not name.startswith(NO_SECTION)}


def _table(found: dict[str, Section], unmet: list[str], grown: tuple[float, float]) -> str:
    longest = max(section.longest_cycles for section in found.values())
    lines = [
        "# Critical sections",
        "",
        "Generated by `python -m verification.benchmarks.runtime.sections`. The table has the",
        "cycles with masked interrupts, for ARM code in RAM, from the instruction or exception",
        f"that masks to the instruction that unmasks. The longest section takes {longest} cycles.",
        "",
        "| Masked by | Longest | Mean | Count | Unmasked in | Program |",
        "|---|---:|---:|---:|---|---|",
    ]
    for section in sorted(found.values(), key=lambda s: (-s.longest_cycles, s.function)):
        mean = section.total_cycles / section.count
        lines.append(
            f"| `{section.function}` | {section.longest_cycles} | {mean:.1f} | {section.count} "
            f"| `{section.ends_in}` | {section.program} |"
        )
    lines += ["", "Functions that mask and were not observed: "]
    lines[-1] += (", ".join(f"`{name}`" for name in unmet) or "none") + "."
    lines += [
        "",
        f"Each delayed task with an earlier or equal wake-up time adds {grown[0]:g} cycles to the",
        "section of `delay until`. Each ready task with an equal or higher priority adds",
        f"{grown[1]:g} cycles to that of a release.",
    ]
    return "\n".join(lines) + "\n"


def _measured() -> tuple[dict[str, Section], list[str], tuple[float, float]]:
    """Sections, functions of the libraries that mask but were not met, growth."""
    found = longest_sections()
    met = {name.split(",")[0] for name in found}
    masking = maskers(RUNTIMES["arm"] / "adalib" / "libgnat.a")
    masking |= maskers(RUNTIMES["jorvik"] / "adalib" / "libgnat.a")
    return found, sorted(masking - met), growth()


def page() -> str:
    """The page's text."""
    return _table(*_measured())


def main() -> int:
    """Measure and write; 1 when a section is longer than the run-time's limit."""
    found, unmet, grown = _measured()
    PAGE.write_text(_table(found, unmet, grown))
    return int(max(s.longest_cycles for s in found.values()) > measure.LONGEST_MASKED_CYCLES)


if __name__ == "__main__":
    sys.exit(main())
