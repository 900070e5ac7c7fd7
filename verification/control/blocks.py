# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every block as simulation, C and Ada, and the paper's controller in float and fixed point.

`python -m verification.control.blocks` compares and measures on the virtual brick and writes
docs/reference/blocks.md.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from ravenbrick.codegen import check_program, generate_ada, generate_c, prove, random_vectors
from ravenbrick.model import Execution, FixedFormat, FixedPoint, Rounding
from ravenbrick.model.program import Program, with_constants

from verification.commands import Counts
from verification.support.codegen.block_programs import FIXED, fixed_program
from verification.support.codegen.block_table import TABLE, block_diagram
from verification.support.codegen.brick_cycles import Cost, image_of_checks, step_costs
from verification.support.codegen.c_build import WORD_FLAGS, ada_object
from verification.support.codegen.paper_pi import LOOP, fixed_pi, paper_pi, plant
from verification.support.codegen.random_diagrams import fixed_form, random_diagram
from verification.support.paths import ROOT

PAGE = ROOT / "docs" / "reference" / "blocks.md"
STEPS = 24
SHARE = 12
ADA = "ada_"


@dataclass(frozen=True)
class Form:
    """A block in one language: differing steps and cost."""

    failures: int
    cost: Cost


def named(program: Program, prefix: str, name: str) -> Program:
    """The program under a name of its own in the image."""
    return replace(program, name=f"{prefix}{name}")


def measure(
    programs: Mapping[str, Program], options: tuple[str, ...] = (), steps: int = STEPS
) -> dict[str, Form]:
    """All programs on the brick, a dozen per image; those named `ada_...` in Ada."""
    found: dict[str, Form] = {}
    names = list(programs)
    for first in range(0, len(names), SHARE):
        share = {name: programs[name] for name in names[first : first + SHARE]}
        with tempfile.TemporaryDirectory() as folder:
            found |= _measure_share(share, Path(folder), options, steps)
        print(f"  {min(first + SHARE, len(names))} of {len(names)} programs", file=sys.stderr)
    return found


def _measure_share(
    programs: Mapping[str, Program], folder: Path, options: tuple[str, ...], steps: int
) -> dict[str, Form]:
    sources, objects = [], []
    for name, program in programs.items():
        generate_c(program).write(folder)
        if name.startswith(ADA):
            generate_ada(program, c_names=True).write(folder)
            objects.append(ada_object(folder, f"{name}.adb", checks=False))
        else:
            sources.append(f"{name}.c")
        ports = f"ExternalInputs_{name} {name}_U;\nExternalOutputs_{name} {name}_Y;\n"
        (folder / f"{name}_ports.c").write_text(f'#include "{name}.h"\n{ports}')
        check = check_program(random_vectors(program, steps, seed=13))
        (folder / f"{name}_check.c").write_text(check)
        sources += [f"{name}_ports.c", f"{name}_check.c"]
    image = image_of_checks(folder, programs, sources, tuple(objects), options)
    costs, brick = step_costs(image, {name: f"{name}_step_instance" for name in programs})
    forms = {}
    for name in programs:
        assert brick.read_int(f"{name}_check_steps", "u32") == steps, name
        forms[name] = Form(brick.read_int(f"{name}_check_failures", "u32"), costs[name])
    return forms


def definition_error(name: str) -> float:
    """Worst difference of the single-precision simulation from the block's definition."""
    execution = Execution(block_diagram(name))
    inputs = np.random.default_rng(3).uniform(-10, 10, (300, len(execution.program.inputs)))
    inputs = inputs.astype(np.float32).astype(float)
    return _worst(execution, inputs, TABLE[name][1](inputs), lambda value: value, lambda raw: raw)


def fixed_error(name: str) -> float:
    """Worst difference of the fixed-point simulation from the block's definition."""
    program = fixed_program(name)
    execution = Execution(program)
    forms = [slot.data_type for slot in (*program.inputs, *program.outputs)]
    entering, leaving = forms[0], forms[-1]
    assert isinstance(entering, FixedFormat) and isinstance(leaving, FixedFormat)
    inputs = np.random.default_rng(3).uniform(-2, 2, (60, len(program.inputs)))
    inputs = np.array([[entering.real(entering.raw(v)) for v in row] for row in inputs])
    return _worst(execution, inputs, TABLE[name][1](inputs), entering.raw, leaving.real)


