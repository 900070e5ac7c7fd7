# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A main procedure that goes on beside the tasks: accepted below all of them, with what it holds
and what its waits cost in the bounds; a task that it never lets run misses its deadline."""

from __future__ import annotations

import importlib.util
from dataclasses import replace

import pytest

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.timing.programs import Subject, analysed, subject

from ravenbrick.timing.analysis import Analysis, known_facts
from ravenbrick.timing.bounds import ExecutionTimeError, stack_bounds
from ravenbrick.timing.observation.observed import exceeded, observe, used_stacks
from ravenbrick.timing.results.result import advice, result_of
from ravenbrick.timing.results.stacks import check_stacks, stacks_of
from ravenbrick.timing.task_set.background import main_symbol
from ravenbrick.timing.task_set.scheduled_tasks import PREEMPTION_BYTES

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
    result = result_of(analysis, seen, margins=False)
    assert result["schedulable"] and result["misses"] == []
    (thread,) = result["background"]
    assert thread["name"] == "environment" and thread["stack_bound_bytes"] is not None
    first, last = result["scope"]
    assert "has neither a deadline nor a response bound" in first
    assert last == "the stack bound of environment covers start-up, elaboration and main procedure"
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
        ("equal_main", ["display (priority 10)"]),
        ("urgent_main", ["control (priority 12)", "display (priority 10)"]),
    ],
)
def test_tasks_below_a_main_procedure_that_never_waits_miss_their_deadlines(
    main: str, delayed: list[str]
) -> None:
    """The verdict needs no fact, and the run shows no job of theirs."""
    program, analysis = _analysed(main)
    seen = observe(program.robot, program.run())
    assert exceeded(analysis, seen) == []
    result = result_of(analysis, seen, margins=False)
    names = [words.split()[0] for words in delayed]
    assert not result["schedulable"] and [miss["name"] for miss in result["misses"]] == names
    (words,) = advice(result)
    assert "stays in the loop at workers.adb:44 for ever" in words and ", ".join(delayed) in words
    assert not set(names) & set(seen)


def test_a_job_of_a_task_that_should_never_run_again_is_told() -> None:
    _, analysis = _analysed("equal_main")
    idle, _ = _analysed("idle_main")
    seen = observe(idle.robot, idle.run())
    (words,) = (text for text in exceeded(analysis, seen) if "never waits" in text)
    assert words.startswith("display completed ")


def test_a_main_procedure_that_waits_and_is_as_urgent_as_a_task_is_refused() -> None:
    program = subject(FOLDER, "equal_waiting_main")
    text = r"priority 10 .*: display \(priority 10\);.*robot.toml as the task 'environment'"
    with pytest.raises(ExecutionTimeError, match=text):
        analysed(program, program.facts)


def test_the_stack_bound_of_a_background_main_covers_the_elaboration() -> None:
    """A bound of the main procedure alone lies below what the program uses before it."""
    program, analysis = _analysed("idle_main")
    recording = program.run()
    used = used_stacks(recording)
    stacks = {each["name"]: each for each in stacks_of(analysis, used)}
    whole = stacks["environment"]
    _, annotations = known_facts(program.robot, program.image, program.facts)
    (alone,) = stack_bounds(program.image.content, [main_symbol(program.image)], annotations)
    assert alone.bytes is not None and whole["verdict"] == "suffices"
    assert alone.bytes + PREEMPTION_BYTES < whole["used_bytes"] <= whole["bound_bytes"]
    check_stacks(stacks_of(analysis, used))
    of_main = replace(analysis.environment, bound=alone)
    wrong = replace(analysis, background=analysis.background.with_stacks(of_main))
    with pytest.raises(ExecutionTimeError, match=r"environment showed a stack of \d+, above its"):
        check_stacks(stacks_of(wrong, used))
