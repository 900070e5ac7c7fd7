# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Built examples with what is known of their code: annotations, and where their jobs wait."""

from __future__ import annotations

from dataclasses import dataclass

from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace
from ravenbrick.timing.analysis import known_facts
from ravenbrick.timing.bounds import JobQuestion
from ravenbrick.timing.facts.facts import Facts, read_facts
from ravenbrick.timing.task_set.jobs import JobsOfTasks

from verification.support.paths import ROOT

__all__ = ["known_example"]


@dataclass(frozen=True)
class KnownExample:
    """An image, facts by their sources, and the questions for its jobs."""

    image: ElfImage
    facts: Facts
    annotations: list[tuple[str, str]]
    jobs: list[JobQuestion]


def known_example(name: str) -> KnownExample:
    """An example by its folder's name. Raises `ImageFileError` when it is not built."""
    workspace = Workspace.of(ROOT / "examples" / name)
    robot = read_robot(workspace.project)
    facts, image = read_facts(robot), read_image(workspace.image("ram", robot.name))
    _, annotations = known_facts(robot, image, facts)
    jobs = JobsOfTasks(image, facts, robot.tasks, annotations, "nominal").questions
    return KnownExample(image, facts, annotations, jobs)
