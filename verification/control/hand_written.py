# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles of generated controllers beside the same controllers in C written by hand.

`python -m verification.control.hand_written` measures on the virtual brick and writes
docs/reference/hand-written.md. Both give the bits of the simulation in every step.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from ravenbrick.codegen import check_program, random_vectors
from ravenbrick.control import DiscretePi, pi_diagram
from ravenbrick.model import (
    Delay,
    Diagram,
    DiscreteIntegrator,
    DiscreteStateSpace,
    DiscreteTransferFunction,
    Gain,
    Inport,
    IntegrationMethod,
    MachineState,
    Outport,
    StateMachine,
    Sum,
    Transition,
)
from ravenbrick.model.program import Program

from verification.commands import Counts
from verification.control.blocks import ADA, Form, measure
from verification.support.codegen.brick_cycles import image_of_checks, step_costs
from verification.support.codegen.c_build import WORD_FLAGS
from verification.support.paths import ROOT

__all__ = ["CONTROLLERS", "hand_written_forms", "suite"]

PAGE = ROOT / "docs" / "reference" / "hand-written.md"
HAND = Path(__file__).with_name("hand")
STEPS = 120
MOST = 1.15


def _pi() -> Diagram:
    pi = DiscretePi(0.314445, 0.032221, 0.004, IntegrationMethod.FORWARD_EULER)
    return pi_diagram(pi, 8.0, 0.037)


def _lqg() -> Diagram:
    diagram = Diagram("lqg", 0.004)
    block = DiscreteStateSpace(
        "Regulator",
        a=(
            (0.71, 0.04, -0.02, 0.01),
            (-0.35, 0.62, 0.15, -0.05),
            (0.05, -0.11, 0.83, 0.04),
            (-0.21, 0.09, -0.18, 0.55),
        ),
        b=((0.28, 0.03), (0.22, 0.31), (0.07, -0.02), (0.13, 0.24)),
        c=(-1.25, -0.5, 2.75, -0.375),
        d=(0.0, 0.0),
    )
    inputs = [diagram.add(Inport(name)) for name in ("Angle", "Speed")]
    diagram.add(block)
    for port, source in enumerate(inputs):
        diagram.connect(source, block, port)
    diagram.connect(block, diagram.add(Outport("Voltage")))
    return diagram


def _machine() -> Diagram:
    diagram = Diagram("machine", 0.004)
    states = {"idle": 0.0, "driving": 5.0, "turning": -1.5, "stopped": 0.25}
    gate = StateMachine(
        "Drive",
        machine_states=tuple(MachineState(*state) for state in states.items()),
        transitions=(
            Transition("idle", "driving", 0, ">=", 0.5),
            Transition("driving", "turning", 1, "<", -2.0),
            Transition("driving", "stopped", 0, "<", -6.0, after=8),
            Transition("turning", "driving", None, after=3),
            Transition("stopped", "idle", 0, ">", 6.0),
        ),
        ports=2,
    )
    inputs = [diagram.add(Inport(name)) for name in ("Start", "Distance")]
    diagram.add(gate)
    for port, source in enumerate(inputs):
        diagram.connect(source, gate, port)
    diagram.connect(gate, diagram.add(Outport("Speed")))
    return diagram


def _delay() -> Diagram:
    diagram = Diagram("delay", 0.004)
    chain = Inport("In"), Delay("Late", length=100), Outport("Out")
    diagram.connect_chain(*map(diagram.add, chain))
    return diagram


def _rates() -> Diagram:
    """An outer loop in every fifth step around a PI controller in each."""
    diagram = Diagram("rates", 0.004)
    slow = 0.02
    wanted, angle, speed = (diagram.add(Inport(n)) for n in ("Set_Point", "Angle", "Speed"))
    away = diagram.add(Sum("Away", signs="+-", sample_time=slow))
    smooth = DiscreteTransferFunction(
        "Smooth", numerator=(0.25, 0.0), denominator=(1.0, -0.75), sample_time=slow
    )
    strong = diagram.add(Gain("Strong", gain=4.0, sample_time=slow))
    weak = diagram.add(Gain("Weak", gain=0.5, sample_time=slow))
    drive = diagram.add(Sum("Drive", sample_time=slow))
    error = diagram.add(Sum("Error", signs="+-"))
    proportional = diagram.add(Gain("Proportional", gain=0.3125))
    integral = diagram.add(DiscreteIntegrator("Integral", gain=0.03125))
    voltage = diagram.add(Sum("Voltage"))
    diagram.connect(wanted, away, 0)
    diagram.connect(angle, away, 1)
    diagram.connect_chain(away, diagram.add(smooth), strong, drive, error)
    diagram.connect_chain(away, weak)
    diagram.connect(weak, drive, 1)
    diagram.connect(speed, error, 1)
    diagram.connect_chain(error, proportional, voltage, diagram.add(Outport("Out")))
    diagram.connect_chain(error, integral)
    diagram.connect(integral, voltage, 1)
    return diagram


