# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Model files written for tests, and runs of what they become."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from ravenbrick.model import Diagram, Execution

FIRST = '<?xml version="1.0" encoding="utf-8"?>\n'


def block(kind: str, name: str, number: int | str, inner: str = "", **parameters: object) -> str:
    """A block as newer files write it."""
    values = "".join(f'<P Name="{key}">{value}</P>' for key, value in parameters.items())
    return f'<Block BlockType="{kind}" Name="{name}" SID="{number}">{values}{inner}</Block>'


def line(source: str, *targets: str, name: str = "") -> str:
    """A line; several targets are branches."""
    head = f'<P Name="Name">{name}</P>' if name else ""
    head += f'<P Name="Src">{source}</P>'
    if len(targets) == 1:
        return f'<Line>{head}<P Name="Dst">{targets[0]}</P></Line>'
    branches = "".join(f'<Branch><P Name="Dst">{target}</P></Branch>' for target in targets)
    return f"<Line>{head}{branches}</Line>"


def single_file(path: Path, root: str) -> Path:
    """An .slx with everything in blockdiagram.xml, as until 2018."""
    inside = f"<ModelInformation><Model><System>{root}</System></Model></ModelInformation>"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("simulink/blockdiagram.xml", FIRST + inside)
    return path


def run(diagram: Diagram, *inputs: np.ndarray) -> np.ndarray:
    """The outputs over the steps, one column each; a vector if there is one."""
    execution = Execution(diagram)
    names = [slot.name for slot in execution.program.inputs]
    rows = zip(*inputs, strict=True) if inputs else [()] * 40
    steps = [
        [float(v) for v in execution.step(dict(zip(names, row, strict=True))).values()]
        for row in rows
    ]
    found = np.array(steps)
    return found[:, 0] if found.shape[1] == 1 else found


# A PI controller in a subsystem, its output limited and shown on a scope.
INNER = (
    block("Inport", "e", "3::1") + block("Gain", "Kp", "3::2", Gain="Kp_value*2")
    + block("DiscreteIntegrator", "I", "3::3", gainval="Ki", SampleTime="0.01",
            IntegratorMethod="Integration: Forward Euler", InitialCondition="0.5")
    + block("Sum", "Add", "3::4", Inputs="|++") + block("Outport", "u", "3::5")
    + line("3::1#out:1", "3::2#in:1", "3::3#in:1") + line("3::2#out:1", "3::4#in:1")
    + line("3::3#out:1", "3::4#in:2") + line("3::4#out:1", "3::5#in:1")
)  # fmt: skip
ROOT = (
    block("Inport", "ref", 1) + block("Saturate", "Lim it", 2, UpperLimit="3", LowerLimit="-3")
    + block("SubSystem", "PI", 3, "{inner}") + block("Outport", "out", 4)
    + block("Scope", "Scope", 5)
    + line("1#out:1", "3#in:1") + line("3#out:1", "2#in:1") + line("2#out:1", "4#in:1", "5#in:1")
)  # fmt: skip
VARIABLES = {"Kp_value": 0.5, "Ki": 2.0}


def whole_model(path: Path) -> Path:
    """The example in one file."""
    return single_file(path, ROOT.replace("{inner}", f"<System>{INNER}</System>"))
