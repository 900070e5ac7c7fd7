# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Many robots within the tolerances of one."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from host.tests.grading.submissions import BLANK
from typer.testing import CliRunner

from ravenbrick.cli import app
from ravenbrick.grading.sweep import draw
from ravenbrick.target.robot import Robot, read_robot
from ravenbrick.target.scenario import Scenario, read_scenario, scenario_path


def drawn_from() -> tuple[Robot, Scenario]:
    """The bench with one motor."""
    robot = read_robot(BLANK)
    return robot, read_scenario(scenario_path(BLANK, "press"), robot)


def test_parameters_lie_within_their_tolerances_and_come_again() -> None:
    """Each number is another robot, the same one each time; no friction below 0."""
    robot, scenario = drawn_from()
    seen = [draw(robot, scenario, number) for number in range(50)]
    assert seen == [draw(robot, scenario, number) for number in range(50)]
    assert len({json.dumps(one) for one in seen}) == 50
    for one in seen:
        values = one["B"]
        assert values["static_friction"] >= values["coulomb_friction"] >= 0
        for name, value in values.items():
            assert robot.motors["nxt"][name].allows(value), name


@pytest.mark.skipif("RAVENBRICK_LONG" not in os.environ, reason="many runs: make conformance")
def test_the_number_of_workers_does_not_matter(tmp_path: Path) -> None:
    """One or two workers, or a sweep that goes on where it was: the same results."""
    runner = CliRunner()
    assert runner.invoke(app, ["build", str(BLANK)]).exit_code == 0

    def sweep(count: int, workers: int, folder: str) -> list[object]:
        command = ["sweep", str(BLANK), "press", "--count", str(count), "--json"]
        command += ["--workers", str(workers), "--output", str(tmp_path / folder)]
        answer = json.loads(runner.invoke(app, command).output)
        assert answer["count"] == count
        return list(answer["results"])

    single = sweep(6, 1, "one")
    assert sweep(6, 2, "two") == single
    assert sweep(3, 1, "resumed") == single[:3]
    before = {f.name: f.stat().st_mtime_ns for f in (tmp_path / "resumed").iterdir()}
    assert sweep(6, 2, "resumed") == single
    after = {f.name: f.stat().st_mtime_ns for f in (tmp_path / "resumed").iterdir()}
    assert len(before) == 3 and before.items() <= after.items() and len(after) == 6
