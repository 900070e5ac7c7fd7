# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from verification.support.recordings import preempted

from ravenbrick.catalogue import sensor_kinds
from ravenbrick.errors import ProjectFileError, ScenarioError, UsageError
from ravenbrick.project.criteria import (
    ExpectationSyntaxError,
    expected_pins,
    parse_expectation,
)
from ravenbrick.project.criteria_file import read_expectations_of
from ravenbrick.project.robot import Task
from ravenbrick.trace.recording import Recording, Screen, Signal, Stop
from ravenbrick.trace.schedule import task_plan
from ravenbrick.trace.verdict import Verdict, judge

MADE = preempted()
# A pin that is high from 0.83 ms to 2.08 ms.
PIN_17 = Signal(np.array([0, 40_000, 100_000], np.uint64), np.array([0.0, 1.0, 0.0]))
RECORDING = replace(MADE, signals={**MADE.signals, "pin.17": PIN_17})


class Measured:
    """Measures of a recording with a deadline of its urgent task."""

    def __init__(self, recording: Recording, deadline_us: int = 1000) -> None:
        task = Task("urgent", "", "cyclic", 2000, deadline_us, 5, 1024)
        self.native = recording.native.measure(json.dumps({"tasks": task_plan([task])}))


def verdict(text: str, recording: Recording = RECORDING, deadline_us: int = 1000) -> Verdict:
    """Judge one sentence."""
    return judge(parse_expectation(text, "here"), Measured(recording, deadline_us))


# Speeds: 0 at 0 ms, then 8.2, 8.9, 8.5 and 1/3 rad/s at each ms; off after 4.16 ms.
MET = [
    "motor.B.angular_velocity between 8 and 9 rad/s from 1.1 ms to 3.9 ms",
    "motor.B.angular_velocity between 469 and 510 deg/s from 0.002 s to 3 ms",
    "motor.B.angular_velocity ever at least 8.9",
    "motor.B.angular_velocity at most 0.4 rad/s at the end",
    "motor.B.angular_velocity at least 8.89 rad/s at 2.9 ms",
    "motor.B.angular_velocity at most 8.9 rad/s",
    "body.x at least 39 cm after 4.1 ms",
    "probe.late at least 5",
    "pin 17 high from 1 ms to 2 ms",
    "pin 17 ever low",
    "pin 17 low after 2.1 ms",
    'lcd shows "closed loop"',
    'lcd shows "set 4.79" at 2 ms',
    'lcd never shows "open loop"',
    'lcd never shows "closed" before 1 ms',
    "deadlines met",
    "deadlines met for URGENT",
    "response time of urgent at most 42 us",
    "path ends within 1 mm of (0.4, 0.1)",
    "path ends within 1 cm of (40, 10) cm",
    "no fault",
    "powered off",
    "powered off before 5 ms",
    "cpu_utilization between 1 and 10 %",
]
NOT_MET = [
    ("motor.B.angular_velocity between 8 and 9 rad/s from 0.5 ms to 3 ms", 0.0),
    ("motor.B.angular_velocity at least 8.3 from 1.5 ms to 2.5 ms", 8.2),
    ("motor.B.angular_velocity ever at least 9", 8.9),
    ("motor.B.angular_velocity between 8 and 9 rad/s", 0.0),
    ("pin 17 high from 1 ms to 3 ms", 0.0),
    ("pin 17 ever low from 1 ms to 2 ms", 1.0),
    ("body.x at most 30 cm at the end", 40.0),
    ('lcd shows "open loop"', "closed loop / set 4.79"),
    ('lcd shows "closed" at 1 ms', None),
    ('lcd never shows "closed  loop"', "closed loop"),
    ("response time of urgent at most 41 us", pytest.approx(2000 / 48_054_857.14)),
    ("path ends within 10 cm of (0.4, 0.3)", "(0.4000, 0.1000) m, 0.2000 m off"),
    ("a fault", "no fault"),
    ("powered off before 4 ms", "power off"),
    ("powered off after 4.17 ms", "power off"),
]


@pytest.mark.parametrize("text", MET)
def test_what_the_run_shows_is_met(text: str) -> None:
    """Each form of sentence about the made run holds."""
    assert verdict(text).met, verdict(text).sentence


@pytest.mark.parametrize(("text", "value"), NOT_MET)
def test_what_the_run_does_not_show_is_not_met(text: str, value: object) -> None:
    """The value that decided is reported in the written unit."""
    found = verdict(text)
    assert not found.met
    assert found.value == value
    assert text.replace("  ", " ")[:20] in found.sentence


def test_the_pins_that_are_spoken_of_are_found() -> None:
    """In either form; a number that is not a pin is no signal of a run."""
    texts = ["pin 31 high", "pin.4 at least 1", "pin 4 ever low", "pin.32 at least 1", "no fault"]
    assert expected_pins(parse_expectation(text, "here") for text in texts) == [4, 31]


def test_a_bound_on_a_sensor_s_input_may_have_its_unit() -> None:
    """Each unit of the catalogue is one of the sentences; 10 cm are 0.1 m."""
    for kind in sensor_kinds().values():
        for one in kind.inputs:
            sentence = f"{one.name.replace('{port}', '2')} at most 10 {one.unit}".strip()
            assert parse_expectation(sentence, "here").text == sentence
    near = Signal(np.array([0, 40_000], np.uint64), np.array([0.11, 0.09]))
    found = verdict("distance.1 at least 10 cm", replace(MADE, signals={"distance.1": near}))
    assert not found.met and found.value == pytest.approx(9.0)


