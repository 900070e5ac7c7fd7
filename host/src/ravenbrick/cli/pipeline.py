# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The stages that the commands are made of."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ravenbrick.errors import DesignError, shown_path
from ravenbrick.target.elf_image import ElfImage
from ravenbrick.target.memory import MemoryReport
from ravenbrick.target.protocol import Progress, Target, no_progress
from ravenbrick.target.robot import Robot
from ravenbrick.target.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.target.workspace import Workspace
from ravenbrick.trace.design import Design, read_design
from ravenbrick.trace.measures import check_survival, evaluate_criteria, measure_run
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.summary import Evidence, Run
from ravenbrick.trace.task_set import check_task_set

__all__ = [
    "collect",
    "design_project",
    "memory_rows",
    "play",
    "project_scenarios",
    "read_run",
    "scenario_or_none",
    "task_rows",
]

DESIGN_SCRIPT = "design.py"
# Surroundings without inputs: the user sets them.
NO_SCENARIO = 'schema_version = 1\nname = "free"\nseed = 1\nduration_ms = 1\n'


def design_project(workspace: Workspace) -> Design:
    """Run design.py of the project; raises `DesignError` with the end of its output."""
    script = workspace.project / DESIGN_SCRIPT
    if not script.is_file():
        raise DesignError(f"{shown_path(script)}: there is no design script; write one")
    workspace.design_file.parent.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, DESIGN_SCRIPT, "--results", str(workspace.design_file)]
    done = subprocess.run(
        command,
        cwd=workspace.project,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        lines = done.stdout.strip().split("\n")
        raise DesignError(
            f"{shown_path(script)} failed: {lines[-1]}; correct the design and run it again",
            detail="\n".join(lines[-15:-1]),
        )
    return read_design(workspace.design_file)


def play(
    workspace: Workspace,
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    target: Target,
    progress: Progress = no_progress,
) -> Recording:
    """Run a scenario and keep the recording."""
    recording = target.run(robot, scenario, image, progress)
    recording.save(workspace.recording(scenario.name, image.kind))
    return recording


def read_run(robot: Robot, scenario: Scenario, recording: Recording) -> Run:
    """Measure a recording; raises `RunFaultError`, `ScenarioError`, `ProjectFileError`."""
    check_survival(scenario, recording)
    check_task_set(robot, recording)
    measures = measure_run(robot, scenario, recording)
    return Run(scenario, recording, measures, evaluate_criteria(scenario, recording, measures))


def project_scenarios(workspace: Workspace, robot: Robot) -> list[Scenario]:
    """All scenarios of a project, in the order of their files' names."""
    files = sorted((workspace.project / "scenarios").glob("*.toml"))
    return [read_scenario(file, robot) for file in files]


def collect(
    robot: Robot,
    design: Design | None,
    memory: MemoryReport | None,
    runs: Sequence[Run],
    same_digest_twice: bool | None,
) -> Evidence:
    """Put each run into its place in the report, by its scenario's role."""
    roles = {run.scenario.role: run for run in reversed(runs)}
    return Evidence(
        robot=robot,
        design=design,
        memory=memory,
        drive=roles.get("drive"),
        open_loop=roles.get("open_loop"),
        step=roles.get("step"),
        others=tuple(run for run in runs if run.scenario.role is None),
        same_digest_twice=same_digest_twice,
    )


def memory_rows(memory: MemoryReport) -> list[list[str]]:
    """Sizes and stacks for the terminal."""
    share = 100 * memory.used / memory.available
    rows = [
        ["text", str(memory.text), ""],
        ["data", str(memory.data), ""],
        ["bss", str(memory.bss), ""],
        ["used", str(memory.used), f"{share:.1f} % of {memory.available}"],
    ]
    for task in memory.tasks:
        size = task.storage_size_bytes or task.declared_bytes
        used = "not run yet" if task.used_bytes is None else f"{task.used_bytes} used"
        rows.append([f"stack of {task.name}", str(size) if size else "unknown", used])
    return rows


def task_rows(run: Run) -> list[list[str]]:
    """Measures of each task for the terminal; times in cycles."""

    def shown(value: Any) -> str:
        return "none" if value is None else f"{value:.0f}"

    return [
        [
            task.name,
            str(task.releases),
            shown(task.response_time_cycles_min),
            shown(task.response_time_cycles_mean),
            shown(task.response_time_cycles_max),
            shown(task.release_jitter_cycles),
            str(task.deadline_misses) if task.deadline_cycles is not None else "none",
        ]
        for task in run.measures.tasks
    ]


TASK_HEAD = ("task", "releases", "response min", "mean", "max", "jitter (cycles)", "misses")
MEMORY_HEAD = ("memory", "bytes", "")


def scenario_or_none(directory: Path, name: str | None, robot: Robot) -> Scenario:
    """The scenario of this name; without a name, one in which nothing happens."""
    if name is not None:
        return read_scenario(scenario_path(directory, name), robot)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "free.toml"
        file.write_text(NO_SCENARIO)
        return read_scenario(file, robot)