def _worst(execution, inputs, expected, enter, leave):  # type: ignore[no-untyped-def]
    names = [slot.name for slot in execution.program.inputs]
    worst = 0.0
    for row, target in zip(inputs, expected, strict=True):
        result = execution.step({n: enter(float(v)) for n, v in zip(names, row, strict=True)})
        worst = max(worst, abs(float(leave(next(iter(result.values())))) - float(target)))
    return worst


def block_forms() -> dict[str, Form]:
    """Each block in C and Ada, single precision and where it exists fixed point."""
    programs: dict[str, Program] = {}
    for name in TABLE:
        program = block_diagram(name).lower()
        programs[f"b_{name}"] = named(program, "b_", name)
        programs[f"{ADA}{name}"] = named(program, ADA, name)
    for name in FIXED:
        fixed = fixed_program(name)
        programs[f"fx_{name}"] = named(fixed, "fx_", name)
        programs[f"{ADA}fx_{name}"] = named(fixed, f"{ADA}fx_", name)
    return measure(programs, WORD_FLAGS)


def _cell(form: Form | None) -> str:
    if form is None:
        return "no form"
    cycles = form.cost
    text = f"{cycles.least_cycles}"
    if cycles.most_cycles != cycles.least_cycles:
        text += f" to {cycles.most_cycles}"
    return text if form.failures == 0 else f"**{form.failures} steps differ**"


def block_rows(forms: Mapping[str, Form]) -> list[str]:
    """Rows of the table of blocks."""
    rows = []
    for name in TABLE:
        fixed = f"{fixed_error(name):.1e}" if name in FIXED else "no form"
        cells = [_cell(forms.get(key)) for key in
                 (f"b_{name}", f"{ADA}{name}", f"fx_{name}", f"{ADA}fx_{name}")]  # fmt: skip
        kind = type(TABLE[name][0]).__name__
        rows.append(
            f"| `{kind}` ({name}) | {definition_error(name):.1e} | {fixed} | {' | '.join(cells)} |"
        )
    return rows


LOTS = 16


def lot_forms() -> dict[str, Form]:
    """Random diagrams in C and Ada, in single precision and in fixed point."""
    programs: dict[str, Program] = {}
    for seed in range(LOTS):
        single = random_diagram(seed).lower()
        fixed = fixed_form(random_diagram(100 + seed, fixed=True))
        for name, program in (("lot", single), ("fixed", fixed)):
            if program is not None:
                for prefix in ("", ADA):
                    key = f"{prefix}{name}_{seed}"
                    programs[key] = replace(program, name=key)
    return measure(programs, WORD_FLAGS)


def lot_lines(forms: Mapping[str, Form]) -> list[str]:
    """One row per language and number format."""
    rows = []
    for prefix, name, title in (
        ("", "lot", "C, single precision"), (ADA, "lot", "Ada, single precision"),
        ("", "fixed", "C, fixed point"), (ADA, "fixed", "Ada, fixed point"),
    ):  # fmt: skip
        found = [form for key, form in forms.items() if key.startswith(f"{prefix}{name}_")]
        differing = sum(form.failures for form in found)
        least = min(form.cost.least_cycles for form in found)
        most = max(form.cost.most_cycles for form in found)
        rows.append(f"| {title} | {len(found)} | {differing} | {least} to {most} |")
    return rows


def loop_error(fixed: FixedPoint) -> float:
    """Largest difference from real-number control on the same plant, V; 20,000 steps."""
    system = plant().system
    pole, drive = float(system.A[0, 0]), float(system.B[0, 0] * system.C[0, 0])
    held = {s.name: s.data_type.real(int(s.initial)) for s in fixed.program.parameters}
    execution, random = Execution(fixed.program), np.random.default_rng(4)
    speed, exact, integral, worst = 0.0, 0.0, 0.0, 0.0
    for level in np.repeat(random.integers(-8192, 8192, 200), 100):
        inputs = {"Input_Voltage": int(level), "Speed": round(speed * 1024)}
        error = level / 2048 - held["Scale"] * (exact + inputs["Speed"] / 1024 - speed)
        command = held["Kp"] * error + integral
        integral += held["Ki_Ts"] * error
        volts = execution.step(inputs)["correctedvoltage"] / 2048
        speed, exact = pole * speed + drive * volts, pole * exact + drive * command
        worst = max(worst, abs(speed - exact) * LOOP.feedback_gain)
    return worst