CONTROLLERS: Mapping[str, tuple[str, Callable[[], Diagram]]] = {
    "pi": ("PI with anti-windup, tunable", _pi),
    "lqg": ("LQG of four states, two measurements", _lqg),
    "machine": ("state machine of four states with times", _machine),
    "delay": ("delay of 100 samples", _delay),
    "rates": ("PI in each step, outer loop in every fifth", _rates),
}


def hand_written_forms(programs: Mapping[str, Program]) -> dict[str, Form]:
    """The hand-written C of each program on the brick, with the same random inputs."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(HAND, folder, dirs_exist_ok=True)
        sources = []
        for key, program in programs.items():
            own = replace(program, name=f"hand_{key}")
            check = check_program(random_vectors(own, STEPS, seed=13))
            (folder / f"hand_{key}_check.c").write_text(check)
            sources += [f"hand_{key}.c", f"hand_{key}_check.c"]
        names = {f"hand_{key}": f"hand_{key}_step_instance" for key in programs}
        costs, brick = step_costs(image_of_checks(folder, names, sources, (), WORD_FLAGS), names)
        return {
            key: Form(brick.read_int(f"hand_{key}_check_failures", "u32"), costs[f"hand_{key}"])
            for key in programs
        }


def _forms() -> tuple[dict[str, Form], dict[str, Form]]:
    """By controller: hand-written, and generated (names as in the image)."""
    programs = {key: make().lower() for key, (_, make) in CONTROLLERS.items()}
    own = {
        f"{prefix}c_{key}": replace(program, name=f"{prefix}c_{key}")
        for key, program in programs.items()
        for prefix in ("", ADA)
    }
    return hand_written_forms(programs), measure(own, WORD_FLAGS, STEPS)


def _range(form: Form) -> str:
    least, most = form.cost.least_cycles, form.cost.most_cycles
    return f"{least}" if least == most else f"{least} to {most}"


def _ratio(form: Form, hand: Form) -> float:
    """Of the longest steps."""
    return form.cost.most_cycles / hand.cost.most_cycles


def suite() -> Counts:
    """Write the page; counts forms with the bits of the simulation and at most `MOST` times."""
    hand, own = _forms()
    rows, failures = [], []
    for key, (title, _) in CONTROLLERS.items():
        by_hand, cells = hand[key], []
        if by_hand.failures:
            failures.append(f"{key} by hand: {by_hand.failures} steps differ")
        for prefix in ("", ADA):
            form = own[f"{prefix}c_{key}"]
            ratio = _ratio(form, by_hand)
            cells.append(f"{_range(form)} | {ratio:.2f}")
            if form.failures or ratio > MOST:
                failures.append(f"{prefix}{key}: {form.failures} steps differ, ratio {ratio:.2f}")
        rows.append(f"| {title} | {_range(by_hand)} | {' | '.join(cells)} |")
    text = [
        "# Generated code beside code written by hand",
        "",
        "Generated by `python -m verification.control.hand_written`; do not edit. The table has",
        "the cycles of one step on the virtual brick, minimum to maximum: ARM code in RAM,",
        f"`-O2 {' '.join(WORD_FLAGS)}`, single precision, {STEPS} random steps. All forms of a",
        "controller give the same bits. The ratio is that of the longest steps to the C of",
        "`verification/control/hand`, which was written for the brick without the generator.",
        "",
        "| Controller | By hand, C | Generated C | Ratio | Generated Ada | Ratio |",
        "|---|---:|---:|---:|---:|---:|",
        *rows,
        "",
    ]
    PAGE.write_text("\n".join(text), encoding="utf-8")
    count = 3 * len(CONTROLLERS)
    return Counts(count, count - len(failures), failures=failures)


if __name__ == "__main__":
    counts = suite()
    print(PAGE.read_text(encoding="utf-8"), *counts.failures, sep="\n")
    sys.exit(0 if counts.passed == counts.case_count else 1)
