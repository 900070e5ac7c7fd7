# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""New projects whose whole program is made from a diagram: no Ada is written by hand."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from ravenbrick.codegen import control_task, generate_c
from ravenbrick.codegen.control_task import TASK_PRIORITY, TASK_STACK_BYTES
from ravenbrick.model import Diagram, Inport, Outport, diagram_text, read_diagram
from ravenbrick.project.templates import FROM_DIAGRAM, create_from
from ravenbrick.project.workspace import Workspace

__all__ = ["create_from_diagram", "empty_diagram"]

_EMPTY_TEXT = """name = "functional"
sample_time = 0.01

[blocks.setpoint]
kind = "Inport"
unit = "%"

[blocks.duty]
kind = "Outport"
unit = "%"
inputs = ["setpoint"]
"""


def empty_diagram() -> Diagram:
    """A diagram to begin with: one port in, one port out."""
    return read_diagram(_EMPTY_TEXT)


def create_from_diagram(
    directory: Path,
    diagram: Diagram,
    inputs: Mapping[str, str | float],
    outputs: Mapping[str, str],
) -> Workspace:
    """Make a project folder whose controller is `diagram`, with its ports' devices.

    The devices are those of `ravenbrick.codegen.control_task`. Raises `UsageError` or
    `DesignError` and then has written nothing.
    """
    text = diagram_text(diagram)
    diagram = read_diagram(text)
    diagram.name = "functional"  # as in the project's design.py
    code = generate_c(diagram)
    control_task(code.files["functional.h"], diagram.sample_time, inputs, outputs)
    read = {name: inputs.get(name, 0.0) for name in _names(diagram, Inport)}
    driven = {name: outputs.get(name, "seen") for name in _names(diagram, Outport)}
    period_us = round(diagram.sample_time * 1e6)
    marks = {
        "INPUTS": _table(read),
        "OUTPUTS": _table(driven),
        "PORTS": _ports([*read.values(), *driven.values()]),
        "ROWS": "\n".join(_rows("in", read) + _rows("out", driven)),
        "PERIOD_US": str(period_us),
        "PRIORITY": str(TASK_PRIORITY),
        "STACK_BYTES": str(TASK_STACK_BYTES),
    }
    workspace = create_from(directory, FROM_DIAGRAM, "diagram", marks)
    folder = workspace.project / "diagrams"
    folder.mkdir()
    (folder / "controller.toml").write_text(text, encoding="utf-8")
    return workspace


def _names(diagram: Diagram, kind: type[Inport] | type[Outport]) -> list[str]:
    return [block.name for block in diagram.blocks if isinstance(block, kind)]


def _table(values: Mapping[str, str | float]) -> str:
    """A Python dictionary, one port per line."""
    lines = [f"    {json.dumps(name)}: {json.dumps(value)}," for name, value in values.items()]
    return "\n".join(["{", *lines, "}"])


def _ports(devices: Sequence[str | float]) -> str:
    """The tables of robot.toml for devices such as "motor.B.angle"."""
    named = {tuple(one.split(".")[:2]) for one in devices if isinstance(one, str) and "." in one}
    text = ""
    for device, port in sorted(named):
        motor = '\nmotor = "nxt"' if device == "motor" else ""
        text += f'[ports.{port}]\ndevice = "{device}"{motor}\nrole = "of the diagram"\n\n'
    return text


def _rows(direction: str, devices: Mapping[str, str | float]) -> list[str]:
    return [f"| `{name}` | {direction} | `{device}` |" for name, device in devices.items()]
