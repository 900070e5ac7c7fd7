# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The choices of a build besides the sources: of robot.toml, and of the environment."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.errors import UsageError
from ravenbrick.project.robot import Robot, Task

__all__ = ["Settings"]

CHOICES = {
    "CODE": ("arm", "thumb"),
    "RUNTIME_CODE": ("arm", "thumb"),
    "QUEUING": ("fifo", "priority"),
}
# Of the run-time's clock; a deadline has 32 bits of them.
UNITS_PER_MS = 21_024
LONGEST_UNITS = 2**31
FOLDERS = ("GENERATED", "RAVENBRICK_RTS", "DRIVERS_CONFIGURATION")


def _chosen(name: str, variables: Mapping[str, str], default: str = "") -> str:
    value = variables.get(name) or default or CHOICES[name][0]
    if value not in CHOICES[name]:
        raise UsageError(f"{name}={value}: must be {' or '.join(CHOICES[name])}")
    return value


def _deadline_units(task: Task) -> int:
    """A deadline as `Ravenbrick.Supervision` takes it: even, and one more for a sporadic task."""
    assert task.deadline_us is not None
    units = min(task.deadline_us * UNITS_PER_MS // 1_000, LONGEST_UNITS)
    return units // 2 * 2 + (task.release == "sporadic")


def _supervision(robot: Robot) -> str:
    """The linker's switch that has the program supervised; of several tasks of one priority, the
    longest deadline."""
    if not robot.watchdog:
        return ""
    symbols = {"ravenbrick_supervised": 1}
    if robot.motor_timeout_ms:
        symbols["ravenbrick_command_timeout_ms"] = robot.motor_timeout_ms
    for task in robot.tasks:
        if task.deadline_us is not None:
            name = f"ravenbrick_deadline_{task.priority}"
            symbols[name] = max(symbols.get(name, 0), _deadline_units(task))
    return "-Wl" + "".join(f",--defsym={name}={value}" for name, value in symbols.items())


@dataclass(frozen=True)
class Settings:
    """Variables of the environment have their names there; see tools/ravenbrick.cgpr.

    `generated` is the folder of the controller (GENERATED), `run_time` a library to be taken as it
    is (RAVENBRICK_RTS), `configuration` of the drivers another than theirs (DRIVERS_CONFIGURATION).
    """

    profile: str
    execution_time: bool
    stack_check: bool
    code: str
    runtime_code: str
    queuing: str
    heap: str
    generated: Path
    run_time: Path | None
    configuration: Path | None
    supervision: str = ""
    debug: bool = False

    @classmethod
    def of(
        cls, robot: Robot, variables: Mapping[str, str] = os.environ, *, debug: bool = False
    ) -> Settings:
        """What robot.toml and the variables say; raises `UsageError`."""
        folders = {n: Path(variables[n]).resolve() for n in FOLDERS if variables.get(n)}
        return cls(
            profile=robot.profile,
            execution_time=robot.execution_time,
            stack_check=robot.stack_check,
            code=_chosen("CODE", variables, robot.code),
            runtime_code=_chosen("RUNTIME_CODE", variables, robot.code),
            queuing=_chosen("QUEUING", variables),
            heap=variables.get("HEAP", ""),
            generated=folders.get("GENERATED", robot.directory.resolve() / "generated"),
            run_time=folders.get("RAVENBRICK_RTS"),
            configuration=folders.get("DRIVERS_CONFIGURATION"),
            # Unoptimised code may be too slow for the deadlines.
            supervision="" if debug else _supervision(robot),
            debug=debug,
        )

    @property
    def objects(self) -> str:
        """Folder of the drivers' objects, apart from those that are compiled otherwise."""
        parts = [self.code, self.profile if self.profile != "ravenscar" else ""]
        parts += ["timed" if self.execution_time else "", "checked" if self.stack_check else ""]
        return "-".join(filter(None, parts))

    @property
    def own_objects(self) -> str:
        """The same for the project's own objects; tools/application.gpr names it alike."""
        return self.objects + ("-debug" if self.debug else "")

    @property
    def library(self) -> str:
        """Folder of the run-time library among the others; tools/ravenbrick.cgpr names it alike."""
        parts = [self.profile, "priority" if self.queuing == "priority" else ""]
        parts += ["thumb" if self.runtime_code == "thumb" else ""]
        parts += ["timed" if self.execution_time else ""]
        return "-".join(filter(None, parts))

    def values(self) -> dict[str, str]:
        """The variables of gprbuild's project files."""
        found = {
            "CODE": self.code,
            "PROFILE": self.profile,
            "EXECUTION_TIME": "yes" if self.execution_time else "no",
            "STACK_CHECK": "yes" if self.stack_check else "no",
            "OBJECTS": self.objects,
            "HEAP": self.heap,
            "SUPERVISION": self.supervision,
            "GENERATED": str(self.generated),
        }
        if self.debug:
            found["DEBUG"] = "yes"
        if self.configuration is not None:
            found["DRIVERS_CONFIGURATION"] = str(self.configuration)
        return found

    def record(self) -> dict[str, Any]:
        """For the record of what an image was made from."""
        return {**self.values(), "run-time library": str(self.run_time or self.library)}
