# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Stages shared by the commands."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from ravenbrick.brick.protocol import Progress, no_progress
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import DesignError, ProjectFileError, RavenbrickError, shown_path
from ravenbrick.image.build import BUSY, build_image, current_image, manifest_file
from ravenbrick.image.design_script import DESIGN_SCRIPT, run_design
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.image.locks import locked
from ravenbrick.image.manifest import BuildManifest
from ravenbrick.image.memory import MemoryReport
from ravenbrick.project.robot import ROBOT_FILE, Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.workspace import BuildKind, Workspace
from ravenbrick.timing.facts.facts import read_facts
from ravenbrick.timing.results.bounds_file import own_bounds
from ravenbrick.trace.design import Design, read_design
from ravenbrick.trace.measures import check_survival, evaluate_criteria, measure_run
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.summary import ROLES, Evidence, Run
from ravenbrick.trace.task_set import check_task_set

if TYPE_CHECKING:
    from ravenbrick.brick.run import PeerRun, VirtualTarget

__all__ = [
    "any_run",
    "built_file",
    "collect",
    "design_project",
    "keep_peer",
    "left_bounds",
    "peer_runs",
    "project_image",
    "project_scenarios",
    "read_run",
    "run_scenario",
    "scenario_or_none",
    "task_rows",
]

# Surroundings without inputs: the user sets them.
NO_SCENARIO = 'schema_version = 1\nname = "free"\nseed = 1\nduration_ms = 1\n'


def design_project(workspace: Workspace) -> Design:
    """Run design.py of the project; raises `DesignError`, which names its line."""
    with locked(workspace.products, BUSY):
        run_design(workspace)
    if not workspace.design_file.is_file():
        script = shown_path(workspace.project / DESIGN_SCRIPT)
        raise DesignError(
            f"{script}: wrote no figures; write those of the design to the file of --results, as "
            "the design.py of a new project does"
        )
    return read_design(workspace.design_file)


def project_image(
    workspace: Workspace, robot: Robot, kind: BuildKind, reporter: Reporter
) -> ElfImage:
    """The project's image, built before where it is not that of its sources as they are now.

    Raises as `build_image`.
    """
    image = current_image(workspace, robot, kind)
    if image is not None:
        return image
    with reporter.step(f"build the {kind} image") as step:
        built = build_image(workspace, robot, kind)
        step.note = shown_path(built.image.path)
    return built.image


def built_file(elf: Path, reporter: Reporter) -> Path:
    """An ELF file; one that a project's build left is built before where it is not current."""
    manifest = BuildManifest.read(manifest_file(elf))
    project = Path(manifest.settings.get("project folder", "")) if manifest is not None else Path()
    if manifest is not None and (project / ROBOT_FILE).is_file():
        workspace, robot = Workspace.of(project), read_robot(project)
        for kind in get_args(BuildKind):
            if workspace.image(kind, robot.name) == elf.resolve():
                project_image(workspace, robot, kind, reporter)
    return elf


def run_scenario(
    workspace: Workspace,
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    target: VirtualTarget,
    progress: Progress = no_progress,
) -> Recording:
    """Run a scenario and keep the recording, and its peer's."""
    recording, peer = target.run_with_peer(robot, scenario, image, progress)
    recording.save(workspace.recording(scenario.name, image.build))
    keep_peer(peer)
    return recording


def keep_peer(peer: PeerRun | None) -> Recording | None:
    """Keep the recording of the brick that ran beside, in its own project's results."""
    if peer is None or peer.recording is None:
        return None
    workspace = Workspace.of(peer.robot.directory)
    peer.recording.save(workspace.recording(peer.scenario.name, peer.image.build))
    return peer.recording


def _with_other_code(robot: Robot) -> set[str]:
    """Tasks that execute other code than jobs; a wrong `timing.toml` is for `analyse` to tell."""
    with suppress(ProjectFileError):
        return {load.task for load in read_facts(robot).outside_loads}
    return set()


def read_run(robot: Robot, scenario: Scenario, recording: Recording, *, whole: bool = True) -> Run:
    """Measure a recording, not `whole` if it ends before its scenario does.

    Raises `RunFaultError`, `ScenarioError`, `ProjectFileError`.
    """
    check_survival(scenario, recording)
    check_task_set(robot, recording, whole=whole, outside=_with_other_code(robot))
    measures = measure_run(robot, scenario, recording)
    criteria = evaluate_criteria(scenario, measures)
    return Run(robot, scenario, recording, measures, criteria)


def any_run(robot: Robot, scenario: Scenario, recording: Recording) -> Run:
    """As `read_run`, also of a run that failed: what is wrong with it is its `problem`."""
    try:
        return read_run(robot, scenario, recording)
    except RavenbrickError as error:
        bare = replace(scenario, step=None, straight=None)
        return Run(robot, scenario, recording, measure_run(robot, bare, recording), (), error)


def peer_runs(runs: Sequence[Run]) -> list[Run]:
    """The runs of the other bricks that ran beside these."""
    found = []
    for peer in (run.scenario.peer for run in runs):
        if peer is None:
            continue
        robot = read_robot(peer.project)
        scenario = read_scenario(scenario_path(peer.project, peer.scenario), robot)
        file = Workspace.of(peer.project).recording(scenario.name)
        if file.is_file():
            title = f"{scenario.name} of {robot.name}"
            found.append(replace(any_run(robot, scenario, Recording.load(file)), title=title))
    return found


def project_scenarios(robot: Robot) -> list[Scenario]:
    """All scenarios of a project, in the order of their files' names."""
    files = sorted((robot.directory / "scenarios").glob("*.toml"))
    return [read_scenario(file, robot) for file in files]


def collect(
    robot: Robot,
    design: Design | None,
    memory: MemoryReport | None,
    runs: Sequence[Run],
    same_digest_twice: bool | None,
    bounds: Mapping[str, int] | None = None,
) -> Evidence:
    """The runs in the order of the report: by their scenarios' roles, then as given."""
    places = {role: place for place, role in enumerate(ROLES)}
    ordered = sorted(runs, key=lambda run: places.get(run.scenario.role or "", len(places)))
    return Evidence(robot, design, memory, tuple(ordered), same_digest_twice, bounds or {})


def left_bounds(workspace: Workspace, robot: Robot) -> dict[str, int]:
    """Bounds of response times that `ravenbrick analyse` left for the image that there is."""
    image, bounds = workspace.image("ram", robot.name), workspace.results / "timing.json"
    if not (image.is_file() and bounds.is_file()):
        return {}
    return own_bounds(bounds, read_image(image))


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


def scenario_or_none(directory: Path, name: str | None, robot: Robot) -> Scenario:
    """The scenario of this name; without a name, one in which nothing happens."""
    if name is not None:
        return read_scenario(scenario_path(directory, name), robot)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "free.toml"
        file.write_text(NO_SCENARIO)
        return read_scenario(file, robot)
