# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick design`: from the plant's parameters to generated C."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter, Step
from ravenbrick.cli.diagram import value_of_program
from ravenbrick.cli.pipeline import design_project
from ravenbrick.errors import DesignError, UsageError, shown_path
from ravenbrick.image.design_script import DESIGN_SCRIPT
from ravenbrick.live_page import page_figure, serve_figure
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.recording import Recording

__all__ = ["design_command"]

_MOTORS = "ABC"


@command("ravenbrick design examples/vehicle --plots")
def design_command(
    directory: Annotated[Path, typer.Argument(help="Project folder with design.py.")],
    plots: Annotated[
        bool,
        typer.Option(
            "--plots",
            help="Pictures: Bode, Nyquist, root locus, gain family, discretisations, tolerances.",
        ),
    ] = False,
    costs: Annotated[
        bool,
        typer.Option(
            "--costs", help="Execution time on the brick in single precision and in fixed point."
        ),
    ] = False,
    timing: Annotated[
        Path | None,
        typer.Option(
            help="Recording (.npz) whose jitter and delay are shown in the loop's response."
        ),
    ] = None,
    task: Annotated[str, typer.Option(help="Control task in the recording.")] = "control_task",
    motor: Annotated[str, typer.Option(help="Motor that the task drives: A, B or C.")] = "B",
    page: Annotated[
        int | None,
        typer.Option(
            min=1024,
            max=65535,
            help="TCP port on 127.0.0.1 for a page with a slider per gain; it writes no files.",
        ),
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    reporter = Reporter(json_output)
    if page is not None:
        if plots or costs or timing is not None:
            raise UsageError("--page draws by itself; leave out --plots, --costs and --timing")
        return _interactive(workspace, page, reporter)
    with reporter.step("design and generate C"):
        design = design_project(workspace)
    if design.figures:
        rows = [[name, f"{value:.6g}"] for name, value in design.figures.items()]
        reporter.table(("figure", "value"), rows)
    compared = _compared(workspace, reporter)
    generated = sorted(str(path) for path in (workspace.project / "generated").glob("*.[ch]"))
    reporter.print(f"design: {shown_path(workspace.design_file)}")
    answer: dict[str, Any] = {
        "design_file": str(workspace.design_file),
        "figures": dict(design.figures),
        "generated": generated,
        "fidelity": compared,
    }
    if costs:
        answer["costs"] = _count(workspace, reporter)
    if timing is not None:
        answer |= _with_schedule(workspace, reporter, timing, task, motor)
    return {**answer, **_draw(workspace, reporter)} if plots else answer


def _interactive(workspace: Workspace, port: int, reporter: Reporter) -> dict[str, Any]:
    """Serve the page until Ctrl-C; the gains and figures that it had at its end."""
    from ravenbrick.codegen import generate_c  # slow to load
    from ravenbrick.control import Design
    from ravenbrick.control.design.interactive import InteractiveDesign, TunableLoop

    script = workspace.project / DESIGN_SCRIPT
    wanted = "the page shows what 'design' returns: a Design of finish_design, or a TunableLoop"
    advice = f"{shown_path(script)} has no function 'design'; {wanted}"
    found = value_of_program(script, "design", advice)
    if isinstance(found, Design):
        loop = TunableLoop.of(found.loop, found.specification, found.controller)
    elif isinstance(found, TunableLoop):
        loop = found
    else:
        raise DesignError(f"{shown_path(script)}: 'design' returns no Design; {wanted}")
    figure = page_figure(f"Design of {workspace.project.name}", (12, 8))
    source = f"{loop.program.name}.c"
    shown = InteractiveDesign(
        figure, loop, lambda program: generate_c(program, tolerance=None).files[source]
    )
    with suppress(KeyboardInterrupt):
        serve_figure(figure, port, reporter.tell, lambda: False)
    gains = shown.loop.gains
    reporter.table(("gain", "value"), [[name, f"{value:.6g}"] for name, value in gains.items()])
    reporter.print(shown.lines())
    return {"gains": gains, "figures": shown.figures()}


def _compared(workspace: Workspace, reporter: Reporter) -> dict[str, Any]:
    """The controller with its numbers as held beside the design, as design.py wrote it."""
    content = json.loads(workspace.design_file.read_text(encoding="utf-8")).get("fidelity") or {}
    if loop := content.get("loop"):
        rows = [
            [name, f"{value:.7g}", f"{loop['held'][name]:.7g}"]
            for name, value in loop["designed"].items()
        ]
        reporter.table(("closed loop", "as designed", "numbers as held"), rows)
    if blocks := content.get("blocks"):
        parts = ("pole_shift", "response_error", "step_error")
        reporter.table(
            ("block", "poles moved", "frequency response", "step response", "run for"),
            [
                [str(row["block"]), *(f"{row[part]:.1e}" for part in parts), f"{row['run_s']:g} s"]
                for row in blocks
            ],
        )
    return dict(content)


def _with_schedule(
    workspace: Workspace, reporter: Reporter, path: Path, task: str, motor: str
) -> dict[str, Any]:
    """The designed loop with the instants of a recorded run."""
    from ravenbrick.control.design.design_plots import DesignedLoop  # slow to load
    from ravenbrick.control.design.schedule_effect import (
        schedule_effect,
        schedule_figure,
        timing_row,
    )
    from ravenbrick.trace.sample_timing import sample_timing

    path = workspace.named_recording(path)
    if not path.is_file():
        raise UsageError(f"{path}: there is no such recording; make one with `ravenbrick run`")
    if motor not in _MOTORS:
        raise UsageError(f"--motor {motor}: expected A, B or C")
    loop = DesignedLoop.read(_loop_of(workspace))
    with reporter.step("simulate with the recorded schedule"):
        measured = sample_timing(Recording.load(path), task, _MOTORS.index(motor))
        cases = schedule_effect(loop, measured)
    rows = [case.row() for case in cases]
    names = ("settling_time", "overshoot", "ripple", "control_peak_to_peak")
    reporter.table(
        ("schedule", "settling (s)", "overshoot", "ripple", "voltage p-p (V)"),
        [[str(row["schedule"]), *(f"{row[n]:.4f}" for n in names)] for row in rows],
    )
    figure = {"schedule": schedule_figure(cases, measured)}
    written = _written(figure, workspace.results / "design", reporter)
    return {"schedule": {**timing_row(measured), "cases": rows, "picture": written[0]}}


def _loop_of(workspace: Workspace) -> dict[str, Any]:
    """What design.py says of its loop."""
    content = json.loads(workspace.design_file.read_text(encoding="utf-8")).get("loop")
    if not isinstance(content, dict):
        raise DesignError(
            "design.py wrote no loop to draw; pass `open_loop` to write_loop_results, or use Design"
        )
    return content


def _count(workspace: Workspace, reporter: Reporter) -> list[dict[str, Any]]:
    """What a step costs in each number format, counted on the virtual brick."""
    from ravenbrick.cli.costs import project_costs  # slow to load

    with reporter.step("measure a step on the brick"):
        rows = project_costs(workspace.project)
    table = [
        [
            row["form"],
            str(row["least_cycles"]),
            str(row["most_cycles"]),
            f"{row['share']:.3%}",
            str(row["size_bytes"]),
            f"{row['error_bound']:.3g} {row['unit']}" if row["error_bound"] else "not stated",
        ]
        for row in rows
    ]
    head = ("step function", "minimum cycles", "maximum", "of the period", "bytes", "error bound")
    reporter.table(head, table)
    return rows


def _draw(workspace: Workspace, reporter: Reporter) -> dict[str, Any]:
    """The pictures that the design's loop allows, and the figures in them."""
    from ravenbrick.control.analysis.frequency_plots import (
        bode_figure,
        nyquist_figure,
        root_locus_figure,
    )
    from ravenbrick.control.design.design_plots import DesignedLoop, read_system  # slow to load

    content = _loop_of(workspace)
    folder = workspace.results / "design"
    if "plant" not in content:
        with reporter.step("frequency response, root locus"):
            open_loop = read_system(content["open_loop"])
            figures = {
                "bode": bode_figure(open_loop, "Open loop"),
                "nyquist": nyquist_figure(open_loop, "Open loop"),
                "root-locus": root_locus_figure(open_loop, "Closed loop"),
            }
        return {"plots": _written(figures, folder, reporter)}
    loop = DesignedLoop.read(content)
    with reporter.step("frequency response, root locus"):
        figures = {**loop.frequency_figures(), "discretisation": loop.discretisation_figure()}
    with reporter.step("other gains with this settling time") as step:
        members = loop.family(_counted(step))
        figures["family"] = loop.family_figure(members)
    with reporter.step("vary the motor within its tolerances") as step:
        robustness = loop.robustness(_counted(step))
        figures["robustness"] = loop.robustness_figure(robustness)
    rows = [member.row() for member in members]
    numbers = ("proportional_gain", "integral_gain", "settling_time", "overshoot")
    reporter.table(
        ("gains", "loop", "Kp (V/V)", "Ki (1/s)", "settling (s)", "overshoot"),
        [[str(row["design"]), str(row["where"]), *(f"{row[n]:.6g}" for n in numbers)]
         for row in rows],
        left=("loop",),
    )  # fmt: skip
    spread = robustness.rows()
    reporter.table(
        ("motor within 20 %", "minimum", "median", "maximum"),
        [[str(row["figure"]), *(f"{row[n]:.6g}" for n in ("least", "median", "largest"))]
         for row in spread],
    )  # fmt: skip
    plots = _written(figures, folder, reporter)
    return {"plots": plots, "family": rows, "robustness": spread}


def _counted(step: Step) -> Any:
    """Progress by numbers as a share."""
    return lambda done, total: step.progress(done / total)


def _written(figures: dict[str, Any], folder: Path, reporter: Reporter) -> list[str]:
    from ravenbrick.control.design.design_plots import write_figure  # slow to load

    paths = [folder / f"{name}.svg" for name in figures]
    for path, figure in zip(paths, figures.values(), strict=True):
        write_figure(figure, path)
    reporter.print(f"pictures: {shown_path(folder)}")
    return [str(path) for path in paths]
