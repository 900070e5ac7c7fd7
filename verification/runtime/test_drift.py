# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A day of virtual time: the run-time's clock and a period of a second do not drift."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pytest
import virtual_brick

from verification.support.bricks.runtime_programs import (
    BENCH,
    CYCLES_PER_SECOND,
    UNITS_PER_SECOND,
    Run,
    build,
)

DAY_SECONDS = 86_400
CYCLES_PER_UNIT = 16 / 7
LATEST_CYCLES = 350
SIGNAL_PERIOD_CYCLES = 480_000_000

pytestmark = pytest.mark.long("24 hours on the brick")


@pytest.fixture(scope="module")
def day() -> Iterator[Run]:
    """The program after 24 hours."""
    configuration = json.dumps(BENCH | {"signal_period_cycles": SIGNAL_PERIOD_CYCLES})
    brick = virtual_brick.VirtualBrick(configuration, build("drift").read_bytes())
    yield Run(brick, brick.run_until(round((DAY_SECONDS + 0.5) * CYCLES_PER_SECOND)))


def test_every_second_of_the_day_has_its_job(day: Run) -> None:
    """86 400 releases, none lost, none doubled."""
    assert day.failure() is None
    assert day.brick.read_int("jobs", "u32") == DAY_SECONDS


def test_releases_are_whole_seconds_apart_to_the_cycle(day: Run) -> None:
    """The virtual brick counts cycles apart from the program's clock: the 32-bit count wraps 60
    times in a day, and the nominal releases stay where arithmetic puts them. A unit is 16/7 cycles,
    and a release is a whole cycle: compared in sevenths, all lie within the same cycle."""
    task = day.thread_index("release_lateness__seconds_task")
    releases = day.events("release", task)["value"][2:]
    assert len(releases) >= DAY_SECONDS - 1
    units = np.arange(2, 2 + len(releases), dtype=np.int64) * UNITS_PER_SECOND
    offsets_sevenths = 7 * releases.astype(np.int64) - 16 * units
    assert offsets_sevenths.max() - offsets_sevenths.min() < 7


def test_the_task_runs_as_soon_after_its_release_at_the_end_as_at_the_beginning(day: Run) -> None:
    """By the virtual brick's cycles for every job, by the program's own clock for the extremes."""
    index = day.thread_index("release_lateness__seconds_task")
    releases = day.events("release", index)["value"][2:].astype(np.int64)
    starts = day.events("thread_running", index)["at"].astype(np.int64)
    positions = np.searchsorted(starts, releases)
    latencies = starts[positions[positions < len(starts)]] - releases[positions < len(starts)]
    assert 0 < latencies.min() <= latencies.max() <= LATEST_CYCLES
    least, most = day.words("lateness", 2, "<i8")
    assert 0 <= least <= most <= LATEST_CYCLES / CYCLES_PER_UNIT
