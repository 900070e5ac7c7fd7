# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ada programs for the timing analysis: as images, and with their flow facts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.timing_profile import TimingProfile
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.timing.analysis import Analysis, analyse
from ravenbrick.timing.facts.facts import Facts, read_facts
from ravenbrick.timing.initial_state import elaborated
from ravenbrick.trace.recording import Recording

from verification.support.bricks.programs import gprbuild
from verification.support.paths import ROOT

__all__ = ["Subject", "analysed", "built", "subject"]

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Subject:
    """A program with its project's files."""

    robot: Robot
    image: ElfImage
    scenario: Scenario
    facts: Facts

    def run(self, timing: str = "nominal") -> Recording:
        """Its scenario, in a timing profile."""
        target = VirtualTarget(settings=TimingProfile(timing).settings)
        return target.run(self.robot, self.scenario, self.image)


def built(folder: str, program: str, *switches: str) -> ElfImage:
    """A program of a folder here, with the Ravenscar run-time and switches of the compiler. Its
    library files are its own: gprbuild compiles what needs the run-time anew for each program."""
    build = ROOT / "build" / "verification" / folder / "".join([program, *switches])
    gprbuild(
        HERE / "programs.gpr",
        "-cargs",
        *switches,
        FOLDER=folder,
        MAIN=program,
        BUILD=build,
    )
    return read_image(build / f"{program}.elf")


@cache
def subject(folder: str, program: str, *switches: str) -> Subject:
    """A program that has `robot.toml`, `timing.toml` and the scenario `steady`, built with switches
    of the compiler."""
    robot = read_robot(HERE / folder)
    scenario = read_scenario(scenario_path(HERE / folder, "steady"), robot)
    image = built(folder, program, *switches)
    return Subject(robot, image, scenario, read_facts(robot).of_image(image))


def analysed(program: Subject, facts: Facts, timing: str = "nominal") -> Analysis:
    """Bounds under these facts in a timing profile. Raises as `analyse`."""
    brick = elaborated(program.robot, program.scenario, program.image)
    return analyse(program.robot, program.image, brick, facts, timing)