def controller_rows() -> tuple[list[str], dict[str, Form]]:
    """The paper's controller: form, cycles, bytes, bound and observed error."""
    nearest, cut = fixed_pi(Rounding.NEAREST), fixed_pi(Rounding.ZERO)
    programs = {
        "single_precision": paper_pi().lower(),
        f"{ADA}single_precision": paper_pi().lower(),
        "tunable_fixed": nearest.program,
        "constant_fixed": with_constants(nearest.program),
        "cut_fixed": with_constants(cut.program),
        f"{ADA}fixed": nearest.program,
    }
    forms = measure({n: replace(p, name=n) for n, p in programs.items()}, WORD_FLAGS)
    about = {
        "single_precision": ("C, single precision, tunable", None),
        f"{ADA}single_precision": ("Ada, single precision, tunable", None),
        "tunable_fixed": ("C, fixed point, rounded, tunable", nearest),
        "constant_fixed": ("C, fixed point, rounded, constant gains", nearest),
        "cut_fixed": ("C, fixed point, cut, constant gains", cut),
        f"{ADA}fixed": ("Ada, fixed point, rounded, constant gains", nearest),
    }
    rows = []
    for name, (title, fixed) in about.items():
        bound = observed = "not stated"
        if fixed is not None:
            loop = prove(fixed, plant()).closed_loop
            assert loop is not None
            bound, observed = f"{1000 * loop.rounding:.3f} mV", f"{1000 * loop_error(fixed):.3f} mV"
        cells = f"{_cell(forms[name])} | {forms[name].cost.size_bytes}"
        rows.append(f"| {title} | {cells} | {bound} | {observed} |")
    return rows, forms


def page(block_lines: list[str], lots: list[str], controller_lines: list[str]) -> str:
    """The reference page."""
    return "\n".join(
        [
            "# Blocks and their costs",
            "",
            "Generated by `python -m verification.control.blocks`; do not edit. The cycles of one",
            "step are measured on the virtual brick: ARM code in RAM,",
            f"`-O2 {' '.join(WORD_FLAGS)}`, {STEPS} random steps, minimum to maximum. In every",
            "step C and Ada have the bits of the simulation; a cell would state a difference. The",
            "difference columns compare the simulation, in single precision and in fixed point,",
            "with the block's definition in double precision, for inputs within 10 (fixed point:",
            "2). A quantiser may choose the other of two equally near levels. User-defined",
            "functions, quotients, sines of signals, roots, angles, and a ramp without end have no",
            "fixed-point form; use a LookupTable instead.",
            "",
            "| Block | Single: difference | Fixed: difference | C single | Ada single | C fixed "
            "| Ada fixed |",
            "|---|---:|---:|---:|---:|---:|---:|",
            *block_lines,
            "",
            "## Random diagrams",
            "",
            "Each diagram has twelve blocks, with feedback, slower rates and enabled subsystems;",
            "the fixed-point diagrams have only blocks with a fixed-point form.",
            "",
            "| Form | Diagrams | Steps that differ from the simulation | Cycles |",
            "|---|---:|---:|---:|",
            *lots,
            "",
            "## The paper's PI controller",
            "",
            "One step consists of scaling, PI controller and limit. *Bound* is for the error in",
            "the loop with the motor, for unlimited time; *Observed* is the largest error in",
            "20,000 steps with random set-points.",
            "",
            "| Form | Cycles | Bytes | Bound | Observed |",
            "|---|---:|---:|---:|---:|",
            *controller_lines,
            "",
        ]
    )


def suite() -> Counts:
    """Write the page; counts programs and those that equal their simulation."""
    forms = block_forms()
    controllers, own = controller_rows()
    lots = lot_forms()
    text = page(block_rows(forms), lot_lines(lots), controllers)
    PAGE.write_text(text, encoding="utf-8")
    everything = [*forms.values(), *lots.values(), *own.values()]
    return Counts(len(everything), sum(form.failures == 0 for form in everything))


if __name__ == "__main__":
    counts = suite()
    print(f"{counts.passed} of {counts.case_count} programs equal their simulation")
    sys.exit(0 if counts.passed == counts.case_count else 1)
