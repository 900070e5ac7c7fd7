# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program with timing events: handlers bounded, counted as interference, never exceeded."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path

import pytest

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.timing.programs import Subject, analysed, subject

from ravenbrick.schedule.response_time import response_time_bounds
from ravenbrick.schedule.task_file import read_task_file
from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.observation.observed import check_event_rates, exceeded, observe
from ravenbrick.timing.results.task_set_file import task_set_text
from ravenbrick.timing.task_set.events import event_count


@pytest.fixture(scope="module")
def program() -> Subject:
    return subject("events", "expiring_load")


@pytest.fixture(scope="module")
def analysis(program: Subject) -> Analysis:
    return analysed(program, program.facts)


def test_responses_between_timing_events_stay_below_their_bounds(
    program: Subject, analysis: Analysis
) -> None:
    recording = program.run()
    check_event_rates(program.robot, program.facts, recording)
    seen = observe(program.robot, recording)
    assert set(seen) == {"control", "server", "display"}
    assert seen["control"].jobs > 400 and exceeded(analysis, seen) == []
    assert analysis.schedulable


def test_expiries_are_interference_of_every_task(program: Subject, analysis: Analysis) -> None:
    assert event_count(program.image) == 2
    beat, expire = analysis.events
    assert (beat.name, expire.name) == ("Workers.Bell.Beat", "Workers.Bell.Expire")
    assert beat.cycles > expire.cycles > analysis.overheads.alarm
    for name in ("control", "server", "display"):
        terms = analysis.bounds[name].terms
        assert terms is not None
        met = {part.task: part.time for part in terms.interference}
        assert met[beat.name] >= beat.cycles and met[expire.name] >= expire.cycles


def test_the_analysed_task_set_is_a_file_that_gives_the_same_bounds(
    analysis: Analysis, tmp_path: Path
) -> None:
    path = tmp_path / "taskset.toml"
    path.write_text(task_set_text("events", analysis.task_set, analysis.overheads))
    read = read_task_file(path)
    again = {b.task.name: b.bound for b in response_time_bounds(read.task_set, read.overheads)}
    assert again == {name: found.bound for name, found in analysis.bounds.items()}


def test_a_handler_without_a_rate_is_asked_for_by_file_and_line(program: Subject) -> None:
    without = replace(program.facts, events=program.facts.events[1:])
    with pytest.raises(ExecutionTimeError) as refused:
        analysed(program, without)
    asked = str(refused.value)
    assert asked.startswith("workers.adb:") and "is Workers.Bell.Beat the handler" in asked
    assert '[[timing_event]] handler = "Workers.Bell.Beat", at_most = ..., window_us' in asked


def test_events_that_come_more_often_than_is_said_are_an_error(program: Subject) -> None:
    rare = tuple(replace(load, window_us=2 * load.window_us) for load in program.facts.events)
    with pytest.raises(ExecutionTimeError, match="expire more than 17 times in 50000 us"):
        check_event_rates(program.robot, replace(program.facts, events=rare), program.run())
