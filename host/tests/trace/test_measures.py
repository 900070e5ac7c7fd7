# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Measures of a run against paths, steps and screens whose values are known by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from verification.support.recordings import preempted

from ravenbrick.errors import RunFaultError, ScenarioError
from ravenbrick.project.criteria import parse_expectation
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import (
    Criterion,
    Scenario,
    StraightDrive,
    read_scenario,
    scenario_path,
)
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.trace.measures import check_survival, evaluate_criteria, measure_run
from ravenbrick.trace.recording import Picture, Recording, Screen, Signal, Stop
from ravenbrick.trace.verdict import Verdict, judge

MS = 48_055


@pytest.fixture
def scenario(robot: Robot, project: Path) -> Scenario:
    """The vehicle's drive with a straight of 2 m from 10 ms on."""
    read = read_scenario(scenario_path(project, "drive"), robot)
    return replace(read, straight=StraightDrive(10, 2.0), step=None)


def driven(points: list[tuple[float, float, float]]) -> Recording:
    """A recording of x, y and heading, one point each 10 ms, without tasks."""
    cycles = np.arange(len(points), dtype=np.uint64) * np.uint64(10 * MS)
    columns = zip(("body.x", "body.y", "body.heading"), np.array(points).T, strict=True)
    made = preempted()
    return replace(
        made,
        events=made.events[:0],
        threads=(),
        inputs=(),
        stop=replace(made.stop, reason="reached", at_cycles=10 * MS * len(points)),
        signals={name: Signal(cycles, column) for name, column in columns},
    )


def test_the_distance_is_the_whole_path_and_the_deviation_that_of_the_straight(
    robot: Robot, scenario: Scenario
) -> None:
    """By hand: 1 m before the straight, 2 m along it with a bulge of 0.1 m, then 3 m steered."""
    points = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.1, 0.0), (3.0, 0.0, 0.0), (3.0, 3.0, 0.0)]
    recording = driven(points)
    steered = replace(recording, inputs=(TimedInput(35 * MS, "motor.A.hand_angle", 0.5),))
    measures = measure_run(robot, scenario, steered)
    along = 2 * float(np.hypot(1.0, 0.1))
    assert measures.value("distance") == pytest.approx(1.0 + along + 3.0)
    assert measures.value("lateral_deviation") == pytest.approx(0.1)
    none = measure_run(robot, replace(scenario, straight=None), steered)
    assert none.value("distance") is None and none.value("lateral_deviation") is None


def test_a_hand_that_holds_still_does_not_end_the_straight(
    robot: Robot, scenario: Scenario
) -> None:
    """An angle of zero turns nothing; only the first other one does."""
    points = [(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, 0.2, 0.0), (2.0, 0.0, 0.0), (3.0, 0.0, 0.0)]
    held = (TimedInput(15 * MS, "motor.A.hand_angle", 0.0),)
    measures = measure_run(robot, scenario, replace(driven(points), inputs=held))
    assert measures.value("lateral_deviation") == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("minimum", "maximum", "label"),
    [
        (10.0, None, "distance at least 10"),
        (None, 2.5, "distance at most 2.5"),
        (float("inf"), None, "distance at least inf"),
        (10.0, 12.5, "distance at least 10 and at most 12.5"),
    ],
)
def test_a_criterion_says_its_bounds(
    robot: Robot, scenario: Scenario, minimum: float | None, maximum: float | None, label: str
) -> None:
    """In the label of the report and in the sentence about a miss."""
    bounded = replace(scenario, criteria=(Criterion("distance", minimum, maximum, 0),))
    recording = driven([(0.0, 0.0, 0.0), (1.5, 0.0, 0.0), (3.0, 0.0, 0.0)])
    (result,) = evaluate_criteria(bounded, measure_run(robot, bounded, recording))
    assert not result.met and result.label == label
    assert f": distance is 3, expected {label[9:]}; look at" in result.sentence


def shown(robot: Robot, scenario: Scenario, text: str) -> Verdict:
    """A sentence about a display with two lines at 1 ms and another picture at 3 ms."""
    screens = (Screen(MS, ("speed  12", "ready")), Screen(3 * MS, ("speed  15", "")))
    made = replace(preempted(), screens=screens)
    return judge(
        parse_expectation(text, "here"), measure_run(robot, replace(scenario, straight=None), made)
    )


def test_what_the_display_shows_is_the_line_with_the_text_and_its_instant(
    robot: Robot, scenario: Scenario
) -> None:
    """Blanks count as one; the line is found wherever it stands, and so is what was there last."""
    found = shown(robot, scenario, 'lcd shows "speed 15"')
    assert (found.met, found.value) == (True, "speed 15")
    assert found.at == pytest.approx(0.003, abs=1e-6)
    assert shown(robot, scenario, 'lcd shows "12"').value == "speed 12"
    never = shown(robot, scenario, 'lcd never shows "ready"')
    assert (never.met, never.value) == (False, "ready")
    missed = shown(robot, scenario, 'lcd shows "stopped"')
    assert (missed.met, missed.value) == (False, "speed 15")
    assert shown(robot, scenario, 'lcd never shows "stopped"').met


@pytest.mark.parametrize("reason", ["fault", "halted"])
def test_a_program_that_failed_or_overflowed_a_stack_did_not_survive(
    scenario: Scenario, reason: str
) -> None:
    """Unless a fault was expected; a stack that overflowed counts in any run."""
    undisturbed = replace(scenario, inputs=(), stimuli=(), expectations=())
    shown = Picture(200_000, np.zeros((64, 100), bool), ("ready", ""))
    lived = replace(preempted(), stop=Stop("reached", 200_000, ""), pictures=(shown,))
    failed = replace(lived, stop=Stop(reason, 200_000, "tasks.adb:54"))
    check_survival(undisturbed, lived)
    for recording in (failed, replace(lived, overflows=("the stack of worker overflowed",))):
        with pytest.raises(RunFaultError, match=r"tasks\.adb:54|the stack of worker") as caught:
            check_survival(undisturbed, recording)
        assert caught.value.detail is not None and "ready" in caught.value.detail
    expected = replace(undisturbed, expectations=(parse_expectation("a fault", "here"),))
    check_survival(expected, failed)


def test_an_input_after_the_power_went_off_never_happens(scenario: Scenario) -> None:
    """In the scenario, with its instant, or in a stimulus; at the last cycle it does."""
    undisturbed = replace(scenario, inputs=(), stimuli=(), expectations=())
    off = replace(preempted(), stop=Stop("power_off", 10 * MS, ""))
    check_survival(
        replace(undisturbed, stimuli=(TimedInput(10 * MS, "touch.1", 1.0, "a.csv:3"),)), off
    )
    late = replace(undisturbed, stimuli=(TimedInput(10 * MS + 1, "touch.1", 1.0, "a.csv:3"),))
    with pytest.raises(ScenarioError, match=r"a.csv:3: 'touch.1' at 0.010000 s never happens"):
        check_survival(late, off)
    first = scenario.inputs[0]
    with pytest.raises(ScenarioError, match=r"at 11 ms never happens: .* off at 10.0 ms"):
        check_survival(replace(undisturbed, inputs=(replace(first, at_ms=11),)), off)
