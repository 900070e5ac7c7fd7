# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles of generated step functions, counted instruction by instruction on the virtual brick."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from host.tests.codegen.c_build import arm_image
from host.tests.support.bench import silent_brick

# The first words: stack pointer and program counter from the two words behind them.
START = """\
extern void run_all(void);
static unsigned int stack[512];
extern const unsigned int first[];
__attribute__((section(".text.first"), used)) const unsigned int first[] = {
  0xE59FD000U, 0xE59FF000U, (unsigned int)&stack[512], (unsigned int)&run_all
};
"""
LIMIT_INSTRUCTIONS = 3_000_000


@dataclass(frozen=True)
class Cost:
    """Cycles of one step function over all its calls, and its size in bytes."""

    least_cycles: int
    most_cycles: int
    size_bytes: int


def image_of_checks(
    folder: Path,
    names: Iterable[str],
    sources: list[str],
    extra: tuple[Path, ...] = (),
    options: tuple[str, ...] = (),
) -> Path:
    """An image for the brick's RAM that runs `<name>_check` of all models and then stands."""
    calls = "".join(f"  {name}_check();\n" for name in names)
    declared = "".join(f"extern void {name}_check(void);\n" for name in names)
    text = f"{declared}volatile int run_done;\nextern void run_all(void);\n"
    text += f"void run_all(void)\n{{\n{calls}  run_done = 1;\n  for (;;) {{\n  }}\n}}\n"
    (folder / "run_all.c").write_text(text)
    (folder / "first.c").write_text(START)
    files = ["first.c", "run_all.c", *sources]
    return arm_image(folder, "first", *files, options=("-Wno-pedantic", *options), extra=extra)


def step_costs(image: Path, steps: dict[str, str]) -> tuple[dict[str, Cost], Any]:
    """Cost by model of the function `steps[model]`, and the brick after the run.

    From the call's first instruction to the first one after it; all calls are counted.
    """
    brick = silent_brick(image)
    symbols = {name: brick.symbol(function) for name, function in steps.items()}
    entries = {address: name for name, (address, _) in symbols.items()}
    ranges = {name: range(address, address + size) for name, (address, size) in symbols.items()}
    checks = {name: _range(brick, f"{name}_check") for name in steps}
    seen: dict[str, list[int]] = {name: [] for name in steps}
    for _ in range(LIMIT_INSTRUCTIONS):
        name = entries.get(brick.program_counter)
        if name is None:
            brick.run_until(brick.cycles + 1)
            if brick.read_int("run_done", "u32"):
                break
            continue
        begin = brick.cycles
        while brick.program_counter not in checks[name]:
            brick.run_until(brick.cycles + 1)
        seen[name].append(brick.cycles - begin)
    costs = {
        name: Cost(min(cycles), max(cycles), len(ranges[name])) for name, cycles in seen.items()
    }
    return costs, brick


def _range(brick: Any, function: str) -> range:
    address, size = brick.symbol(function)
    return range(address, address + size)
