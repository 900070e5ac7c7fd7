# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Variants of a scenario and statistics of long runs; no brick runs here."""

from __future__ import annotations

import random
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from verification.support.projects import VEHICLE
from verification.support.recordings import preempted

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import MonitorWindow, Scenario, read_scenario, scenario_path
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.telemetry.frames import LONGEST_CONTENT, FrameReader, frame
from ravenbrick.timing.observation.long_run import BIN_CYCLES, Spread
from ravenbrick.timing.observation.worst_case_search import (
    CHATTER,
    EXCEEDED,
    LINK_PERIOD_US,
    STUCK,
    SUBNORMAL,
    WORDS,
    WorstSample,
    _aimed,
    _nearly_wrong,
    _VariantRunner,
)
from ravenbrick.trace.flow_counts import FlowCount, arrivals_of
from ravenbrick.trace.recording import Recording


class Target:
    """Remembers the scenarios that are run with what runs beside them."""

    def __init__(self) -> None:
        self.whole: list[Scenario] = []

    def prepare(self, _robot: object, _scenario: Scenario, _image: object) -> Any:
        """A brick that takes every input and shows nothing."""
        return SimpleNamespace(
            schedule_input=lambda *_input: None,
            run_until=lambda _end: None,
            threads=list,
            flow_counts=lambda: "[]",
            flow_arrivals=list,
            events=lambda: b"",
        )

    def run(self, _robot: object, scenario: Scenario, _image: object) -> Recording:
        """The whole run."""
        self.whole.append(scenario)
        return preempted()


@pytest.mark.parametrize("word", range(len(WORDS)))
def test_a_monitor_says_a_word_again_and_again_when_its_input_tells_it(word: int) -> None:
    """Without monitor and peer the brick alone is played, which is faster."""
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, "step"), robot)
    alone = replace(scenario, monitor=None, peer=None)
    inputs = (TimedInput(MASTER_CLOCK.cycles_of_ms(7), CHATTER, float(word)),)
    target: Any = Target()
    image: Any = None
    _VariantRunner(robot, alone, image, target, ()).play(())
    assert target.whole == []
    watched = replace(alone, monitor=MonitorWindow("1234", 0, None))
    _VariantRunner(robot, watched, image, target, ()).play(inputs)
    (run,) = target.whole
    ((at_ms, said),) = run.monitor.chatter
    assert at_ms in (6, 7) and run.stimuli == ()
    assert said == WORDS[word] * (len(said) // len(WORDS[word])) and len(said) > 250


def test_the_link_is_lost_before_the_longest_job_or_a_release_of_its_task_in_it() -> None:
    """A job of two periods of the link has three such releases, and two come while the picture that
    it shows is sent; each is met by some variant."""
    us = MASTER_CLOCK.cycles_of_us
    kept = TimedInput(5, "touch.1", 1.0)
    sample = WorstSample("t", 2 * us(LINK_PERIOD_US) + 7, 0, (kept,), us(50_000))
    met = set()
    for seed in range(60):
        own, held, back = _aimed(sample, 22_000, us(100_000), random.Random(seed))
        assert (own, held.name, held.value, back.name, back.value) == (kept, STUCK, 1, STUCK, 0)
        since = back.at_cycles + us(22_000) - sample.release_cycles
        number, late = divmod(since, us(LINK_PERIOD_US))
        assert 0 < late < us(200)
        assert us(1_600) <= back.at_cycles - late - held.at_cycles < us(1_950)
        met.add(number)
    assert met == {0, 1, 2, 3, 4}


def test_the_longest_word_is_as_long_as_a_frame_that_the_reader_takes() -> None:
    """One byte more, and the reader drops it before the end without a look at its check value."""
    longest = frame(bytes(LONGEST_CONTENT))
    assert max(len(word) for word in WORDS if word != SUBNORMAL) == len(longest)
    reader = FrameReader()
    assert list(reader.feed(WORDS[0])) == [] and list(reader.feed(longest)) != []


def test_only_a_disturbed_variant_changes_parameters_to_the_least_number() -> None:
    """A mode may exclude subnormal operands; it is observed in the others."""
    robot = read_robot(VEHICLE)
    scenario = read_scenario(scenario_path(VEHICLE, "step"), robot)
    watched = replace(scenario, monitor=MonitorWindow("1234", 0, None), peer=None)
    target: Any = Target()
    image: Any = None
    runner = _VariantRunner(robot, watched, image, target, ())
    sample = WorstSample("t", 1, 0, (), MASTER_CLOCK.cycles_of_ms(50))
    said: dict[bool, set[float]] = {False: set(), True: set()}
    for seed in range(40):
        for disturbed, found in said.items():
            inputs = runner.vary((), disturbed, random.Random(seed))
            found |= {timed.value for timed in inputs if timed.name == CHATTER}
    word = float(WORDS.index(SUBNORMAL))
    assert said == {False: set(map(float, range(len(WORDS)))) - {word}, True: said[False] | {word}}
    aimed = [runner.disturb(sample, 0, random.Random(seed)) for seed in range(40)]
    chatter = [timed for inputs in aimed for timed in inputs if timed.name == CHATTER]
    assert {timed.value for timed in chatter} == {word}
    assert max(timed.at_cycles for timed in chatter) < sample.release_cycles


def test_facts_of_modes_are_told_apart_by_their_numbers() -> None:
    counts = [FlowCount(most, 0, arrivals_of(bytes(24 * n))) for most, n in ((3, 0), (5, 2))]
    assert _nearly_wrong({1: counts[1]}) == {"fact 1": (5, 0), f"fact 1{EXCEEDED}": (2, 0)}
    assert _nearly_wrong(dict(enumerate(counts)))["fact 0"] == (3, 0)


def test_a_spread_has_the_values_of_all_pieces() -> None:
    spread = Spread()
    for piece in ([10, 4 * BIN_CYCLES], [], [21]):
        spread.add(np.array(piece, np.int64))
    found = spread.plain()
    assert (found["count"], found["min"], found["max"]) == (3, 10, 4 * BIN_CYCLES)
    assert found["mean"] == (31 + 4 * BIN_CYCLES) / 3
    assert found["bins"] == [[0, 2], [4 * BIN_CYCLES, 1]]
