# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick diagram`: the picture of a block diagram, its C and Ada beside it, or its text."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.codegen import diagram_page
from ravenbrick.errors import DesignError, UsageError, shown_path
from ravenbrick.model import Diagram, diagram_svg, diagram_text, load_diagram

__all__ = ["DRAWN", "diagram_command", "diagram_of", "value_of_program", "write_drawn"]

DRAWN: dict[str, Callable[[Diagram], str]] = {
    ".svg": diagram_svg, ".html": diagram_page, ".toml": diagram_text,
}  # fmt: skip


@command("ravenbrick diagram examples/vehicle/design.py:design --out controller.html")
def diagram_command(
    source: Annotated[
        str,
        typer.Argument(
            help="Diagram file (.toml), Simulink model (.slx, .mdl), or FILE.py:NAME, a diagram, a "
            "design or a function that returns one."
        ),
    ],
    out: Annotated[
        list[Path],
        typer.Option(
            help="Picture (.svg), page with the picture, the C and the Ada (.html), or text "
            "(.toml); may be repeated."
        ),
    ],
    sample_time: Annotated[
        float, typer.Option(help="Sample time in seconds of a Simulink model.")
    ] = 0.01,
    subsystem: Annotated[
        str, typer.Option(help="Path of the only subsystem to take from a Simulink model.")
    ] = "",
    json_output: JsonOption = False,
) -> dict[str, Any]:
    for path in out:
        if path.suffix not in DRAWN:
            raise UsageError(f"--out {path}: expected a file that ends with {', '.join(DRAWN)}")
    reporter = Reporter(json_output)
    with reporter.step("read the diagram") as step:
        diagram = diagram_of(source, sample_time, subsystem)
        step.note = f"{len(diagram.flat().blocks)} blocks"
    for path in out:
        write_drawn(diagram, path)
        reporter.print(f"written: {shown_path(path)}")
    return {
        "diagram": diagram.name,
        "blocks": len(diagram.flat().blocks),
        "files": [str(path) for path in out],
    }


def write_drawn(diagram: Diagram, path: Path) -> None:
    """The form of the diagram that the suffix says, as a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    atomic_write(path, DRAWN[path.suffix](diagram))


def diagram_of(source: str, sample_time: float = 0.01, subsystem: str = "") -> Diagram:
    """The diagram in a text file, a Simulink model, or a Python file (`FILE.py:NAME`)."""
    name, _, attribute = source.partition(":")
    path = Path(name)
    if not path.is_file():
        raise UsageError(f"{path}: there is no such file")
    if path.suffix == ".py":
        return _of_program(path, attribute)
    if path.suffix in (".slx", ".mdl"):
        from ravenbrick.simulink import import_simulink  # slow to load

        return import_simulink(path, sample_time, subsystem=subsystem)
    return load_diagram(path)


def value_of_program(path: Path, attribute: str, advice: str) -> Any:
    """What a name in a Python file stands for; a function is called. Else `UsageError`."""
    sys.path.insert(0, str(path.resolve().parent))
    found = runpy.run_path(str(path), run_name="diagram")
    if attribute not in found:
        raise UsageError(advice)
    value = found[attribute]
    return value() if callable(value) else value


def _of_program(path: Path, attribute: str) -> Diagram:
    """A diagram in a Python file, or that of a design."""
    advice = (
        f"{shown_path(path)} has no '{attribute}'; expected FILE.py:NAME, a diagram, a design, "
        "or a function without arguments that returns one"
    )
    value = value_of_program(path, attribute, advice)
    value = getattr(value, "controller", value)
    if not isinstance(value, Diagram):
        raise DesignError(f"{path}:{attribute} is no diagram, but {type(value).__name__}")
    return value
