# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Clock, delays, periods and timing events."""

from __future__ import annotations

import math

import numpy as np
import pytest

from verification.support.bricks.runtime_programs import (
    CYCLES_PER_MS,
    CYCLES_PER_SECOND,
    IDLE,
    UNITS_PER_SECOND,
    Run,
    Runner,
    assert_repeats,
)


@pytest.fixture(scope="module")
def periodic(run: Runner) -> Run:
    """Four cyclic tasks for 2 s."""
    return run("periodic", cycles=2_000 * CYCLES_PER_MS)


def releases_and_starts(result: Run, symbol: str) -> list[tuple[int, int]]:
    """Nominal release and first selection of each job of a task after its first."""
    index = result.thread_index(symbol)
    starts = result.events("thread_running", index)["at"]
    releases = result.events("release", index)["value"][1:]
    positions = np.searchsorted(starts, releases)
    return [
        (int(release), int(starts[position]))
        for release, position in zip(releases, positions, strict=True)
        if position < len(starts)
    ]


def is_alone(result: Run, release: int) -> bool:
    """No other task has a release near, so that no handler or other release is in the way."""
    distances = np.abs(result.events("release")["value"] - release)
    return int((distances < 6_000).sum()) == 1


class TestTime:
    PERIODS_UNITS = (28_908, 42_048, 147_168, 1_051_200)
    TASKS = ("cyclic__one", "cyclic__two", "cyclic__three", "cyclic__four")

    def test_periods_do_not_drift(self, periodic: Run) -> None:
        """Each nominal release is the epoch plus a whole number of periods, exactly."""
        for task, period in zip(self.TASKS, self.PERIODS_UNITS, strict=True):
            releases = periodic.events("release", periodic.thread_index(task))["value"][1:]
            start = 5 * UNITS_PER_SECOND // 1_000
            assert len(releases) > 30
            cycles = [math.ceil((start + job * period) * 16 / 7) for job in range(len(releases))]
            epoch = int(releases[0]) - cycles[0]
            assert [int(release) - epoch for release in releases] == cycles

    def test_six_tasks_released_together_have_started_within_1800_cycles(self, run: Runner) -> None:
        """From the common release until the lowest runs; each higher one delays itself again."""
        result = run("six_tasks")
        jobs = [releases_and_starts(result, f"six__t{number}") for number in range(1, 7)]
        assert len(jobs[-1]) >= 15
        for round_of_six in list(zip(*jobs, strict=False))[1:]:
            starts = [start for _, start in round_of_six]
            assert len({release for release, _ in round_of_six}) == 1
            assert starts == sorted(starts)
            assert starts[-1] - round_of_six[0][0] <= 1_800

    def test_no_job_is_lost(self, periodic: Run) -> None:
        """Two seconds hold as many jobs as periods."""
        jobs = periodic.words("jobs", 4)
        for count, period in zip(jobs, self.PERIODS_UNITS, strict=True):
            assert count == (1_995 * UNITS_PER_SECOND // 1_000 - 10_000) // period + 1

    def test_a_task_never_wakes_up_early(self, periodic: Run) -> None:
        """The clock has always reached the wake-up time after a delay."""
        assert all(late >= 0 for late in periodic.words("lateness", 4, "<i4"))

    def test_a_task_that_wakes_up_alone_starts_within_320_cycles(self, periodic: Run) -> None:
        """From the nominal release to the switch, with the 16 cycles of the clock's tick."""
        latencies = [
            start - release
            for release, start in releases_and_starts(periodic, "cyclic__one")
            if is_alone(periodic, release)
        ]
        assert len(latencies) > 1_000
        assert min(latencies) > 0
        assert max(latencies) <= 320

    def test_waking_up_from_idle_varies_by_at_most_20_cycles_and_a_tick(
        self, periodic: Run
    ) -> None:
        """The processor is stopped before, so that only the phases of the counters vary."""
        running = periodic.events("thread_running")
        latencies = []
        for release, start in releases_and_starts(periodic, "cyclic__one"):
            before = running[running["at"] < start][-1]
            if before["subject"] == IDLE and is_alone(periodic, release):
                latencies.append(start - release)
        assert len(latencies) > 1_000
        assert max(latencies) - min(latencies) <= 20 + 16

    def test_the_idle_processor_stops(self, run: Runner) -> None:
        """With nothing to do for seconds, the alarm alone runs the processor, once in 1.4 s."""
        result = run("preemption", cycles=10 * round(CYCLES_PER_SECOND))
        wake_ups = result.events("processor_resumed")
        last_job = result.events("completion")["at"].max()
        assert len(wake_ups[wake_ups["at"] > last_job]) <= 10 / 1.384 + 1

    def test_timing_events_are_set_moved_and_cancelled(self, run: Runner) -> None:
        """In the past at once, else in the order of their times; a moved one once, later."""
        assert_repeats(run("timing_events").journal(), "rspors3c.n", 11)

    def test_a_timing_event_repeats_itself_without_drift(self, run: Runner) -> None:
        """Its handler sets it again, 400 us later each time, and is never 1 000 cycles late."""
        result = run("timing_events", cycles=103 * CYCLES_PER_MS)
        assert 248 <= result.brick.read_int("repeated", "u32") <= 251
        assert 0 < result.brick.read_int("latest", "i32") <= 1_000 * 7 / 16

    def test_the_clock_survives_the_wrap_of_the_counter(self, run: Runner) -> None:
        """The 32-bit count wraps at 1 430 s; readings every 100 s go on rising evenly."""
        result = run("long_run", cycles=round(2_050 * CYCLES_PER_SECOND))
        assert result.brick.read_int("jobs", "u32") == 20
        for index, reading in enumerate(result.words("readings", 20, "<i8"), start=1):
            assert 0 <= reading - index * 100 * UNITS_PER_SECOND <= 400
