# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Calls of the alarm that release nobody."""

from __future__ import annotations

import pytest

from ravenbrick.schedule.model import Overheads
from ravenbrick.timing.task_set.alarm import COARSE_ALARM, AlarmCosts, coarse_alarm, exact_cycles

# 65 000 counts of 1024 master clock cycles (48 054 857 Hz), by hand: 1.385 s.
LONGEST_US = 1_385_083
SHORTEST_US = 2_663


@pytest.mark.parametrize(
    ("periods_us", "calls"),
    [
        ([], 1),
        ([LONGEST_US + 1], 1),
        ([LONGEST_US + 1, LONGEST_US - 1], 0),
        ([4_000], 0),
    ],
)
def test_the_alarm_calls_between_releases_that_are_further_apart_than_a_stretch(
    periods_us: list[int], calls: int
) -> None:
    """At most once in the shortest stretch; a task that is released within the longest sets it."""
    found = coarse_alarm(periods_us, 700, 31)
    assert len(found) == calls
    for call in found:
        assert (call.name, call.wcet, call.priority) == (COARSE_ALARM, 700, 31)
        assert call.release == "interrupt" and call.period == exact_cycles(SHORTEST_US)


def test_a_release_is_charged_the_call_that_may_come_shortly_before() -> None:
    """Its own, that of each further thread, and the early one at most once in a stretch."""

    class Kernel:
        resume, release_jitter = 150, 16

    found = AlarmCosts(900, 300, 500).overheads(Kernel())  # type: ignore[arg-type]
    assert found == Overheads(
        switch_in=150, alarm=900, alarm_further=300, alarm_early=500,
        alarm_early_period=exact_cycles(SHORTEST_US), clock_resolution=16,
    )  # fmt: skip
