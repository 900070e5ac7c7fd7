# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from ravenbrick.errors import ProjectFileError, ScenarioError
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path

Edit = Callable[[str, str, str], int]
DRIVE = "scenarios/drive.toml"


def _read(project: Path, robot: Robot, name: str = "drive") -> Scenario:
    return read_scenario(scenario_path(project, name), robot)


@pytest.mark.parametrize("name", ["drive", "drive-open-loop", "step", "step-with-friction"])
def test_the_vehicles_scenarios_are_valid(project: Path, robot: Robot, name: str) -> None:
    """The files in the repository can be read."""
    assert _read(project, robot, name).name == name


PORTS = [
    ('input = "touch.1"', 'input = "touch.3"', "no touch sensor on sensor port 3"),
    ('input = "touch.1"', 'input = "touch.9"', "no touch sensor on sensor port 9"),
    ("motor.A.hand_angle", "motor.D.hand_angle", "nothing is plugged into motor port D"),
    ("motor.A.hand_angle", "motor.B.hand_angle", "is not held by a hand"),
    ('"button.orange"', '"button.red"', "unknown button 'red'"),
    ('"button.orange"', '"lever.1"', "unknown input 'lever.1'"),
]


@pytest.mark.parametrize(("old", "new", "problem"), PORTS)
def test_an_input_of_an_unknown_port_is_named_with_its_line(
    project: Path, robot: Robot, edit: Edit, old: str, new: str, problem: str
) -> None:
    """The error gives the input's line and what the robot has instead."""
    line = edit(DRIVE, old, new)
    with pytest.raises(ProjectFileError, match=problem) as caught:
        _read(project, robot)
    assert caught.value.line == line


def test_a_scenario_that_is_not_there_lists_the_known_ones(project: Path, robot: Robot) -> None:
    """A mistyped name is answered with the names that exist."""
    with pytest.raises(
        ScenarioError, match="known scenarios: drive, drive-open-loop, step, step-with-friction"
    ):
        _read(project, robot, "dirve")


def test_a_scenario_is_found_from_here_and_from_its_project(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a path beside robot.toml, wherever the command is given."""
    other = project / "experiments" / "other.toml"
    other.parent.mkdir(exist_ok=True)
    other.write_text("")
    assert scenario_path(project, "experiments/other.toml") == other
    monkeypatch.chdir(project)
    assert scenario_path(project, "experiments/other.toml") == Path("experiments/other.toml")
    assert scenario_path(project, "step") == project / "scenarios" / "step.toml"


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ("at_ms = 19_000", "at_ms = 21_000", r"inputs\[8\]\.at_ms"),
        ("pictures_ms = [5_000]", "pictures_ms = [25_000]", r"pictures_ms\[0\]"),
        ("from_ms = 1_000", "from_ms = 20_001", r"straight\.from_ms"),
    ],
)
def test_an_instant_beyond_the_duration_is_unreachable(
    project: Path, robot: Robot, edit: Edit, old: str, new: str, field: str
) -> None:
    """What would happen after the end is refused before the run."""
    line = edit(DRIVE, old, new)
    with pytest.raises(ScenarioError, match=rf"drive\.toml:{line}: {field}: .* beyond"):
        _read(project, robot)


def test_a_criterion_without_its_table_can_never_be_measured(
    project: Path, robot: Robot, edit: Edit
) -> None:
    """A criterion about a step needs the step's window."""
    line = edit(DRIVE, 'measure = "distance"', 'measure = "settling_time"')
    with pytest.raises(ScenarioError, match=rf":{line}: .*without a table \[step\]; add it"):
        _read(project, robot)


def test_a_deviation_outside_the_tolerance_is_refused(
    project: Path, robot: Robot, edit: Edit
) -> None:
    """A part may differ only as far as robot.toml says."""
    line = edit(DRIVE, "factor = 0.92", "factor = 0.8")
    with pytest.raises(ProjectFileError, match="outside the tolerance") as caught:
        _read(project, robot)
    assert caught.value.line == line


def test_inputs_are_played_in_the_order_of_time(project: Path, robot: Robot, edit: Edit) -> None:
    """The order in the file does not matter."""
    edit(DRIVE, "at_ms = 1_000", "at_ms = 18_000")
    instants = [event.at_ms for event in _read(project, robot).inputs]
    assert instants == sorted(instants)


def test_a_criterion_without_a_bound_is_refused(project: Path, robot: Robot, edit: Edit) -> None:
    """A criterion that always holds is a mistake."""
    edit(DRIVE, "minimum = 3.0\n", "")
    with pytest.raises(ProjectFileError, match="has no bound; give 'minimum', 'maximum' or both"):
        _read(project, robot)


def test_a_peer_that_is_no_project_is_named_with_its_line(
    project: Path, robot: Robot, edit: Edit
) -> None:
    """Relative to the scenario; the folder that was looked for is told."""
    peer = '[peer]\nproject = "../joystick"\nscenario = "x"\n\n'
    line = edit(DRIVE, "[straight]", f"{peer}[straight]")
    with pytest.raises(ProjectFileError, match=r"joystick' has no robot.toml") as caught:
        _read(project, robot)
    assert caught.value.line == line + 1


def test_a_monitor_that_hangs_up_before_it_connects_is_named_with_its_line(
    project: Path, robot: Robot, edit: Edit
) -> None:
    """And one beside a peer is one too many."""
    monitor = '[monitor]\npin = "1234"\nfrom_ms = 900\nuntil_ms = 800\n\n'
    line = edit(DRIVE, "[straight]", f"{monitor}[straight]")
    with pytest.raises(ProjectFileError, match="expected more than from_ms = 900") as caught:
        _read(project, robot)
    assert caught.value.line == line + 3
    edit(DRIVE, "until_ms = 800", "until_ms = 900_000")
    with pytest.raises(ScenarioError, match="until_ms: 900000 ms is beyond the duration"):
        _read(project, robot)
    edit(DRIVE, "[monitor]", '[peer]\nproject = ".."\nscenario = "x"\n\n[monitor]')
    with pytest.raises(ProjectFileError, match="a peer or a monitor; leave one out"):
        _read(project, robot)


def test_each_missing_field_is_told_once(project: Path, robot: Robot) -> None:
    """An empty file misses several."""
    path = project / "scenarios" / "empty.toml"
    path.write_text("")
    with pytest.raises(ProjectFileError) as caught:
        read_scenario(path, robot)
    told = [caught.value.sentence, *caught.value.detail.splitlines()]
    assert len(told) == len(set(told)) > 2


def test_a_pin_that_is_too_long_says_how_long_it_may_be(
    project: Path, robot: Robot, edit: Edit
) -> None:
    edit(DRIVE, "[straight]", '[monitor]\npin = "12345678901234567"\n\n[straight]')
    with pytest.raises(ProjectFileError, match="'12345678901234567'; expected at most 16 letters"):
        _read(project, robot)
