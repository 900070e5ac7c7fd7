# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program with timing events: handlers bounded, counted as interference, never exceeded."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.timing.programs import Subject, analysed, subject

from ravenbrick.schedule.response_time import response_time_bounds
from ravenbrick.schedule.task_file import read_task_file
from ravenbrick.timing.analysis import Analysis, known_facts
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.kernel import expiry_facts
from ravenbrick.timing.observation.observed import check_event_rates, exceeded, observe
from ravenbrick.timing.results.task_set_file import task_set_text
from ravenbrick.timing.task_set.alarm import COARSE_PERIOD_US, alarm_costs
from ravenbrick.timing.task_set.events import EVENT_TYPE, _events_in, event_count


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


def test_the_alarm_calls_early_unless_a_task_comes_within_the_shortest_stretch(
    program: Subject, analysis: Analysis
) -> None:
    """Also where no task is cyclic."""
    handlers = [event.handler.symbol for event in analysis.events]
    _, known = known_facts(program.robot, program.image, program.facts, handlers)
    annotations = [expiry_facts(()), *known]
    early = [
        alarm_costs(program.image, analysis.interrupts[0], annotations, periods).early
        for periods in ([], [COARSE_PERIOD_US], [COARSE_PERIOD_US - 1])
    ]
    assert early[0] == early[1] > early[2] == 0


@pytest.mark.parametrize(
    ("bounds", "events"),
    [
        ([{"lower": 3, "upper": 5}], 3),
        ([{"upper": 4}], 4),  # Ada's arrays begin at 1 where nothing is said (DWARF 4, table 7.17)
        ([{"lower": 0, "upper": 0}], 1),
        ([{"lower": 2, "upper": 3}, {"upper": 5}], 10),
        ([{"lower": 1, "upper": [0x91, 0]}], 1),  # an expression: known when the program runs
    ],
)
def test_an_array_of_events_has_as_many_as_its_bounds_say(
    bounds: list[dict[str, Any]], events: int
) -> None:
    def die(tag: str, attributes: dict[str, Any], *children: Any, of: Any = None) -> Any:
        named = {f"DW_AT_{name}": SimpleNamespace(value=v) for name, v in attributes.items()}
        return SimpleNamespace(
            tag=f"DW_TAG_{tag}",
            attributes=named,
            iter_children=lambda: iter(children),
            get_DIE_from_attribute=lambda _name: of,
        )

    one = die("structure_type", {"name": EVENT_TYPE.encode()})
    ends = [{f"{end}_bound": value for end, value in each.items()} for each in bounds]
    ranges = [die("subrange_type", each) for each in ends]
    assert _events_in(die("array_type", {"type": 0}, *ranges, of=one)) == events


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
