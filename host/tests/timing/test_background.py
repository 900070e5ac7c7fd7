# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A main procedure that goes on beside the tasks: accepted below all of them, with what it holds
and what its waits cost in the bounds; refused where it would keep one from running."""

from __future__ import annotations

import importlib.util

import pytest

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.timing.programs import Subject, analysed, subject

from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.observation.observed import exceeded, observe
from ravenbrick.timing.results.result import result_of

FOLDER = "background"
# More than a masked service of the run-time takes.
SERVICE_CYCLES = 1_000


def _analysed(main: str) -> tuple[Subject, Analysis]:
    program = subject(FOLDER, main)
    return program, analysed(program, program.facts)


@pytest.mark.parametrize(
    "main", ["idle_main", "computing_main", "holding_main", "waiting_main", "two_loops_main"]
)
def test_no_response_beside_a_background_main_exceeds_its_bound(main: str) -> None:
    program, analysis = _analysed(main)
    seen = observe(program.robot, program.run())
    assert set(seen) == {"control", "display"} and exceeded(analysis, seen) == []
    result = result_of(analysis, seen)
    assert result["schedulable"] and result["misses"] == []
    (thread,) = result["background"]
    assert thread["name"] == "environment" and thread["stack_bound_bytes"] is not None
    for task in result["tasks"]:
        assert task["observed"]["jobs"] > 300
        assert task["response_bound_cycles"] < 1.5 * task["observed"]["response_cycles"]


def test_an_endless_loop_that_holds_nothing_delays_nobody() -> None:
    """Blocking is what tasks do to each other."""
    for main in ("idle_main", "computing_main"):
        _, analysis = _analysed(main)
        for timing in analysis.tasks:
            assert timing.blocking.cycles < SERVICE_CYCLES


def test_a_protected_object_that_the_main_procedure_holds_blocks_the_tasks() -> None:
    """The bound would not hold without it."""
    program, analysis = _analysed("holding_main")
    control = next(t for t in analysis.tasks if t.task.name == "control")
    assert control.blocking.task == "environment"
    assert control.blocking.kind.startswith("protected action")
    seen = observe(program.robot, program.run())["control"]
    bound = analysis.bounds["control"].bound
    assert bound is not None
    assert bound - control.blocking.cycles < seen.response_cycles <= bound


def test_a_wait_of_the_main_procedure_calls_the_alarm_once_in_a_busy_period() -> None:
    _, analysis = _analysed("waiting_main")
    display = next(t for t in analysis.tasks if t.task.name == "display")
    assert "the alarm called once for environment" in display.blocking.kind
    assert display.blocking.cycles >= analysis.overheads.alarm


@pytest.mark.parametrize(
    ("main", "delayed"),
    [
        ("equal_main", r"priority 10 .*: display \(priority 10\);"),
        ("urgent_main", r"priority 20 .*: control \(priority 12\), display \(priority 10\);"),
    ],
)
def test_a_main_procedure_that_keeps_a_task_from_running_is_refused(
    main: str, delayed: str
) -> None:
    program = subject(FOLDER, main)
    with pytest.raises(ExecutionTimeError, match=delayed):
        analysed(program, program.facts)
