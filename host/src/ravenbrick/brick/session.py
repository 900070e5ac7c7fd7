# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The session that the page loads: a program's surroundings, tasks and inputs, as JSON.

docs/reference/run-files.md describes the fields.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from ravenbrick.brick.configuration import brick_configuration
from ravenbrick.brick.tunables import read_tunables
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario

__all__ = ["session_of", "tunables_of"]


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
        "duration_ms": scenario.duration_ms if named else None,
        "checks": _checks(robot, scenario),
        "questions": [asdict(question) for question in scenario.questions],
    }


def _checks(robot: Robot, scenario: Scenario) -> dict[str, Any]:
    """The pass criteria, as crate `measures` judges them."""
    step, straight = scenario.step, scenario.straight
    return {
        "setpoints": [
            {"port": s.port, "symbol": s.symbol, "factor": s.factor} for s in robot.setpoints
        ],
        "step": step and asdict(step),
        "straight": straight and asdict(straight),
        "criteria": [
            {"measure": c.measure, "minimum": c.minimum, "maximum": c.maximum}
            for c in scenario.criteria
        ],
        "expectations": [expectation.text for expectation in scenario.expectations],
    }


def _set_points(robot: Robot) -> list[dict[str, Any]]:
    """Set-points that the page may change, as tunable parameters."""
    return [
        {
            "path": point.set_by.variable,
            "name": f"set-point {point.port}",
            "seen": point.symbol,
            "unit": "V" if point.scale.unit.endswith("/V") else point.scale.unit,
            "description": f"of motor {point.port}'s speed",
            "value": point.set_by.value,
            "whole": point.type != "f32",
            "lowest": point.set_by.lowest,
            "highest": point.set_by.highest,
        }
        for point in robot.setpoints
        if point.set_by
    ]


def tunables_of(robot: Robot, image: ElfImage) -> list[dict[str, Any]]:
    """The set-points and tunable parameters that an image has, for the session."""
    generated = [
        asdict(tunable) | dict(zip(("lowest", "highest"), tunable.limits, strict=True))
        for tunable in read_tunables(robot.directory / "generated")
    ]
    return [t for t in (*_set_points(robot), *generated) if _is_in(image, t["path"])]


def _is_in(image: ElfImage, path: str) -> bool:
    """Whether the variable, or the object that it is a component of, is a symbol."""
    plain = path.partition(":")[0]
    return plain.partition(".")[0] in image.symbols or (
        plain.replace(".", "__").lower() in image.symbols
    )
