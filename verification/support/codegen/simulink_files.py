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
