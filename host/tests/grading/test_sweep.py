# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Many robots within the tolerances of one."""

from __future__ import annotations

import importlib
import importlib.util
import json
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner
from verification.support.submissions import BLANK

from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode
from ravenbrick.grading.sweep import draw, run_sweep
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace

LONG = pytest.mark.long("workers")


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


@pytest.fixture(scope="module")
def built() -> None:
    """The bench's image."""
    assert CliRunner().invoke(app, ["build", str(BLANK)]).exit_code == 0


def sweep(count: int, folder: Path, *options: str) -> list[dict[str, Any]]:
    """Results of the command."""
    command = ["sweep", str(BLANK), "press", "--count", str(count), "--json"]
    command += ["--output", str(folder), *options]
    answer = json.loads(CliRunner().invoke(app, command).output)
    assert answer["count"] == count
    return list(answer["results"])


def test_an_interrupted_sweep_goes_on(built: None, tmp_path: Path) -> None:
    """What was kept is not run again, a damaged file is; the progress never goes back."""
    robot, scenario = drawn_from()
    image = Workspace.of(BLANK).image("ram", robot.name)
    first = run_sweep(robot, scenario, image, 3, tmp_path, 1)
    before = {file: file.stat().st_mtime_ns for file in tmp_path.iterdir()}
    damaged = min(before)
    damaged.write_text('{"number": ')
    shares: list[float] = []
    whole = run_sweep(robot, scenario, image, 5, tmp_path, 2, progress=shares.append)
    assert whole[:3] == first and [result["number"] for result in whole] == list(range(5))
    assert shares == [0.6, 0.8, 1.0]
    after = {file: file.stat().st_mtime_ns for file in before}
    assert {file for file in before if before[file] == after[file]} == set(before) - {damaged}


@LONG
@pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None,
    reason="distributed is not installed: pip install -r tools/requirements/cluster.txt",
)
def test_a_cluster_gives_the_results_of_one_worker(built: None, tmp_path: Path) -> None:
    """By one option, on two workers of a scheduler; two processes of this machine do, too."""
    single = sweep(6, tmp_path / "one", "--workers", "1")
    assert sweep(6, tmp_path / "two", "--workers", "2") == single
    distributed = importlib.import_module("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as cluster:
        assert sweep(6, tmp_path / "dask", "--dask", cluster.scheduler_address) == single


def test_a_missing_package_is_named(
    built: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the command that installs it."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    command = ["sweep", str(BLANK), "press", "--count", "1", "--dask", "tcp://127.0.0.1:1"]
    result = CliRunner().invoke(app, [*command, "--output", str(tmp_path)])
    assert result.exit_code == ExitCode.TOOL_MISSING
    assert "run \"pip install 'ravenbrick[cluster]'\"" in result.output
