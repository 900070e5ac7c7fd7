# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles of generated step functions, counted instruction by instruction on the virtual brick."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ravenbrick.codegen import check_program, generate_c, random_vectors
from ravenbrick.errors import BuildError, RunFaultError, ToolMissingError
from ravenbrick.installation import advice_for_packages
from ravenbrick.model.fidelity import TOLERANCE
from ravenbrick.model.program import Program
from ravenbrick.subprocesses import run_child

__all__ = ["FIRST_WORDS", "StepCost", "compile_and_count", "count_steps"]

COMPILER = "arm-none-eabi-gcc"
PACKAGE = "gcc-arm-none-eabi"
ORIGIN = 0x0020_2000
# This processor has no load delays: to reorder before registers are chosen only costs registers.
FLAGS = (
    "-O2", "-fno-schedule-insns", "-mcpu=arm7tdmi", "-ffreestanding", "-ffunction-sections",
    "-fno-short-enums",
)  # fmt: skip
LIMIT_INSTRUCTIONS = 3_000_000
STEPS = 24
BENCH = {
    "seed": 1,
    "battery": {"kind": "li_ion", "voltage": 8.0, "internal_resistance": 0.0},
    "body": {"kind": "bench"},
}
# The first words: stack pointer and program counter from the two words behind them.
FIRST_WORDS = """\
extern void run_all(void);
static unsigned int stack[512];
extern const unsigned int first[];
__attribute__((section(".text.first"), used)) const unsigned int first[] = {
  0xE59FD000U, 0xE59FF000U, (unsigned int)&stack[512], (unsigned int)&run_all
};
"""


@dataclass(frozen=True)
class StepCost:
    """Cycles of one step function over all its calls, and its size in bytes.

    In ARM code in RAM; functions of the compiler's library that it calls count as time, not as
    size.
    """

    least_cycles: int
    most_cycles: int
    size_bytes: int


def compile_and_count(
    programs: Mapping[str, Program], tolerance: float | None = TOLERANCE
) -> dict[str, StepCost]:
    """Generate, compile and run each program with random inputs; names are C names.

    `tolerance` as for `generate_c`.

    Raises `ToolMissingError` without the cross compiler, `BuildError` if it refuses, and
    `RunFaultError` if a result is not that of the simulation.
    """
    if shutil.which(COMPILER) is None:
        raise ToolMissingError(f"{COMPILER} is not installed; {advice_for_packages([PACKAGE])}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sources = [folder / "first.c", folder / "run_all.c"]
        sources[0].write_text(FIRST_WORDS)
        sources[1].write_text(_run_all(programs))
        for model, program in programs.items():
            own = replace(program, name=model)
            generate_c(own, tolerance=tolerance).write(folder)
            ports = f"ExternalInputs_{model} {model}_U;\nExternalOutputs_{model} {model}_Y;\n"
            check = check_program(random_vectors(own, STEPS, seed=13))
            (folder / f"{model}_check.c").write_text(f'#include "{model}.h"\n{ports}{check}')
            sources += [folder / f"{model}.c", folder / f"{model}_check.c"]
        image = folder / "image.elf"
        link = ("-nostdlib", f"-Wl,-Ttext={ORIGIN:#x}", "-Wl,--entry=first", "-Wl,--gc-sections")
        command = [COMPILER, *FLAGS, *link, *map(str, sources), "-lgcc", "-o", str(image)]
        done = run_child(command, errors_apart=True)
        if done.returncode != 0:
            raise BuildError("the generated C does not compile", detail=done.stderr[-2000:])
        costs, brick = count_steps(image, {m: f"{m}_step_instance" for m in programs})
        for model in programs:
            if brick.read_int(f"{model}_check_failures", "u32"):
                raise RunFaultError(f"'{model}' gives other results on the brick than simulated")
    return costs


def _run_all(programs: Mapping[str, Program]) -> str:
    calls = "".join(f"  {name}_check();\n" for name in programs)
    declared = "".join(f"extern void {name}_check(void);\n" for name in programs)
    text = f"{declared}volatile int run_done;\nextern void run_all(void);\n"
    return f"{text}void run_all(void)\n{{\n{calls}  run_done = 1;\n  for (;;) {{\n  }}\n}}\n"


def count_steps(image: Path, steps: Mapping[str, str]) -> tuple[dict[str, StepCost], Any]:
    """Cost by model of the function `steps[model]`, and the brick after the run.

    From the call's first instruction to the first one after it; all calls are counted. The image
    calls `<model>_check` of each model and then sets `run_done`.
    """
    import virtual_brick

    brick = virtual_brick.VirtualBrick(json.dumps(BENCH), image.read_bytes())
    symbols = {name: brick.symbol(function) for name, function in steps.items()}
    entries = {address: name for name, (address, _) in symbols.items()}
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
        name: StepCost(min(cycles), max(cycles), symbols[name][1]) for name, cycles in seen.items()
    }
    return costs, brick


def _range(brick: Any, function: str) -> range:
    address, size = brick.symbol(function)
    return range(address, address + size)
