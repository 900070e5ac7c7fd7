# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program with timing events, analysed and run on the virtual brick.

`python -m conformance.timing.timing_events` prints bounds and largest values seen as JSON.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.elf_image import ElfImage
from ravenbrick.target.robot import Robot, read_robot
from ravenbrick.target.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.target.virtual import VirtualTarget
from ravenbrick.timing.analysis import Analysis, analyse
from ravenbrick.timing.facts import Facts, read_facts
from ravenbrick.timing.observed import check_event_rates, observe
from ravenbrick.trace.recording import Recording

from conformance.timing.ada_programs import built

__all__ = ["Subject", "analysed", "compared", "subject"]

FOLDER = Path(__file__).parent
ELABORATED_MS = 100


@dataclass(frozen=True)
class Subject:
    """The program with what is known about it."""

    robot: Robot
    image: ElfImage
    scenario: Scenario
    facts: Facts

    def run(self) -> Recording:
        """Its scenario."""
        return VirtualTarget().run(self.robot, self.scenario, self.image)


@cache
def subject(folder: str = "events", program: str = "expiring_load") -> Subject:
    """Build a program of this folder."""
    robot = read_robot(FOLDER / folder)
    scenario = read_scenario(scenario_path(FOLDER / folder, "steady"), robot)
    return Subject(robot, built(folder, program), scenario, read_facts(robot))


def analysed(program: Subject, facts: Facts) -> Analysis:
    """Bounds under these facts."""
    brick = VirtualTarget().prepare(program.robot, program.scenario, program.image)
    brick.run_until(MASTER_CLOCK.cycles_of_ms(ELABORATED_MS))
    return analyse(program.robot, program.image, brick, facts)


def compared() -> list[dict[str, Any]]:
    """Bounds beside the largest values seen, for each task; cycles."""
    program = subject()
    analysis, recording = analysed(program, program.facts), program.run()
    check_event_rates(program.robot, program.facts, recording)
    seen = observe(program.robot, recording)
    rows = []
    for timing in analysis.tasks:
        name = timing.task.name
        bound = analysis.bounds[name].bound
        pairs = {
            "execution": [timing.job.cycles, seen[name].execution_cycles],
            "response": [None if bound is None else int(bound), seen[name].response_cycles],
            "stack": [timing.stack_bound_bytes, seen[name].stack_bytes],
        }
        rows.append({"task": name, **pairs})
    return rows


def main() -> int:
    """Print the comparison."""
    print(json.dumps(compared(), indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
