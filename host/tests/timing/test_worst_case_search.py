# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Which variants of a scenario are played how; no brick runs here."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from verification.support.projects import VEHICLE
from verification.support.recordings import preempted

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import MonitorWindow, Scenario, read_scenario, scenario_path
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.timing.observation.worst_case_search import CHATTER, WORDS, _VariantRunner
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
