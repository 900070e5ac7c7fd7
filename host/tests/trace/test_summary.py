# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A design that was left in a file, and a run beside it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from verification.support.recordings import preempted

from ravenbrick.errors import DesignError
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.trace.design import Design, read_design
from ravenbrick.trace.measures import StepRecord, measure_run
from ravenbrick.trace.motion import StepMeasures
from ravenbrick.trace.schedule import cyclic_begin_cycles
from ravenbrick.trace.summary import Evidence, Run, summary

RESPONSE = {"time": [0.0, 0.1, 0.2], "value": [0.0, 0.8, 1.0], "settling_time": 0.2, "overshoot": 0}


@pytest.fixture
def run(robot: Robot, project: Path) -> Run:
    """The vehicle's step scenario with the made recording."""
    scenario = read_scenario(scenario_path(project, "drive"), robot)
    scenario = replace(scenario, straight=None, step=None)
    recording = preempted()
    return Run(robot, scenario, recording, measure_run(robot, scenario, recording), ())


def compared(run: Run, setpoint: float, design: Design | None) -> Any:
    """The figure of a step to 2 rad/s whose true speed is 0.1 rad/s below the design at 0.2 s."""
    times = np.array([0.0, 0.05, 0.1, 0.2, 0.3])
    true = np.array([0.0, 0.8, 1.6, 1.9, 9.0])
    found = StepMeasures(setpoint, 2.0, None, 0.0, None, 0.0)
    record = StepRecord("B", times, true, true, times, true, found)
    measures = replace(run.measures, steps={"B": record})
    return summary(Evidence(run.robot, design, None, (replace(run, measures=measures),), None))


def test_a_step_is_compared_with_the_simulation_as_long_as_that_is(
    run: Run, tmp_path: Path
) -> None:
    """By hand: expected the set-point, measured 0.95 of it; what comes after 0.2 s is left out."""
    (tmp_path / "design.json").write_text(json.dumps({"sampled": RESPONSE, "figures": {}}))
    design = read_design(tmp_path / "design.json")
    assert compared(run, 2.0, design)["simulation_difference"] == pytest.approx(0.05)
    assert compared(run, 0.0, design)["simulation_difference"] is None
    assert compared(run, 2.0, replace(design, responses={}))["simulation_difference"] is None
    assert compared(run, 2.0, None)["simulation_difference"] is None


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"time": [0.0, 0.1]}, "time and value differ in length"),
        ({"time": [], "value": []}, "time and value differ"),
        ({"time": [[0.0]], "value": [[0.0]]}, "time and value differ"),
        ({"time": ["x"], "value": [1]}, "not a design"),
    ],
)
def test_a_design_with_a_wrong_response_is_none(
    tmp_path: Path, change: dict[str, Any], sentence: str
) -> None:
    """The file is named, and what to run."""
    path = tmp_path / "design.json"
    path.write_text(json.dumps({"continuous": RESPONSE | change, "figures": {}}))
    with pytest.raises(DesignError, match=rf"design.json: .*{sentence}.*run 'ravenbrick design'"):
        read_design(path)
    with pytest.raises(DesignError, match="there is no design yet"):
        read_design(tmp_path / "absent.json")


def test_a_tasks_cycle_begins_with_its_second_job(robot: Robot) -> None:
    """Of the cyclic task that begins last; tasks with one job and others do not count."""
    urgent = replace(robot.tasks[0], name="urgent", release="cyclic")
    cyclic = replace(robot, tasks=(urgent, replace(urgent, name="worker")))
    assert cyclic_begin_cycles(cyclic, preempted()) == 99_000
    sporadic = replace(robot, tasks=(replace(urgent, release="sporadic"),))
    assert cyclic_begin_cycles(sporadic, preempted()) == 0
