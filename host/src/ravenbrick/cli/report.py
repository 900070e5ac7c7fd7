# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick report`: report, pictures and summary from the recordings that there are."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import (
    any_run,
    collect,
    left_bounds,
    peer_runs,
    project_scenarios,
    scenario_or_none,
)
from ravenbrick.errors import RavenbrickError, UsageError, shown_path
from ravenbrick.image.elf import DEBUGGING_BUILD, read_image
from ravenbrick.image.memory import MemoryReport, memory_report
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario
from ravenbrick.project.workspace import BuildKind, Workspace
from ravenbrick.report.run_report import write_report
from ravenbrick.trace.design import read_design
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.stacks import with_stacks
from ravenbrick.trace.summary import Run

__all__ = ["report_command"]

# Behind the name of a recording of another build than that for the RAM, and what it is.
BUILDS: dict[BuildKind, str] = {"flash": "flash image", "debug": DEBUGGING_BUILD}


def _run_of(file: Path, workspace: Workspace, robot: Robot, scenarios: list[Scenario]) -> Run:
    """The run of a recording; one without a scenario below scenarios/ is shown all the same."""
    recording = Recording.load(file)
    kind: BuildKind = next((b for b in BUILDS if file.stem.endswith(f".{b}")), "ram")
    name = file.stem.removesuffix(f".{kind}")
    known = (s for s in scenarios if s.name == name)
    scenario = next(known, None) or _elsewhere(robot, name)
    image = workspace.image(kind, robot.name)
    newer = image.is_file() and image.stat().st_mtime > file.stat().st_mtime
    title = f"{name} ({BUILDS[kind]})" if kind in BUILDS else name
    run = any_run(robot, scenario, recording)
    return replace(run, image_is_newer=newer, title=title)


def _elsewhere(robot: Robot, name: str) -> Scenario:
    """The scenario of another folder of the project, else one in which nothing is asked for."""
    for file in sorted(robot.directory.glob(f"*/{name}.toml")):
        with suppress(RavenbrickError):
            return read_scenario(file, robot)
    free = scenario_or_none(robot.directory, None, robot)
    return replace(free, name=name, description="Recording whose scenario is not in the project")


def _runs(workspace: Workspace, robot: Robot) -> list[Run]:
    scenarios = project_scenarios(robot)
    order = [scenario.name for scenario in scenarios]
    files = sorted(
        workspace.recording("any").parent.glob("*.npz"),
        key=lambda f: (order.index(f.stem) if f.stem in order else len(order), f.stem),
    )
    runs = [_run_of(file, workspace, robot, scenarios) for file in files]
    if not runs:
        raise UsageError(
            f"no scenario of '{workspace.project.name}' has been run yet; "
            "run one with 'ravenbrick run', or all with 'ravenbrick demo'"
        )
    return [*runs, *peer_runs(runs)]


def _memory(workspace: Workspace, robot: Robot, runs: list[Run]) -> MemoryReport | None:
    image = workspace.image("ram", robot.name)
    if not image.is_file():
        return None
    memory = memory_report(read_image(image), robot)
    for run in runs:
        if run.robot.name == robot.name:
            memory = with_stacks(memory, run.recording.threads)
    return memory


@command("ravenbrick report examples/vehicle")
def report_command(
    directory: ProjectArgument,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    robot = read_robot(directory)
    reporter = Reporter(json_output)
    with reporter.step("measure and write the report") as step:
        runs = _runs(workspace, robot)
        design = read_design(workspace.design_file) if workspace.design_file.is_file() else None
        memory = _memory(workspace, robot, runs)
        evidence = collect(robot, design, memory, runs, None, left_bounds(workspace, robot))
        report, figures = write_report(evidence, workspace.results)
        step.note = shown_path(report)
    return {"report": str(report), "summary": figures}
