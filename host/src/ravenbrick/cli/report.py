# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick report`: report, pictures and summary from the recordings that there are."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import collect, project_scenarios, read_run
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.target.elf_image import read_image
from ravenbrick.target.memory import MemoryReport, memory_report, with_stacks
from ravenbrick.target.robot import Robot, read_robot
from ravenbrick.target.workspace import Workspace
from ravenbrick.trace.design import read_design
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.report import write_report
from ravenbrick.trace.summary import Run, summary

__all__ = ["report_command"]


def _runs(workspace: Workspace, robot: Robot) -> list[Run]:
    runs = []
    for scenario in project_scenarios(workspace, robot):
        file = workspace.recording(scenario.name)
        if file.is_file():
            runs.append(read_run(robot, scenario, Recording.load(file)))
    if not runs:
        raise UsageError(
            f"no scenario of '{workspace.project.name}' has been run yet; "
            "run one with 'ravenbrick run', or all with 'ravenbrick demo'"
        )
    return runs


def _memory(workspace: Workspace, robot: Robot, runs: list[Run]) -> MemoryReport | None:
    image = workspace.image("ram", robot.name)
    if not image.is_file():
        return None
    memory = memory_report(read_image(image), robot)
    for run in runs:
        memory = with_stacks(memory, run.recording.threads)
    return memory


@command("ravenbrick report examples/vehicle")
def report_command(
    directory: Annotated[Path, typer.Argument(help="Project folder with robot.toml.")],
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    robot = read_robot(directory)
    reporter = Reporter(json_output)
    with reporter.step("measure and write the report") as step:
        runs = _runs(workspace, robot)
        design = read_design(workspace.design_file) if workspace.design_file.is_file() else None
        evidence = collect(robot, design, _memory(workspace, robot, runs), runs, None)
        report = write_report(evidence, workspace.results)
        step.note = shown_path(report)
    return {"report": str(report), "summary": summary(evidence)}
