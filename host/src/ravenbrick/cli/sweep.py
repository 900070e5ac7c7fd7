# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick sweep`: a scenario with random motors within their tolerances."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, ProjectArgument, ScenarioArgument, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import project_image
from ravenbrick.errors import CriteriaError
from ravenbrick.grading.sweep import run_sweep
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace

__all__ = ["sweep_command"]


def _rows(results: list[dict[str, Any]]) -> list[list[str]]:
    """For each criterion: the number of robots that meet it, and the observed range."""
    rows: dict[str, list[dict[str, Any]]] = {}
    for result in results:
        for row in result["criteria"]:
            rows.setdefault(row.get("expectation") or row["measure"], []).append(row)
    table = []
    for label, seen in rows.items():
        numbers = [r["value"] for r in seen if isinstance(r["value"], int | float)]
        extent = f"{min(numbers):.4g} to {max(numbers):.4g}" if numbers else ""
        table.append([label, f"{sum(r['met'] for r in seen)} of {len(seen)}", extent])
    return table


@command("ravenbrick sweep examples/motor-bench step --count 50")
def sweep_command(
    directory: ProjectArgument,
    scenario: ScenarioArgument,
    count: Annotated[int, typer.Option(min=1, help="Number of random samples.")] = 20,
    output: Annotated[
        Path, typer.Option(help="Folder for results; the next sweep uses them again.")
    ] = Path("out/sweep"),
    workers: Annotated[
        int, typer.Option(min=1, help="Number of runs at the same time.")
    ] = os.cpu_count() or 1,
    dask: Annotated[str | None, typer.Option(help="Address of a Dask scheduler.")] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    robot = read_robot(directory)
    chosen = read_scenario(scenario_path(directory, scenario), robot)
    reporter = Reporter(json_output)
    image = project_image(Workspace.of(directory), robot, "ram", reporter)
    with reporter.step(f"run '{chosen.name}' of {count} robots") as step:
        results = run_sweep(robot, chosen, image.path, count, output, workers, dask, step.progress)
        met = sum(result["met"] for result in results)
        step.note = f"{met} of {count} meet all criteria"
    reporter.table(("criterion", "met", "observed"), _rows(results), left=("met", "observed"))
    if met < count:
        first = next(result for result in results if not result["met"])
        error = CriteriaError(
            f"{count - met} of {count} robots do not meet all criteria, the first is number "
            f"{first['number']}; its motors are in {output}"
        )
        error.data = {"met": met, "count": count, "results": results}
        raise error
    return {"met": met, "count": count, "results": results}
