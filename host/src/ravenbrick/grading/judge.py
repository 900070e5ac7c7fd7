# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`python -m ravenbrick.grading.judge`: the runs of one image, judged.

Its input is what `work` pickled, its output the rows of all checks. The judge runs inside the
sandbox: a program on the virtual brick reaches neither.
"""

from __future__ import annotations

import json
import os
import pickle
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.errors import ProjectFileError, RavenbrickError, RunFaultError
from ravenbrick.grading.draws import Pulses, hidden_seeds
from ravenbrick.grading.race import mean_measures
from ravenbrick.grading.rubric import Check, Rubric, check_row
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.image.memory import memory_report
from ravenbrick.project.criteria import Expectation, parse_expectation
from ravenbrick.project.robot import Robot, Task
from ravenbrick.project.scenario import Scenario
from ravenbrick.trace.measures import RunMeasures, check_survival, evaluate_criteria, measure_run
from ravenbrick.trace.recording import ENVIRONMENT, EventKind, Recording
from ravenbrick.trace.task_set import check_release
from ravenbrick.trace.verdict import expects_fault, judge

# What says of tasks whether they were in time is written by the run-time alone.
GUARDED = {"guards_threads": True}
# The run-time sets its alarms some cycles early.
EARLY_CYCLES = 48
CheckedRun = tuple[Recording, RunMeasures]


class _Runs:
    """Runs each scenario with each seed once."""

    def __init__(self, rubric: Rubric, scenarios: dict[Path, Scenario], image: ElfImage) -> None:
        self._rubric, self._scenarios, self._image = rubric, scenarios, image
        self._played: dict[tuple[Path, int, Pulses | None, str], CheckedRun] = {}

    def scenario(self, check: Check, seed: int | None) -> Scenario:
        """The check's scenario with the seed and, of the check, the expectation."""
        assert check.scenario is not None
        read = self._scenarios[check.scenario]
        own: tuple[Expectation, ...] = ()
        seeded = read if seed is None else replace(read, seed=seed)
        if check.kind == "expect":
            text, pulses = check.value, check.pulses
            if pulses:
                seeded = replace(seeded, inputs=pulses.inputs(read.inputs, seeded.seed))
                text = pulses.filled(text, seeded.seed)
            own = (parse_expectation(text, check.place),)
        return (
            seeded
            if check.kind in ("criteria", "race")
            else replace(seeded, criteria=(), expectations=own)
        )

    def run(self, check: Check, seed: int | None) -> CheckedRun:
        """The recording and its measures; raises `RavenbrickError`."""
        assert check.scenario is not None
        scenario = self.scenario(check, seed)
        race = check.value if check.kind == "race" else None
        key = (check.scenario, scenario.seed, check.pulses, repr(race))
        if key not in self._played:
            robot = self._rubric.robot
            if race is not None:
                robot = race.robot(robot, scenario.seed, Path.cwd())
            recording = VirtualTarget(settings=GUARDED).run(robot, scenario, self._image)
            self._played[key] = recording, measure_run(robot, scenario, recording)
        recording, measures = self._played[key]
        if not expects_fault(scenario.expectations):
            check_survival(scenario, recording)
        return recording, measures


def _judged_tasks(robot: Robot, expected: Sequence[Expectation]) -> list[Task]:
    """Tasks whose deadlines or response times are judged."""
    judged = [e.task for e in expected if e.judges_tasks]
    names = {task and task.lower() for task in judged}
    return [task for task in robot.tasks if None in names or task.name.lower() in names]


def _check_clock(recording: Recording) -> None:
    """Raise `RavenbrickError` for a job that began before the instant for which its task waited.

    The instant is the run-time's: a program that moves its clock would always be in time.
    """
    events = recording.events[recording.events["kind"] == EventKind.RELEASE]
    early = events["value"] - events["at_cycles"].astype(np.int64) > EARLY_CYCLES
    if early.any():
        name = recording.threads[int(events["subject"][early.argmax()])].name
        raise RavenbrickError(
            f"the task '{name}' is released before its instant; leave the run-time's clock alone"
        )


def _check_releases(rubric: Rubric, tasks: Sequence[Task], recording: Recording) -> None:
    """Raise `RavenbrickError` for a task that is absent or not released as the assignment says, and
    for one that it does not name unless it allows others.

    A task under another name has no deadline, and would miss none, whatever it does for the others.
    A job ends where its task waits: a wait in the middle would make two short jobs of a long one.
    """
    found = {thread.name.lower() for thread in recording.threads}
    _check_clock(recording)
    others = found - {task.name.lower() for task in rubric.robot.tasks} - {ENVIRONMENT}
    if tasks and others and not rubric.other_tasks:
        raise RavenbrickError(
            f"the task '{min(others)}' is none of the assignment's, so its work would have no "
            "deadline; let the assignment's tasks do it"
        )
    for task in tasks:
        if task.name.lower() not in found:
            raise RavenbrickError(
                f"there is no task '{task.name}', whose deadlines are judged; name it so"
            )
        try:
            check_release(rubric.robot, recording, task.name)
        except ProjectFileError as error:
            raise RavenbrickError(
                f"the task '{task.name}' is not released as the assignment says: {error.field} "
                + error.problem.partition(";")[0]
            ) from None


