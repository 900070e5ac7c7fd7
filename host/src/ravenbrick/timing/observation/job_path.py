# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Paths of the longest jobs of a run, instruction by instruction: the run is made again."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.timing.bounds import execution_times
from ravenbrick.timing.observation.observed import longest_jobs
from ravenbrick.trace.recording import Recording

__all__ = ["JobPath", "paths_of_longest_jobs"]

STEP = np.dtype([("address", "<u4"), ("cycles", "<u4"), ("transfers", "<u4")])


@dataclass(frozen=True)
class JobPath:
    """The path of a job in the form of a worst path (`PathReport` of the crate `wcet`), and when
    the job began; cycles. `cycles` is its net execution time."""

    task: str
    begin_cycles: int
    cycles: int
    path: dict[str, Any]


def paths_of_longest_jobs(
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    target: VirtualTarget,
    recording: Recording,
    transfer_cycles: int,
    outside: Collection[str] = (),
) -> dict[str, JobPath]:
    """Of each task the job of the run with the longest net execution time, by the task's name."""
    jobs = longest_jobs(robot, recording, transfer_cycles, outside)
    if not jobs:
        return {}
    windows = [(job.thread, job.begin_cycles, job.end_cycles) for job in jobs.values()]
    seconds = recording.clock.seconds(max(job.end_cycles for job in jobs.values()))
    shorter = min(scenario.duration_ms, math.ceil(1000 * seconds) + 1)
    shortened = replace(scenario, duration_ms=shorter, pictures_ms=())
    again = target.with_profile(windows).run(robot, shortened, image)
    runs = [_steps(profile, transfer_cycles) for profile in again.profiles]
    found = execution_times(image.content, runs=runs).runs
    return {
        name: JobPath(name, job.begin_cycles, job.cycles, path)
        for (name, job), path in zip(jobs.items(), found, strict=True)
    }


def _steps(profile: bytes, transfer_cycles: int) -> Sequence[tuple[int, int]]:
    """Address and cycles of each instruction, without what the data controller took."""
    steps = np.frombuffer(profile, STEP).astype(
        [("address", "i8"), ("cycles", "i8"), ("transfers", "i8")]
    )
    cycles = steps["cycles"] - transfer_cycles * steps["transfers"]
    return list(zip(steps["address"].tolist(), cycles.tolist(), strict=True))
