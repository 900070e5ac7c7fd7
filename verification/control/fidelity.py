# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of random controllers in single precision, as C, against sixty decimal digits.

`python -m verification.control.fidelity` writes docs/reference/fidelity.md.
"""

from __future__ import annotations

import ctypes
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from ravenbrick.brick.step_cost import compile_and_count
from ravenbrick.codegen import generate_c
from ravenbrick.errors import DesignError
from ravenbrick.model import Execution, ZeroPoleGain, fidelity

from verification.commands import Counts
from verification.support.codegen.c_build import run
from verification.support.codegen.controller_forms import (
    FORMS,
    exact_answer,
    form_diagram,
    random_controller,
)
from verification.support.paths import ROOT

PAGE = ROOT / "docs" / "reference" / "fidelity.md"
CONTROLLERS = 200
COSTED = 24
RATES_MS = (0.5, 1, 4, 20)
SECONDS = 20
TOLERANCE = 1e-3
SEED = 20
DEFAULT = "delta"
COST_SHARE = 1.3
_NOTCH = tuple(map(complex, np.roots([1, 3, 900]))), tuple(map(complex, np.roots([1, 42, 900])))
# The armature-controlled motor of Messner and Tilbury's control tutorials, from volts to its angle.
_MOTOR = tuple(map(complex, np.roots([0.01 * 0.5, 0.01 + 0.1 * 0.5, 0.1 + 0.01**2, 0])))
DESIGNS = {
    "1 / (s (s + 1)²), 4 ms": (ZeroPoleGain((), (0j, -1 + 0j, -1 + 0j), 1.0), 0.004),
    "PI, lead and notch, 1 ms": (
        ZeroPoleGain((-2 + 0j, -5 + 0j, *_NOTCH[0]), (0j, -50 + 0j, *_NOTCH[1]), 10.0), 0.001),
    "the same with a pole at 0.01 rad/s": (
        ZeroPoleGain((-2 + 0j, -5 + 0j, *_NOTCH[0]), (0j, -0.01 + 0j, -50 + 0j, *_NOTCH[1]), 0.1),
        0.001),
    "angle of a DC motor, 1 ms": (ZeroPoleGain((), _MOTOR, 0.01 / (0.01 * 0.5)), 0.001),
    "1 / (s (0.0639 s + 1)), 0.5 ms": (ZeroPoleGain((), (0j, -1 / 0.0639 + 0j), 1.0), 0.0005),
}  # fmt: skip


@dataclass
class Figures:
    """By rate and form the errors, and those that the gate computes; cycles of a step by form.

    One per controller.
    """

    errors: dict[tuple[float, str], list[float]]
    judged: dict[tuple[float, str], list[float]]
    cycles: dict[str, list[int]]

    def missed(self, rate: float, form: str) -> int:
        """Wrong ones that the gate lets pass."""
        pairs = zip(self.errors[rate, form], self.judged[rate, form], strict=True)
        return sum(not error <= TOLERANCE and judged <= TOLERANCE for error, judged in pairs)


def controllers(count: int = CONTROLLERS) -> list[ZeroPoleGain]:
    """The same ones each time."""
    random = np.random.default_rng(SEED)
    return [random_controller(random) for _ in range(count)]


def _driver(name: str) -> str:
    return (
        f'#include "{name}.h"\nExternalInputs_{name} {name}_U;\nExternalOutputs_{name} {name}_Y;\n'
        f"void {name}_run(int steps, int down, float *out);\n"
        f"void {name}_run(int steps, int down, float *out)\n{{\n  int k;\n"
        f"  {name}_initialize();\n  for (k = 0; k < steps; k++) {{\n"
        f"    {name}_U.In = (k < down) ? 1.0F : 0.0F;\n    {name}_step();\n"
        f"    out[k] = {name}_Y.Out;\n  }}\n}}\n"
    )


def judged_at(rate_ms: float, systems: Sequence[ZeroPoleGain]) -> dict[str, list[float]]:
    """The worst error that the gate computes, by form."""
    found = {}
    for form, build in FORMS.items():
        compared = (
            fidelity(form_diagram(build(system.sampled(rate_ms / 1000)), rate_ms / 1000))
            for system in systems
        )
        found[form] = [max((one.worst for one in row.blocks), default=0.0) for row in compared]
    return found


def errors_at(rate_ms: float, systems: Sequence[ZeroPoleGain]) -> dict[str, list[float]]:
    """Largest error over the largest output by form, with the forms' C compiled for this host."""
    steps, down = round(1000 * SECONDS / rate_ms), round(500 * SECONDS / rate_ms)
    found: dict[str, list[float]] = {form: [] for form in FORMS}
    with tempfile.TemporaryDirectory() as text:
        folder, sources = Path(text), []
        for index, system in enumerate(systems):
            for form, build in FORMS.items():
                name = f"{form}_{index}"
                sampled = system.sampled(rate_ms / 1000)
                code = generate_c(form_diagram(build(sampled), sampled.dt, name), tolerance=None)
                code.write(folder)
                (folder / f"{name}_run.c").write_text(_driver(name))
                sources += [folder / f"{name}.c", folder / f"{name}_run.c"]
        library = folder / "forms.so"
        whole = folder / "whole.c"
        whole.write_text("".join(f'#include "{source}"\n' for source in sources))
        run("gcc", "-O1", "-std=c99", "-shared", "-fPIC", f"-I{folder}", whole, "-o", library)
        loaded = ctypes.CDLL(str(library))
        for index, system in enumerate(systems):
            exact = exact_answer(system, rate_ms / 1000, steps, down)
            for form in FORMS:
                out = np.zeros(steps, dtype=np.float32)
                pointer = out.ctypes.data_as(ctypes.POINTER(ctypes.c_float))
                getattr(loaded, f"{form}_{index}_run")(steps, down, pointer)
                with np.errstate(all="ignore"):
                    error = float(np.abs(out - exact).max() / np.abs(exact).max())
                found[form].append(error if np.isfinite(error) else np.inf)
    return found


