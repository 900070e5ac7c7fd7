# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick run`: one scenario on the virtual brick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.build import ImageChoice
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import TASK_HEAD, play, read_run, task_rows
from ravenbrick.target.elf_image import read_image
from ravenbrick.target.robot import read_robot
from ravenbrick.target.scenario import read_scenario, scenario_path
from ravenbrick.target.virtual import VirtualTarget
from ravenbrick.target.workspace import Workspace
from ravenbrick.trace.measures import require_criteria
from ravenbrick.trace.summary import run_summary

__all__ = ["run_command"]


@command("ravenbrick run examples/vehicle drive")
def run_command(
    directory: Annotated[Path, typer.Argument(help="Project folder with robot.toml.")],
    scenario: Annotated[str, typer.Argument(help="Name below scenarios/, or a file.")],
    elf: Annotated[Path | None, typer.Option(help="Another image than the project's own.")] = None,
    image: Annotated[ImageChoice, typer.Option(help="Which image to run.")] = ImageChoice.RAM,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    """Run a scenario on the virtual brick, keep the recording, check the pass criteria."""
    workspace = Workspace.of(directory)
    robot = read_robot(directory)
    chosen = read_scenario(scenario_path(directory, scenario), robot)
    loaded = read_image(elf or workspace.image(image.kind, robot.name))
    reporter = Reporter(json_output)
    with reporter.step(f"run '{chosen.name}'") as step:
        recording = play(workspace, robot, chosen, loaded, VirtualTarget(), step.progress)
        run = read_run(robot, chosen, recording)
        step.note = f"{recording.clock.seconds(recording.stop.at_cycles):.3f} s on the brick"
    reporter.table(TASK_HEAD, task_rows(run))
    reporter.table(
        ("criterion", "value", ""),
        [
            [result.criterion.measure, f"{result.value:.4g}", "met" if result.met else "not met"]
            for result in run.criteria
        ],
    )
    kept = workspace.recording(chosen.name, loaded.kind)
    reporter.print(f"recording: {workspace.shown(kept)}")
    require_criteria(chosen, run.criteria)
    return {**run_summary(run), "recording": str(kept)}
