# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`python -m ravenbrick.grading.judge RUBRIC IMAGE ANSWER`: the runs of one image, judged."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.errors import RavenbrickError
from ravenbrick.grading.rubric import Check, Rubric, read_rubric
from ravenbrick.grading.work import ELF, check_row
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.image.memory import memory_report
from ravenbrick.project.criteria import Expectation
from ravenbrick.project.criteria_text import parse_expectation
from ravenbrick.project.scenario import Scenario, read_scenario
from ravenbrick.trace.measures import RunMeasures, check_survival, evaluate_criteria, measure_run
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.verdict import expects_fault, judge

CheckedRun = tuple[Recording, RunMeasures]


class _Runs:
    """Runs each scenario with each seed once."""

    def __init__(self, rubric: Rubric, image: ElfImage) -> None:
        self._rubric, self._image = rubric, image
        self._played: dict[tuple[Path, int], CheckedRun] = {}

    def scenario(self, check: Check, seed: int | None) -> Scenario:
        """The check's scenario with the seed and, of the check, the expectation."""
        assert check.scenario is not None
        read = read_scenario(check.scenario, self._rubric.robot)
        own: tuple[Expectation, ...] = ()
        if check.kind == "expect":
            own = (parse_expectation(check.value, check.place),)
        seeded = read if seed is None else replace(read, seed=seed)
        return (
            seeded if check.kind == "criteria" else replace(seeded, criteria=(), expectations=own)
        )

    def run(self, check: Check, seed: int | None) -> CheckedRun:
        """The recording and its measures; raises `RavenbrickError`."""
        assert check.scenario is not None
        scenario = self.scenario(check, seed)
        key = (check.scenario, scenario.seed)
        if key not in self._played:
            recording = VirtualTarget().run(self._rubric.robot, scenario, self._image)
            self._played[key] = recording, measure_run(self._rubric.robot, scenario, recording)
        recording, measures = self._played[key]
        if not expects_fault(scenario.expectations):
            check_survival(scenario, recording)
        return recording, measures


def _judge_run(runs: _Runs, check: Check, seed: int | None) -> tuple[bool, str]:
    recording, measures = runs.run(check, seed)
    scenario = runs.scenario(check, seed)
    if check.kind == "criteria":
        results = evaluate_criteria(scenario, recording, measures)
        missed = [result.label for result in results if not result.met]
        return not missed, "; ".join(missed) or "all met"
    if check.kind == "expect":
        verdict = judge(scenario.expectations[0], recording, measures)
        return verdict.met, verdict.shown
    shares = [t.stack_used_bytes / t.stack_bytes for t in recording.threads if t.stack_bytes]
    return max(shares) <= check.value, f"{100 * max(shares):.0f} % of a stack"


def _judge_image(check: Check, image: ElfImage, rubric: Rubric) -> tuple[bool, str]:
    if check.kind == "builds":
        return True, "builds"
    used = memory_report(image, rubric.robot).used
    return used <= check.value, f"{used} bytes"


def judge_check(rubric: Rubric, image: ElfImage, runs: _Runs, check: Check) -> dict[str, Any]:
    """Points in proportion to the seeds that pass; `found` tells the first that does not.

    Answers do not concern the image; they are graded elsewhere.
    """
    if check.kind == "answer":
        return check_row(check, 0.0, "")
    seeds: tuple[int | None, ...] = check.seeds or (None,)
    passed, found = 0, ""
    for seed in seeds:
        try:
            if check.scenario is None:
                met, seen = _judge_image(check, image, rubric)
            else:
                met, seen = _judge_run(runs, check, seed)
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


def main(rubric_path: str, image_folder: str, answer: str) -> None:
    """Write the rows of all checks."""
    rubric = read_rubric(Path(rubric_path))
    image = read_image(Path(image_folder) / ELF)
    runs = _Runs(rubric, image)
    rows = [judge_check(rubric, image, runs, check) for check in rubric.checks]
    Path(answer).write_text(json.dumps(rows), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