def cycles_of(systems: Sequence[ZeroPoleGain]) -> dict[str, list[int]]:
    """Most cycles of a step on the virtual brick."""
    found: dict[str, list[int]] = {form: [] for form in FORMS}
    for index, system in enumerate(systems):
        sampled = system.sampled(0.004)
        programs = {
            f"{form}_{index}": form_diagram(build(sampled), sampled.dt).lower()
            for form, build in FORMS.items()
        }
        costs = compile_and_count(programs, tolerance=None)
        for form in FORMS:
            found[form].append(costs[f"{form}_{index}"].most_cycles)
    return found


def measured() -> Figures:
    """All rates and forms."""
    systems = controllers()
    errors: dict[tuple[float, str], list[float]] = {}
    judged: dict[tuple[float, str], list[float]] = {}
    for rate in RATES_MS:
        for found, at in ((errors, errors_at), (judged, judged_at)):
            found.update({(rate, form): values for form, values in at(rate, systems).items()})
        print(f"  {rate:g} ms done", file=sys.stderr)
    return Figures(errors, judged, cycles_of(systems[:COSTED]))


@dataclass
class Design:
    """A design's answer to a unit step at the end: exact, and by form; the gate's words."""

    name: str
    exact: float
    ends: dict[str, float]
    words: str

    @property
    def is_right(self) -> bool:
        """Whether the default form is right, and the direct one is refused."""
        close = abs(self.ends[DEFAULT] - self.exact) <= TOLERANCE * abs(self.exact)
        return close and "would not do what was designed" in self.words


def designs() -> list[Design]:
    """Some whose direct forms are wrong, in the simulation that has the bits of the C."""
    found = []
    for name, (system, sample_time) in DESIGNS.items():
        steps, ends = round(SECONDS / sample_time) + 1, {}
        for form in ("direct", DEFAULT):
            diagram = form_diagram(FORMS[form](system.sampled(sample_time)), sample_time)
            execution = Execution(diagram)
            for _ in range(steps):
                ends[form] = float(execution.step({"In": 1.0})["Out"])
        words = "no refusal"
        try:
            generate_c(form_diagram(FORMS["direct"](system.sampled(sample_time)), sample_time))
        except DesignError as error:
            words = f"{error}"
        exact = float(exact_answer(system, sample_time, steps, steps)[-1])
        found.append(Design(name, exact, ends, words))
    return found


