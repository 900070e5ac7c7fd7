# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick demo`: the whole pipeline of a project, from constants to a report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ravenbrick.brick.protocol import Target
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import (
    TASK_HEAD,
    any_run,
    collect,
    design_project,
    left_bounds,
    peer_runs,
    project_scenarios,
    run_scenario,
    task_rows,
)
from ravenbrick.errors import CriteriaError, ScenarioError, shown_path
from ravenbrick.image.build import Built, build_image
from ravenbrick.image.controller_origin import read_origin
from ravenbrick.image.design_script import DESIGN_SCRIPT
from ravenbrick.image.memory import MemoryReport
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.project.workspace import Workspace
from ravenbrick.report.run_report import write_report
from ravenbrick.trace.design import Design
from ravenbrick.trace.measures import require_criteria
from ravenbrick.trace.stacks import with_stacks
from ravenbrick.trace.summary import Evidence, Run

__all__ = ["demo_command"]


def _design(workspace: Workspace, reporter: Reporter) -> Design:
    with reporter.step("design and generate C") as step:
        design = design_project(workspace)
        if "sampled" in design.responses:
            settled = design.responses["sampled"].settling_time or 0.0
            step.note = f"sampled simulation settles in {1000 * settled:.0f} ms"
    return design


def _run_all(
    workspace: Workspace,
    robot: Robot,
    scenarios: Sequence[Scenario],
    built: Built,
    target: VirtualTarget,
    reporter: Reporter,
) -> list[Run]:
    runs = []
    for scenario in scenarios:
        with reporter.step(f"run '{scenario.name}'") as step:
            recording = run_scenario(workspace, robot, scenario, built.image, target, step.progress)
            runs.append(any_run(robot, scenario, recording))
            seconds = recording.clock.seconds(recording.stop.at_cycles)
            step.note = f"{seconds:.3f} s on the brick, digest {recording.digest[:12]}"
    return runs


def _run_again(
    robot: Robot, runs: Sequence[Run], built: Built, target: Target, reporter: Reporter
) -> bool:
    first = next((run for run in runs if run.scenario.role == "drive"), runs[0])
    with reporter.step(f"run '{first.scenario.name}' again") as step:
        digest = target.run(robot, first.scenario, built.image, step.progress).digest
        same = digest == first.recording.digest
        step.note = "same trace digest" if same else f"DIFFERENT trace digest: {digest[:12]}"
    return same


def _stacks(built: Built, runs: Sequence[Run]) -> MemoryReport:
    memory = built.memory
    for run in runs:
        memory = with_stacks(memory, run.recording.threads)
    memory.write(built.memory_file)
    return memory


def _show(evidence: Evidence, figures: dict[str, Any], reporter: Reporter) -> None:
    def shown(key: str, scale: float, unit: str) -> list[str]:
        value = figures[key]
        return [key.replace("_", " "), "none" if value is None else f"{scale * value:.4g} {unit}"]

    reporter.print()
    reporter.table(
        ("figure", "value"),
        [
            shown("settling_time", 1000, "ms"),
            shown("overshoot", 100, "%"),
            shown("lateral_deviation_with", 1000, "mm"),
            shown("lateral_deviation_without", 1000, "mm"),
            shown("cpu_utilization", 100, "%"),
        ],
    )
    reporter.print()
    reporter.table(TASK_HEAD, task_rows(evidence.main))
    reporter.print()


@command("ravenbrick demo examples/vehicle")
def demo_command(
    directory: ProjectArgument,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    robot = read_robot(directory)
    scenarios = project_scenarios(robot)
    if not scenarios:
        raise ScenarioError(f"{directory}/scenarios: there is no scenario; write one")
    target = VirtualTarget()
    designed = (directory / DESIGN_SCRIPT).is_file()
    origin = read_origin(workspace.project / "generated")
    reporter = Reporter(json_output, total=len(scenarios) + 3 + (designed and origin is None))
    design = _design(workspace, reporter) if designed and origin is None else None
    if origin is not None:
        reporter.print(f"the controller is {origin.sentence}")
    with reporter.step("build the RAM image") as step:
        built = build_image(workspace, robot, "ram")
        step.note = f"{built.memory.used} of {built.memory.available} bytes"
    runs = _run_all(workspace, robot, scenarios, built, target, reporter)
    same = _run_again(robot, runs, built, target, reporter)
    with reporter.step("measure and write the report") as step:
        bounds = left_bounds(workspace, robot)
        evidence = collect(
            robot, design, _stacks(built, runs), [*runs, *peer_runs(runs)], same, bounds
        )
        report, figures = write_report(evidence, workspace.results)
    _show(evidence, figures, reporter)
    reporter.print(f"Open {shown_path(report)} in a browser.")
    for run in runs:
        if run.problem is not None:
            raise run.problem
        require_criteria(run.criteria)
    if not same:
        raise CriteriaError("the same run gave two trace digests; please report this as a defect")
    return {
        "report": str(report),
        "summary_file": str(workspace.results / "summary.json"),
        "summary": figures,
        "steps": reporter.durations(),
    }
