# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The body of a task is the one that it begins to execute, whatever its name is."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.timing.programs import built, subject

from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.initial_state import elaborated, executed_bodies
from ravenbrick.timing.task_set.jobs import body_of
from ravenbrick.trace.flow_counts import ARRIVAL, NO_THREAD


def test_tasks_of_a_type_have_its_body() -> None:
    found, image = subject("counted", "counted_load"), built("periodic", "periodic_load")
    bodies = executed_bodies(elaborated(found.robot, found.scenario, image), image)
    assert bodies == {f"worker_{number}": "workers__workerTB" for number in range(1, 9)}


def test_what_a_task_executes_counts_and_its_name_if_it_has_not_begun() -> None:
    found = subject("counted", "counted_load")
    robot, image = found.robot, found.image
    bodies = executed_bodies(elaborated(robot, found.scenario, image), image)
    assert bodies == {"control": "workers__controlTKB", "listener": "workers__listenerTKB"}
    control = robot.tasks[0]
    assert body_of(image, {"control": "workers__listenerTKB"}, control) == "workers__listenerTKB"
    assert body_of(image, {}, control) == "workers__controlTKB"
    with pytest.raises(ExecutionTimeError, match="0 bodies with the name of the task 'late'"):
        body_of(image, {}, replace(control, name="late"))


def test_a_body_is_what_a_task_executes_first() -> None:
    """Not what it calls, whatever that is named."""
    arrivals = {
        "rooms__controlTKB": [(90, 1, 1, 0)],
        "setTB": [(20, 1, NO_THREAD, 0), (100, 1, 1, 0), (200, 1, 1, 0)],
    }
    threads = [SimpleNamespace(name="environment"), SimpleNamespace(name="Control")]
    brick = SimpleNamespace(
        threads=lambda: threads,
        flow_counts=lambda: json.dumps([{"most": 0, "dropped": 0} for _ in arrivals]),
        flow_arrivals=lambda: [np.array(each, ARRIVAL).tobytes() for each in arrivals.values()],
    )
    image: Any = SimpleNamespace(symbols=arrivals)
    assert executed_bodies(brick, image) == {"control": "rooms__controlTKB"}