def _gate_lines(figures: Figures) -> list[str]:
    heads = " | ".join(f"refused at {rate:g} ms | missed" for rate in RATES_MS)
    lines = [
        "",
        "## Refusals by the gate",
        "",
        "The gate of `generate_c` sees neither the C nor the sixty digits: it runs a step of up",
        "to 20 s and compares responses ([how far](../guides/modelling.md)). Missed: wrong by the",
        "table above, and not refused. Some are refused for a response that this step does not",
        "show.",
        "",
        f"| Form | {heads} |",
        "|---|" + "---:|---:|" * len(RATES_MS),
    ]
    for form in FORMS:
        cells = []
        for rate in RATES_MS:
            refused = sum(not error <= TOLERANCE for error in figures.judged[rate, form])
            cells += [f"{refused}", f"{figures.missed(rate, form)}"]
        lines.append(f"| {form} | {' | '.join(cells)} |")
    return lines


def _design_lines(found: Sequence[Design]) -> list[str]:
    return [
        "",
        "## Designs and the gate",
        "",
        f"Their answers to a unit step after {SECONDS} s. The last column is what `generate_c`",
        "says of the direct form, which it refuses.",
        "",
        "| Design | Exact | Direct form | Default form | Refusal |",
        "|---|---:|---:|---:|---|",
        *(f"| {one.name} | {one.exact:.5g} | {one.ends['direct']:.5g} | "
          f"{one.ends[DEFAULT]:.5g} | {one.words} |" for one in found),
    ]  # fmt: skip


def page(figures: Figures, found: Sequence[Design]) -> str:
    """The table of forms."""
    share = np.array(figures.cycles[DEFAULT]) / np.array(figures.cycles["cascade"])
    lines = [
        "# Numeric forms of controllers",
        "",
        "Generated by `python -m verification.control.fidelity`; do not edit.",
        f"{CONTROLLERS} random controllers (stable or integrating, order 1 to 7, real and complex",
        "roots over four decades), sampled by Tustin's method, answer a step up and down within",
        f"{SECONDS} s: the generated C in single precision against difference equations in sixty",
        "decimal digits. A controller is wrong if its largest error exceeds 0.1 % of its largest",
        f"output. Cycles: mean of the longest steps of {COSTED} of them on the virtual brick.",
        "",
        f"| Form | {' | '.join(f'wrong at {rate:g} ms | worst' for rate in RATES_MS)} | cycles |",
        "|---|" + "---:|---:|" * len(RATES_MS) + "---:|",
    ]
    for form in FORMS:
        cells = []
        for rate in RATES_MS:
            values = figures.errors[rate, form]
            cells.append(f"{sum(not value <= TOLERANCE for value in values)}")
            cells.append(f"{max(values):.1e}")
        lines.append(f"| {form} | {' | '.join(cells)} | {np.mean(figures.cycles[form]):.0f} |")
    lines += [
        "",
        f"The default form (delta) takes {share.mean():.2f} times the cycles of the cascade in the",
        f"mean, at most {share.max():.2f} times.",
        *_gate_lines(figures),
        *_design_lines(found),
    ]
    return "\n".join(lines) + "\n"


def suite() -> Counts:
    """Write the page; counts controllers at all rates and designs that are within 1e-3."""
    figures, found = measured(), designs()
    PAGE.write_text(page(figures, found), encoding="utf-8")
    own = [value for rate in RATES_MS for value in figures.errors[rate, DEFAULT]]
    costs = np.array(figures.cycles[DEFAULT]) / np.array(figures.cycles["cascade"])
    passed = sum(value <= TOLERANCE for value in own)
    passed += sum(one.is_right for one in found)
    return Counts(len(own) + len(found) + 1, passed + bool(costs.mean() <= COST_SHARE))


if __name__ == "__main__":
    counts = suite()
    print(f"{counts.passed} of {counts.case_count} cases hold")
    sys.exit(0 if counts.passed == counts.case_count else 1)
