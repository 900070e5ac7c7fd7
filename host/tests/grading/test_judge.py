# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Points for runs whose recordings are given."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from verification.support.paths import ROOT
from verification.support.recordings import preempted
from verification.support.submissions import RUBRIC

from ravenbrick.errors import RavenbrickError
from ravenbrick.grading import judge
from ravenbrick.grading.rubric import Check, Rubric, read_rubric
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import read_scenario
from ravenbrick.trace.recording import EventKind, Picture, Recording, Stop, Thread


def graded(
    recording: Recording, monkeypatch: pytest.MonkeyPatch, value: Any, kind: str = "expect"
) -> dict[str, Any]:
    """The row of the first lab's check of a run, asking for this, for a program's run."""

    class Target:
        def __init__(self, settings: dict[str, bool]) -> None:
            assert settings == {"guards_threads": True}

        def run(self, _robot: Robot, _scenario: object, _image: object) -> Recording:
            return recording

    monkeypatch.setattr(judge, "VirtualTarget", Target)
    rubric: Rubric = read_rubric(RUBRIC)
    found = next(check for check in rubric.checks if check.scenario is not None)
    fields: dict[str, Any] = {"value": value, "pulses": None, "seeds": (), "hidden_seeds": 0}
    check: Check = replace(found, kind=kind, **fields)
    path = Path(str(check.scenario))
    scenario = replace(
        read_scenario(path, rubric.robot), inputs=(), stimuli=(), straight=None, step=None
    )
    image: Any = None
    runs = judge._Runs(rubric, {path: scenario}, image)
    return judge.judge_check(rubric, image, runs, check, "secret")


def test_a_program_that_fails_gets_no_points_for_what_it_showed_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Unless the fault is what is asked for; the cause is told."""
    whole = replace(preempted(), threads=(), events=preempted().events[:0])
    crashed = replace(
        whole,
        stop=Stop("halted", 200_000, "tasks.adb:12 range check failed"),
        pictures=(Picture(0, np.zeros((64, 100), bool), ("halted",)),),
    )
    shown = 'lcd shows "closed loop"'
    assert graded(whole, monkeypatch, shown)["points"] > 0
    row = graded(crashed, monkeypatch, shown)
    assert row["points"] == 0 and "tasks.adb:12" in row["found"]
    assert graded(crashed, monkeypatch, "a fault")["points"] > 0


@pytest.mark.parametrize(("limit", "met"), [(0.9, True), (0.89, False)])
def test_the_fullest_stack_of_all_is_judged(
    monkeypatch: pytest.MonkeyPatch, limit: float, met: bool
) -> None:
    """By its own size: 900 of 1000 bytes are more than 1000 of 4000; one without a size is none."""
    stacks = ((4000, 1000), (1000, 900), (0, 5000))
    threads = tuple(Thread(f"task_{i}", i, *stack) for i, stack in enumerate(stacks))
    run = replace(preempted(), threads=threads)
    row = graded(run, monkeypatch, limit, "stack_share_at_most")
    assert (row["points"] > 0) == met and row["found"] == "90 % of a stack"


@pytest.mark.parametrize(("ahead_cycles", "met"), [(40, True), (48_000, False)])
def test_a_job_before_its_instant_shows_that_the_clock_was_moved(
    monkeypatch: pytest.MonkeyPatch, ahead_cycles: int, met: bool
) -> None:
    """Its deadline would count from an instant to come; alarms are some cycles early."""
    run = preempted()
    events = run.events.copy()
    released = events["kind"] == EventKind.RELEASE
    events["value"][released] = events["at_cycles"][released] + ahead_cycles
    row = graded(replace(run, events=events), monkeypatch, 'lcd shows "closed loop"')
    assert (row["points"] > 0) == met
    assert met or "leave the run-time's clock alone" in row["found"]


@pytest.mark.parametrize("other", ["worker_task", "display_task", "environment"])
def test_the_work_of_a_task_that_has_no_deadline_is_told(other: str) -> None:
    """Where deadlines are judged; the main procedure is a task of every program."""
    rubric = read_rubric(RUBRIC)
    tasks = rubric.robot.tasks
    names = {task.name for task in tasks} | {"environment", other}
    threads = tuple(Thread(name, at, 4000, 1000) for at, name in enumerate(sorted(names)))
    run = replace(preempted(), threads=threads, events=preempted().events[:0])
    judge._check_releases(rubric, (), run)
    judge._check_releases(replace(rubric, other_tasks=True), tasks, run)
    if other != "worker_task":
        judge._check_releases(rubric, tasks, run)
        return
    with pytest.raises(RavenbrickError, match="task 'worker_task' is none of the assignment's"):
        judge._check_releases(rubric, tasks, run)


def test_the_judge_starts_without_the_plant_models() -> None:
    """They load SciPy, in as long as the runs of a submission take, and no check needs them."""
    program = "import sys, ravenbrick.grading.judge; print(*sys.modules)"
    words = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    loaded = {name.split(".")[0] for name in words.stdout.split()}
    assert "ravenbrick" in loaded and not loaded & {"scipy", "control", "matplotlib", "jsonschema"}


def test_a_floor_is_read_without_a_library_of_plots() -> None:
    """Matplotlib loads in a third of a second, the library of pictures in a tenth of that."""
    program = """
import sys
from pathlib import Path
from ravenbrick.brick.configuration import brick_configuration
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
folder = Path(sys.argv[1])
robot = read_robot(folder)
scenario = read_scenario(scenario_path(folder, "lap"), robot)
print(len(brick_configuration(robot, scenario, MASTER_CLOCK)["surroundings"]["floor"]))
print(*sys.modules)
"""
    words = [sys.executable, "-c", program, str(ROOT / "examples" / "line-follower")]
    done = subprocess.run(words, capture_output=True, text=True)
    loaded = {name.split(".")[0] for name in done.stdout.split()}
    assert "PIL" in loaded and not loaded & {"scipy", "matplotlib"}, done.stderr
