# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What `ravenbrick analyse` says when robot.toml and the image disagree or a deadline is short."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner
from verification.support.needed_tools import NEEDS_VIRTUAL_BRICK
from verification.support.projects import VEHICLE, put_image

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode, ProjectFileError
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.task_set import check_task_set

BUILT = Workspace.of(VEHICLE).image("ram", "vehicle")
pytestmark = [
    NEEDS_VIRTUAL_BRICK,
    pytest.mark.skipif(
        not BUILT.is_file(),
        reason="the vehicle is not built; 'ravenbrick build examples/vehicle' builds it",
    ),
]
Change = Callable[[str, str, str], Path]


@pytest.fixture
def changed(tmp_path: Path) -> Change:
    """The vehicle in a folder of its own, a value of one of its tasks replaced; its image stays."""

    def change(task: str, old: str, new: str) -> Path:
        project = tmp_path / "vehicle"
        project.mkdir()
        for name in ("robot.toml", "timing.toml"):
            shutil.copy(VEHICLE / name, project)
        (project / "scenarios").mkdir()
        text = (VEHICLE / "scenarios" / "step.toml").read_text()
        (project / "scenarios" / "step.toml").write_text(text)
        robot = project / "robot.toml"
        head, mark, tail = robot.read_text().partition(f'name = "{task}"')
        assert old in tail
        robot.write_text(head + mark + tail.replace(old, new, 1))
        put_image(project, BUILT.read_bytes())
        return project

    return change


@pytest.fixture(scope="module")
def recording() -> Recording:
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, "step"), robot)
    return VirtualTarget().run(robot, scenario, read_image(BUILT))


@pytest.mark.parametrize(
    ("field", "old", "new", "said"),
    [
        ("priority", "priority = 1", "priority = 0", "is 0, but the image that ran has 1"),
        ("stack_bytes", "= 4096", "= 2048", "is 2048, but the image that ran has 4096"),
        ("period_us", "= 500_000", "= 400_000", "is 400000, but the image that ran has 500000"),
    ],
)
def test_a_task_that_differs_from_the_image_is_named_with_its_line(
    changed: Change, recording: Recording, field: str, old: str, new: str, said: str
) -> None:
    project = changed("display_task", old, new)
    with pytest.raises(ProjectFileError) as refused:
        check_task_set(read_robot(project), recording)
    lines = (project / "robot.toml").read_text().splitlines()
    assert new in lines[refused.value.line - 1]
    assert f"tasks[2].{field}: {said}" in str(refused.value)
    assert str(refused.value).endswith("; correct robot.toml or the program")


def test_a_task_above_a_ceiling_is_named_with_the_object(changed: Change) -> None:
    project = changed("control_task", "priority = 2", "priority = 5")
    done = CliRunner().invoke(app, ["analyse", str(project), "--json"])
    assert done.exit_code == 3, done.output
    error = json.loads(done.output)["error"]
    assert (
        "tasks[1].priority: the priority of control_task is 5, but it may call the protected"
        in error
    )
    assert "panel__latest" in error and "whose ceiling is 2; raise the ceiling or lower" in error


def test_a_deadline_that_can_be_missed_is_told_with_what_to_change(changed: Change) -> None:
    project = changed("control_task", "deadline_us = 4_000", "deadline_us = 600")
    profile = ["--timing-profile", "pessimistic"]
    done = CliRunner().invoke(app, ["analyse", str(project), *profile, "--json"])
    assert done.exit_code == ExitCode.DEADLINE_CAN_BE_MISSED, done.output
    answer = json.loads(done.output)
    assert not answer["ok"] and answer["error"].startswith("NOT schedulable: control_task can miss")
    assert not answer["schedulable"] and answer["timing"] == "pessimistic"
    assert [miss["name"] for miss in answer["misses"]] == ["control_task"]
    assert "control_task can miss its deadline of 600 us" in answer["advice"][0]
    own, limit = (
        answer["tasks"][1][key] for key in ("execution_bound_cycles", "execution_max_cycles")
    )
    cures = [line for line in answer["advice"][1:] if "a job of control_task" in line]
    assert len(cures) == 1
    assert f"takes {own - limit} cycles less: at most {limit} cycles" in cures[0]
    page = Path(answer["report"]).read_text()
    assert "pessimistic timing" in page
    for name in ("Bounds by term", "Worst windows of control_task"):
        assert f'alt="{name}"' in page


def test_no_margin_is_below_zero_where_the_closer_bounds_meet_all_deadlines(
    changed: Change,
) -> None:
    project = changed("control_task", "deadline_us = 4_000", "deadline_us = 800")
    profile = ["--timing-profile", "pessimistic"]
    done = CliRunner().invoke(app, ["analyse", str(project), *profile, "--json"])
    assert done.exit_code == 0, done.output
    answer = json.loads(done.output)
    assert answer["schedulable"] and answer["largest_scaling"] >= 1.0
    for task in answer["tasks"]:
        assert task["execution_max_cycles"] >= task["execution_bound_cycles"]
    assert not any("take -" in line for line in answer["advice"])
