# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every run has something to show: with or without role, deadlines, motors; failed or not."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from verification.support.recordings import preempted

from ravenbrick.errors import RunFaultError
from ravenbrick.project.robot import Robot, Task
from ravenbrick.project.scenario import Scenario, read_scenario
from ravenbrick.report.run_report import write_report
from ravenbrick.trace.measures import measure_run
from ravenbrick.trace.recording import Picture, Recording, Stop
from ravenbrick.trace.summary import Evidence, Run

WORKER = Task("worker", "", "cyclic", 10_000, 4_000, 1, 1024)
FAULT = RunFaultError("scenario 'any': tasks.adb:54: Constraint_Error", detail="Program failed")


def _without_deadline(robot: Robot) -> Robot:
    return replace(robot, tasks=(replace(WORKER, deadline_us=None),))


@pytest.fixture
def scenario(robot: Robot) -> Scenario:
    """A scenario without role."""
    found = read_scenario(robot.directory / "scenarios" / "step-with-friction.toml", robot)
    return replace(found, name="any", step=None, straight=None)


def _picture() -> Picture:
    pixels = np.zeros((64, 100), bool)
    pixels[3, 7] = True
    return Picture(150_000, pixels, ("presses 2",))


def _run(robot: Robot, scenario: Scenario, recording: Recording) -> Run:
    robot = robot if not robot.task("control_task") else replace(robot, tasks=(WORKER,))
    recording = replace(recording, pictures=(_picture(),))
    return Run(robot, scenario, recording, measure_run(robot, scenario, recording), ())


def _page(evidence: Evidence, folder: Path) -> str:
    report, _figures = write_report(evidence, folder)
    for drawing in (folder / "figures").glob("*.svg"):
        ET.parse(drawing)
    return report.read_text()


def _headings(page: str) -> list[str]:
    return re.findall(r"<figcaption>(\w+ ?\w*)", page)


def test_a_run_without_role_shows_signals_path_lcd_responses_and_schedule(
    robot: Robot, scenario: Scenario, tmp_path: Path
) -> None:
    """Nothing depends on the role, which only arranges."""
    run = _run(robot, scenario, preempted())
    page = _page(Evidence(robot, None, None, (run,), None, {"worker": 20_000}), tmp_path)
    assert _headings(page)[:6] == [
        "Signals of",
        "Path from",
        "LCD after",
        "Response times",
        "Schedule of",
        "Its beginning",
    ]
    assert "LCD: presses 2" in page
    assert ">deadline<" in page
    assert ">bound of analyse<" in page
    assert "20 000" in page


@pytest.mark.parametrize(
    ("change", "absent"),
    [
        (_without_deadline, ">deadline</text>"),
        (lambda robot: replace(robot, motor_ports={}, setpoints=()), "speed (°/s)"),
        (lambda robot: replace(robot, tasks=()), ">deadline</text>"),
    ],
)
def test_a_robot_without_deadlines_motors_or_tasks_has_a_report(
    robot: Robot,
    scenario: Scenario,
    tmp_path: Path,
    change: Callable[[Robot], Robot],
    absent: str,
) -> None:
    """What is not there is left out; the rest is shown."""
    run = _run(change(replace(robot, tasks=(WORKER,))), scenario, preempted())
    page = _page(Evidence(run.robot, None, None, (run,), None), tmp_path)
    assert absent not in page
    assert {"Signals of", "Response times", "Schedule of"} <= set(_headings(page))


def test_a_failed_run_shows_its_sentence_and_what_was_recorded(
    robot: Robot, scenario: Scenario, tmp_path: Path
) -> None:
    """The sentence stands before the pictures."""
    failed = replace(preempted(), stop=Stop("fault", 200_000, "tasks.adb:54"))
    run = replace(_run(robot, scenario, failed), problem=FAULT)
    page = _page(Evidence(robot, None, None, (run,), None), tmp_path)
    assert "0 of 1</b><span>runs passed" in page
    assert page.index("Constraint_Error") < page.index("Program failed") < page.index("Signals of")


def test_what_a_project_says_is_text(robot: Robot, scenario: Scenario, tmp_path: Path) -> None:
    """No name, description or message becomes an element of the page."""
    hostile = "</title><script>&"
    run = _run(robot, replace(scenario, name=hostile, description=hostile), preempted())
    run = replace(run, problem=RunFaultError(hostile, detail=hostile))
    named = replace(robot, name=hostile, description=hostile)
    page = _page(Evidence(named, None, None, (run,), None), tmp_path)
    assert "<script" not in page
    assert "&lt;script&gt;&amp;" in page


def test_a_run_that_ended_before_any_event_has_a_section(
    robot: Robot, scenario: Scenario, tmp_path: Path
) -> None:
    """No task, no job, no signal: no exception either."""
    whole = preempted()
    empty = replace(
        whole, events=whole.events[:0], signals={}, threads=(), inputs=(), stop=Stop("fault", 0, "")
    )
    run = replace(_run(robot, scenario, empty), problem=FAULT)
    page = _page(Evidence(robot, None, None, (run,), None), tmp_path)
    assert "ended before any task was known" in page


def test_a_second_report_leaves_no_drawing_of_the_first(
    robot: Robot, scenario: Scenario, tmp_path: Path
) -> None:
    """The folder holds what the page shows."""
    first = _run(robot, replace(scenario, name="first"), preempted())
    second = _run(robot, replace(scenario, name="second"), preempted())
    _page(Evidence(robot, None, None, (first,), None), tmp_path)
    _page(Evidence(robot, None, None, (second,), None), tmp_path)
    names = {path.name.split("-")[1] for path in (tmp_path / "figures").iterdir()}
    assert names == {"second"}
