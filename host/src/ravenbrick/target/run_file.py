# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sessions and runs of the page: the same JSON objects, written here and there.

A session is a program's surroundings, tasks and inputs; a run is a session with the inputs that
were applied, its end, its digest and its image. docs/reference/run-files.md describes the fields.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.errors import ProjectFileError, ScenarioError
from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.configuration import brick_configuration
from ravenbrick.target.robot import Robot
from ravenbrick.target.scenario import Scenario
from ravenbrick.target.stimulus import TimedInput

__all__ = ["RunFile", "read_run_file", "session_of"]

FORMAT = "ravenbrick run"
VERSION = 1


@dataclass(frozen=True)
class RunFile:
    """A run that the page saved; `configuration` is what the brick was made of."""

    path: Path
    configuration: dict[str, Any]
    inputs: tuple[TimedInput, ...]
    until_ms: int
    digest: str


def session_of(
    robot: Robot,
    scenario: Scenario,
    named: bool = True,
    bounds_cycles: Mapping[str, int] | None = None,
) -> dict[str, Any]:
    """The session that the page loads; `named` false hides a scenario that was made up.

    `bounds_cycles` are proven response times by the name of the task.
    """
    bounds = bounds_cycles or {}
    return {
        "project": robot.name,
        "scenario": scenario.name if named else None,
        "configuration": brick_configuration(robot, scenario, MASTER_CLOCK),
        "probes": [{"symbol": s.symbol, "kind": s.type} for s in robot.setpoints],
        "tasks": [
            {
                "name": task.name,
                "release": task.release,
                "period_us": task.period_us,
                "deadline_us": task.deadline_us,
                "priority": task.priority,
                "bound_cycles": bounds.get(task.name),
            }
            for task in robot.tasks
        ],
        "inputs": [
            {"at_cycles": timed.at_cycles, "name": timed.name, "value": timed.value}
            for timed in scenario.timed_inputs()
        ],
    }


def _fields(path: Path, values: Any) -> RunFile:
    if not isinstance(values, dict) or values.get("format") != FORMAT:
        raise ProjectFileError(path, 1, "format", f'expected "{FORMAT}"; save a run in the page')
    if values.get("version") != VERSION:
        raise ProjectFileError(
            path, 1, "version", f"is {values.get('version')!r}; expected {VERSION}"
        )
    try:
        inputs = tuple(
            TimedInput(int(i["at_cycles"]), str(i["name"]), float(i["value"]), f"{path}:1")
            for i in values["inputs"]
        )
        return RunFile(
            path, values["configuration"], inputs, int(values["until_ms"]), str(values["digest"])
        )
    except KeyError as error:
        raise ProjectFileError(path, 1, str(error.args[0]), "is missing") from None
    except (TypeError, ValueError) as error:
        raise ProjectFileError(path, 1, "inputs", f"{error}; save the run again") from None


def read_run_file(path: Path) -> RunFile:
    """Read a saved run; raises `ScenarioError`, `ProjectFileError`."""
    if not path.is_file():
        raise ScenarioError(f"{path}: there is no such file; save a run in the page")
    try:
        return _fields(path, json.loads(path.read_text(encoding="utf-8")))
    except json.JSONDecodeError as error:
        raise ProjectFileError(path, error.lineno, "", f"no JSON: {error.msg}") from None
    except UnicodeDecodeError:
        raise ProjectFileError(path, 1, "", "not UTF-8 text; save the run again") from None
