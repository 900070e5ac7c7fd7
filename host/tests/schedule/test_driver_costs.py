# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Task sets whose tasks call drivers: the measured table is part of the analysis."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ProjectFileError
from ravenbrick.schedule import response_time_bounds
from ravenbrick.schedule.task_file import read_task_file

TABLE = Path(__file__).resolve().parents[3] / "docs" / "reference" / "driver-costs.json"
COSTS = {
    "clock_hz": [1_000_000, 1],
    "operations": [
        {"name": "Look", "task_cycles": 30, "interrupt_cycles": 0, "masked_cycles": 4},
        {"name": "Show", "task_cycles": 100, "interrupt_cycles": 50, "masked_cycles": 7},
    ],
    "tasks": [{"name": "pump", "period_ms": 2.0, "longest_cycles": 200}],
}
SET = """
schema_version = 1
unit = "us"
driver_costs = "costs.json"
driver_tasks = ["pump"]

[[tasks]]
name = "control"
period = 4_000
wcet = 1_000
priority = 2
operations = { Look = 2, Show = 1 }

[[tasks]]
name = "rest"
period = 10_000
wcet = 500
priority = 1
"""


def written(folder: Path, text: str = SET) -> Path:
    """The task set and its table."""
    (folder / "costs.json").write_text(json.dumps(COSTS))
    path = folder / "set.toml"
    path.write_text(text)
    return path


def test_operations_are_charged_to_tasks_interrupts_and_masking(tmp_path: Path) -> None:
    """Time of the task, an interrupt with its period, the longest masking, the drivers' task."""
    file = read_task_file(written(tmp_path))
    tasks = {task.name: task for task in file.task_set.tasks}
    assert tasks["control"].wcet == 1_160
    assert (tasks["interrupts of control"].wcet, tasks["interrupts of control"].period) == (
        50,
        4000,
    )
    assert tasks["interrupts of control"].release == "interrupt"
    assert (tasks["pump"].wcet, tasks["pump"].period) == (200, 2_000)
    assert tasks["interrupts of control"].priority > tasks["pump"].priority > 2
    assert file.overheads.masked_section == 7
    bounds = {
        found.task.name: found.bound
        for found in response_time_bounds(file.task_set, file.overheads)
    }
    assert bounds["control"] == 1_160 + 200 + 50 + 7
    assert bounds["rest"] == 500 + 1_160 + 50 + 200 + 7


@pytest.mark.parametrize("unit", ["s", "ms", "us", "cycles"])
def test_the_real_table_is_read_in_every_unit(tmp_path: Path, unit: str) -> None:
    """An operation costs the same time in each."""
    (tmp_path / "costs.json").write_bytes(TABLE.read_bytes())
    path = tmp_path / "set.toml"
    text = SET.replace('"us"', f'"{unit}"').replace(
        "Look = 2, Show = 1", '"Motor_Controls.Drive" = 1'
    )
    path.write_text(
        text.replace('["pump"]', '["coprocessor_task"]').replace("wcet = 1_000", "wcet = 1")
    )
    file = read_task_file(path)
    cycles = {row["name"]: row for row in json.loads(TABLE.read_text())["operations"]}
    per_unit = {"s": 1, "ms": 1_000, "us": 1_000_000}
    hertz = MASTER_CLOCK.hertz
    factor = Fraction(1) if unit == "cycles" else per_unit[unit] / hertz
    control = next(task for task in file.task_set.tasks if task.name == "control")
    assert control.wcet == 1 + cycles["Motor_Controls.Drive"]["task_cycles"] * factor


@pytest.mark.parametrize(
    ("before", "after", "place", "problem"),
    [
        ("Look = 2", "Lock = 2", "tasks.0.operations", "did you mean 'Look'?"),
        ('["pump"]', '["plump"]', "driver_tasks", "did you mean 'pump'?"),
        ('["pump"]', '"pump"', "driver_tasks", "expected a list of names"),
        ('unit = "us"', 'unit = "ticks"', "driver_costs", "not in 'ticks'"),
        ("costs.json", "cost.json", "driver_costs", "cannot be read"),
        ("costs.json", "set.toml", "driver_costs", "is not a table of driver costs"),
        ('driver_costs = "costs.json"\n', "", "driver_costs", "is missing"),
        ("Look = 2", "Look = -2", "tasks.0.operations.Look", "expected a whole number"),
    ],
)
def test_errors_name_the_field(
    tmp_path: Path, before: str, after: str, place: str, problem: str
) -> None:
    """And say what to do."""
    with pytest.raises(ProjectFileError) as caught:
        read_task_file(written(tmp_path, SET.replace(before, after)))
    assert problem in str(caught.value)
    assert place.replace(".0.", "[0].") in str(caught.value) or place in str(caught.value)
