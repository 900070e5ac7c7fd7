# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick simulate`: a Simulink model over time, with its continuous plant."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.import_model import (
    LibraryOption,
    VariablesOption,
    WorkspaceOption,
    assigned,
    model_variables,
)
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.simulink.importer import ModelSource
from ravenbrick.simulink.numbers import Workspace

if TYPE_CHECKING:
    from ravenbrick.simulink.simulate import Signal, Simulation

__all__ = ["simulate_command"]

_SUFFIXES = (".svg", ".png", ".pdf")


@command("ravenbrick simulate examples/paper/models/figure4.slx --out loop.svg")
def simulate_command(
    model: Annotated[Path, typer.Argument(help="Simulink model (.slx or .mdl).")],
    stop: Annotated[
        float | None, typer.Option(help="End of the simulation in seconds (default: the model's).")
    ] = None,
    sample_time: Annotated[
        float, typer.Option(help="Sample time in seconds of discrete blocks that state none.")
    ] = 0.0,
    inputs: Annotated[
        list[str] | None,
        typer.Option("--input", help="Constant at an inport, as NAME=NUMBER; may be repeated."),
    ] = None,
    variables: VariablesOption = None,
    workspace: WorkspaceOption = None,
    library: LibraryOption = None,
    subsystem: Annotated[str, typer.Option(help="Path of the only subsystem to simulate.")] = "",
    out: Annotated[
        Path | None, typer.Option(help="Picture of the signals: .svg, .png or .pdf.")
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    from ravenbrick.simulink.simulate import simulate  # slow to load

    _check(model, stop, sample_time, out)
    reporter = Reporter(json_output)
    given = Workspace(model_variables(variables or [], workspace or []))
    source = ModelSource(model, sample_time, given, tuple(library or []), subsystem)
    with reporter.step("simulate") as step:
        found = simulate(source, stop, assigned("--input", inputs or []))
        rate = f", samples every {found.sample_time:g} s" if found.sample_time else ""
        count = found.algebraic_loops
        loops = f", {count} algebraic loop{'s' * (count > 1)} solved" if count else ""
        step.note = f"{found.stop:g} s, {found.continuous_states} continuous states{rate}{loops}"
    reporter.table(
        ("signal", "initial", "final", "peak", "overshoot", "rise (s)", "settling (s)"),
        [_row(signal) for signal in found.signals],
    )
    answer: dict[str, Any] = {
        "model": str(model),
        "stop": found.stop,
        "sample_time": found.sample_time,
        "continuous_states": found.continuous_states,
        "algebraic_loops": found.algebraic_loops,
        "time": found.times.tolist(),
        "signals": [
            {
                "name": signal.name,
                "path": signal.path,
                "step": None if signal.figures is None else asdict(signal.figures),
                "values": signal.values.tolist(),
            }
            for signal in found.signals
        ],
    }
    if out is not None:
        _write(found, model.name, out)
        reporter.print(f"picture: {shown_path(out)}")
        answer["picture"] = str(out)
    return answer


def _check(model: Path, stop: float | None, sample_time: float, out: Path | None) -> None:
    if not model.is_file():
        raise UsageError(f"{model}: there is no such file")
    if stop is not None and not stop > 0:
        raise UsageError(f"--stop must be > 0 s, not {stop}")
    if sample_time < 0:
        raise UsageError(f"--sample-time must be > 0 s, not {sample_time}")
    if out is not None and out.suffix not in _SUFFIXES:
        raise UsageError(f"--out {out}: expected a file that ends with {', '.join(_SUFFIXES)}")


def _row(signal: Signal) -> list[str]:
    figures = signal.figures
    if figures is None:
        return [signal.name, f"{signal.values[0]:.5g}", f"{signal.values[-1]:.5g}", *[""] * 4]
    times = [
        "not reached" if value is None else f"{value:.4f}"
        for value in (figures.rise_time, figures.settling_time)
    ]
    numbers = (figures.initial, figures.final, figures.peak)
    return [signal.name, *(f"{n:.5g}" for n in numbers), f"{figures.overshoot:.2%}", *times]


def _write(found: Simulation, title: str, path: Path) -> None:
    """All signals over the time, on one axis for each scope and one for the outports."""
    from ravenbrick.control.design.design_plots import write_figure  # slow to load
    from ravenbrick.report.plots.style import legend, new_figure, task_colour

    groups: dict[str, list[Signal]] = {}
    for signal in found.signals:
        groups.setdefault(signal.path, []).append(signal)
    figure, axes = new_figure(8.0, 0.8 + 2.6 * len(groups), len(groups))
    for axis, (place, signals) in zip(axes, groups.items(), strict=True):
        for index, signal in enumerate(signals):
            axis.plot(found.times, signal.values, color=task_colour(index), linewidth=1.3,
                      label=signal.name)  # fmt: skip
        axis.set_ylabel(place)
        legend(axis, "best")
    axes[0].set_title(title, fontsize=10, loc="left")
    axes[-1].set_xlabel("time (s)")
    write_figure(figure, path)