def _raced(
    rubric: Rubric, runs: _Runs, check: Check, seeds: Sequence[int | None]
) -> dict[str, Any]:
    """The row of a race: its points by the seeds that finish, measures where all do."""
    measured: list[dict[str, float]] = []
    lost: list[tuple[str, str]] = []
    for seed in seeds:
        try:
            met, found = _judge_run(rubric, runs, check, seed)
            if met:
                recording, measures = runs.run(check, seed)
                measured.append(check.value.measure(rubric.robot, recording, measures))
            else:
                lost.append((found, f"not met: {found}"))
        except RunFaultError as error:
            # What the program says is for its author, not for a page that all read.
            lost.append((_without_folders(error.sentence), "the program failed"))
        except RavenbrickError as error:
            lost.append((_without_folders(error.sentence), error.sentence))
    if lost:
        row = check_row(check, len(measured) / len(seeds), lost[0][0])
        return {**row, "lost": lost[0][1]}
    means = mean_measures(measured)
    shown = ", ".join(f"{name} {value:g}" for name, value in means.items())
    return {**check_row(check, 1.0, shown), "measures": means}


def _judge_run(rubric: Rubric, runs: _Runs, check: Check, seed: int | None) -> tuple[bool, str]:
    recording, measures = runs.run(check, seed)
    scenario = runs.scenario(check, seed)
    judged = _judged_tasks(rubric.robot, scenario.expectations)
    if check.kind == "race":
        judged = [task for task in rubric.robot.tasks if task.deadline_us]
    _check_releases(rubric, judged, recording)
    if check.kind in ("criteria", "race"):
        results = evaluate_criteria(scenario, measures)
        missed = [result.label for result in results if not result.met]
        return not missed, "; ".join(missed) or "all met"
    if check.kind == "expect":
        verdict = judge(scenario.expectations[0], measures)
        return verdict.met, verdict.shown
    shares = [t.stack_used_bytes / t.stack_bytes for t in recording.threads if t.stack_bytes]
    return max(shares) <= check.value, f"{100 * max(shares):.0f} % of a stack"


def _judge_image(check: Check, image: ElfImage, rubric: Rubric) -> tuple[bool, str]:
    if check.kind == "builds":
        return True, "builds"
    used = memory_report(image, rubric.robot).used
    return used <= check.value, f"{used} bytes"


def judge_check(
    rubric: Rubric, image: ElfImage, runs: _Runs, check: Check, secret: str
) -> dict[str, Any]:
    """Points in proportion to the seeds that pass; `found` tells the first that does not.

    Answers do not concern the image; they are graded elsewhere.
    """
    if check.kind == "answer":
        return check_row(check, 0.0, "")
    drawn = hidden_seeds(secret, check.name, check.hidden_seeds)
    seeds: tuple[int | None, ...] = (*check.seeds, *drawn) or (None,)
    if check.kind == "race":
        return _raced(rubric, runs, check, seeds)
    passed, found = 0, ""
    for seed in seeds:
        try:
            if check.scenario is None:
                met, seen = _judge_image(check, image, rubric)
            else:
                met, seen = _judge_run(rubric, runs, check, seed)
        except RavenbrickError as error:
            met, seen = False, _without_folders(error.sentence)
        passed += met
        if not found or not met:
            found = seen
    return check_row(check, passed / len(seeds), found)


def _without_folders(sentence: str) -> str:
    """File names only: where the grader keeps things is not the student's business."""
    return " ".join(
        word.rpartition("/")[2] if word.startswith("/") else word for word in sentence.split()
    )


def main() -> None:
    """Write the rows of all checks; nothing else that writes gets the pipe of the result."""
    result = os.dup(sys.stdout.fileno())
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    rubric, secret, scenarios, elf = pickle.load(sys.stdin.buffer)
    file = Path("image.elf").resolve()
    file.write_bytes(elf)
    image = read_image(file)
    runs = _Runs(rubric, scenarios, image)
    rows = [judge_check(rubric, image, runs, check, secret) for check in rubric.checks]
    with os.fdopen(result, "w", encoding="utf-8") as stream:
        json.dump(rows, stream)


if __name__ == "__main__":
    main()