def test_a_missed_deadline_is_counted() -> None:
    """Two jobs, of which the second takes 2000 cycles: 41.6 microseconds."""
    assert verdict("deadlines met", deadline_us=41).value == 1.0
    assert verdict("deadlines met", deadline_us=42).met


def test_a_fault_can_be_what_is_expected() -> None:
    """The text may be on the LCD or in the sentence of the fault."""
    crashed = replace(
        RECORDING,
        stop=Stop("halted", 200_000, "the processor stopped"),
        screens=(*RECORDING.screens, Screen(100_000, ("vehicle.adb:12", "range check"))),
    )
    assert verdict('a fault saying "vehicle.adb:12"', crashed).met
    assert verdict("a fault", crashed).met
    assert not verdict('a fault saying "vehicle.adb:13"', crashed).met
    assert not verdict("no fault", crashed).met


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("motor.D.angle at least 1", "'motor.D.angle' was not recorded; recorded: body.x"),
        ("body.x at least 1 m at 9 s", "9 s never comes: the run ended after 0.00416"),
        ("deadlines met for idle", "no task 'idle'; the image has: urgent, worker"),
        ("deadlines met for worker", "no deadline is known"),
        ("settling_time at most 1", "was never reached in the run"),
        ("powered off after 9 s", None),
    ],
)
def test_what_can_never_be_seen_is_unreachable(text: str, problem: str | None) -> None:
    """Exit code 9, not a failed criterion; switching off later is simply not met."""
    if problem is None:
        assert not verdict(text).met
        return
    with pytest.raises(ScenarioError, match="here: ") as caught:
        verdict(text)
    assert problem in caught.value.sentence
    assert caught.value.exit_code == 9


def test_an_lcd_without_letters_is_unreachable() -> None:
    """A text cannot be looked for in a picture that cannot be read."""
    with pytest.raises(ScenarioError, match="LCD cannot be read"):
        verdict('lcd shows "x"', replace(RECORDING, screens=(Screen(5, ()),)))


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("the robot is fast", "is not an expectation; the forms are: <signal>"),
        ("body.x between 3 and 2 m", "nothing lies between 3 and 2"),
        ("body.x at least 2 rad/s", "is in m, not rad/s; write the bound in m"),
        ("body.x at least 2 m from 3 s to 3 s", "is empty; name the earlier time first"),
        ("deadlines met at 3 s", "is of the whole run; leave the time out"),
        ('no fault saying "x"', "leave 'saying' out"),
        ('lcd shows ""', "is not an expectation"),
    ],
)
def test_a_sentence_that_makes_no_sense_says_why(text: str, problem: str) -> None:
    """The user learns what to write."""
    with pytest.raises(ExpectationSyntaxError) as caught:
        parse_expectation(text, "here")
    assert problem in str(caught.value)


def test_a_file_of_sentences_names_the_wrong_line(tmp_path: Path) -> None:
    """Comments and empty lines count as lines."""
    file = tmp_path / "grade.txt"
    file.write_text('# grader\n\nno fault\nlcd shows "x"\n')
    assert [e.place for e in read_expectations_of(str(file))] == [f"{file}:3", f"{file}:4"]
    file.write_text("no fault\nno clue\n")
    with pytest.raises(ProjectFileError, match=r"grade\.txt:2: 'no clue' is not an expectation"):
        read_expectations_of(str(file))


def test_a_toml_file_of_criteria_names_the_wrong_line(tmp_path: Path) -> None:
    """The form is that of the scenarios."""
    file = tmp_path / "grade.toml"
    file.write_text('[[criteria]]\nexpect = "no fault"\n')
    assert [e.text for e in read_expectations_of(str(file))] == ["no fault"]
    file.write_text('[[criteria]]\nexpect = "no fault"\n[[criteria]]\nexpect = "no clue"\n')
    with pytest.raises(ProjectFileError, match=r"grade\.toml:4: criteria\[1\]\.expect"):
        read_expectations_of(str(file))
    file.write_text('[[criteria]]\nmeasure = "distance"\n')
    with pytest.raises(ProjectFileError, match="expected the one field 'expect'"):
        read_expectations_of(str(file))


def test_a_file_that_is_not_there_is_not_taken_for_a_sentence() -> None:
    """A mistyped file name is a usage error that names it."""
    with pytest.raises(UsageError, match=r"absent\.toml: there is no such file"):
        read_expectations_of("absent.toml")


def test_the_verdict_is_plain_json() -> None:
    """Graders get expectation, value, unit, instant and verdict."""
    assert verdict("body.x ever at least 20 cm").as_json() == {
        "expectation": "body.x ever at least 20 cm",
        "value": 40.0,
        "unit": "cm",
        "at": pytest.approx(0.004, abs=1e-5),
        "met": True,
    }


def test_every_sentence_of_the_reference_is_understood() -> None:
    """The examples in the documentation can be typed as they are."""
    page = (Path(__file__).parents[3] / "docs" / "reference" / "trace.md").read_text()
    sentences = page.split("```text\n")[1].split("```")[0].splitlines()
    assert len(sentences) > 10
    for sentence in sentences:
        assert parse_expectation(sentence, "reference").text == sentence
