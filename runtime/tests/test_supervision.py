# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program whose tasks no longer meet their deadlines ends, as docs/guides/failures.md says."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.runtime_programs import (
    CYCLES_PER_MS,
    PROGRAMS,
    Run,
    Runner,
    is_in,
)

KINDS = (PROGRAMS / "supervised" / "watched.ads").read_text().split("(Nothing", 1)[1]
FAULTS = ["Nothing", *(name.strip() for name in KINDS.split(")", 1)[0].split(",")[1:])]
DEADLINE_MS = 5
CHECK_MS = 2
UNITS_PER_MS = 21_024
# Even for a cyclic task, odd for a sporadic one.
SWITCH = (
    "-Wl,--defsym=ravenbrick_supervised=1"
    f",--defsym=ravenbrick_deadline_12={DEADLINE_MS * UNITS_PER_MS}"
    f",--defsym=ravenbrick_deadline_14={DEADLINE_MS * UNITS_PER_MS + 1}"
)


Supervised = Callable[[str, int], Run]


@pytest.fixture
def supervised(run: Runner) -> Supervised:
    """Run the program with two tasks of 10 ms, of which one has the fault, for so many ms."""

    def run_fault(fault: str, ms: int) -> Run:
        options = (f"-XSUPERVISION={SWITCH}",)
        values = {"chosen": FAULTS.index(fault)}
        return run("supervised", ms * CYCLES_PER_MS, options=options, values=values)

    return run_fault


def ended(result: Run) -> tuple[str, str, float]:
    """Text and culprit of the failure, and the time in ms from the culprit's latest release."""
    text, _ = result.failure() or ("", 0)
    address = result.words("ravenbrick_failure", 3)[2]
    names = ("cyclic", "sporadic", "supervisor")
    culprit = next(name for name in names if is_in(result, f"watched__{name}", address))
    releases = result.events("release", result.thread_index(f"watched__{culprit}"))["value"]
    return text, culprit, (result.brick.cycles - int(releases[-1])) / CYCLES_PER_MS


@pytest.mark.parametrize("fault", ["Nothing", "Seldom_Late"])
def test_a_program_that_is_rarely_late_goes_on(supervised: Supervised, fault: str) -> None:
    """For 13 s: all deadlines are met, or one task is late at 4 of 50 checks, which is below 1/11.

    The watchdog would expire 50 ms after the last check.
    """
    result = supervised(fault, 13_000)
    assert result.failure() is None
    assert result.stop.reason == "reached"


@pytest.mark.parametrize(("fault", "task"), [("Late", "cyclic"), ("Late_Sporadic", "sporadic")])
def test_a_task_that_is_late_for_100_ms_ends_the_program(
    supervised: Supervised, fault: str, task: str
) -> None:
    """In its name, 100 ms after the check that finds it late."""
    text, culprit, since_release_ms = ended(supervised(fault, 1_000))
    assert (text, culprit) == ("deadline missed for 100 ms", task)
    assert DEADLINE_MS + 100 <= since_release_ms <= DEADLINE_MS + 100 + CHECK_MS


def test_a_task_that_is_late_for_a_tenth_of_the_time_ends_the_program(
    supervised: Supervised,
) -> None:
    """At 5 of 50 checks: more than an eleventh adds up, here within 10 s."""
    result = supervised("Often_Late", 13_000)
    assert ended(result)[:2] == ("deadline missed for 100 ms", "cyclic")
    assert 8_000 <= result.brick.cycles / CYCLES_PER_MS <= 12_000


def test_a_task_that_falls_behind_its_releases_ends_the_program(supervised: Supervised) -> None:
    """Each job takes longer than the period: it delays until instants that have passed."""
    result = supervised("Behind", 1_000)
    assert ended(result)[:2] == ("deadline missed for 100 ms", "cyclic")
    assert result.brick.cycles / CYCLES_PER_MS <= 150


def test_a_task_without_a_first_delay_ends_the_program_after_600_ms(supervised: Supervised) -> None:
    """It may set up for 0.5 s, and be late for 100 ms."""
    result = supervised("No_Delay", 1_000)
    text, address = result.failure(), result.words("ravenbrick_failure", 3)[2]
    assert text == ("deadline missed for 100 ms", 0)
    assert is_in(result, "watched__cyclic", address)
    assert 600 <= result.brick.cycles / CYCLES_PER_MS <= 610


def test_a_task_with_a_deadline_that_ends_ends_the_program(supervised: Supervised) -> None:
    """At the next check after its twentieth release."""
    text, culprit, since_release_ms = ended(supervised("Ends", 1_000))
    assert (text, culprit) == ("Tasking_Error: task ended", "cyclic")
    assert since_release_ms <= 6


def test_a_task_that_overwrote_its_lowest_word_ends_the_program(supervised: Supervised) -> None:
    """Without stack checks, at the next check."""
    text, culprit, since_release_ms = ended(supervised("Overflows", 1_000))
    assert (text, culprit) == ("Storage_Error: stack overflow", "cyclic")
    assert since_release_ms <= 6


def test_a_supervisor_that_hangs_lets_the_watchdog_expire(supervised: Supervised) -> None:
    """50 ms after its twentieth check, on a slow clock whose frequency is known to a third."""
    result = supervised("Hangs", 1_000)
    assert result.failure() is not None
    text, _ = result.failure() or ("", 0)
    assert text == "watchdog expired"
    assert 40 + 35 <= result.brick.cycles / CYCLES_PER_MS <= 40 + 80


def test_a_supervisor_that_is_left_alone_ends_the_program(run: Runner) -> None:
    """The main procedure has ended at once, the only other task after 20 ms."""
    switch = "-XSUPERVISION=-Wl,--defsym=ravenbrick_supervised=1"
    result = run("last_task", options=(switch,))
    assert result.journal() == "e"
    assert result.failure() == ("main procedure ended, no task left", 0)
    assert 20 <= result.brick.cycles / CYCLES_PER_MS <= 26


def test_a_supervisor_beside_a_main_procedure_that_stays_goes_on(run: Runner) -> None:
    """The environment task is one of those that are left."""
    switch = "-XSUPERVISION=-Wl,--defsym=ravenbrick_supervised=1"
    result = run("last_task", options=(switch,), values={"main_stays": 1})
    assert result.journal() == "e"
    assert result.failure() is None
    assert result.stop.reason == "reached"


def test_a_program_without_deadlines_is_not_supervised(run: Runner) -> None:
    """As a build without the linker's switch: nothing ends it, and no watchdog runs."""
    result = run("last_task", 200 * CYCLES_PER_MS, code="thumb")
    assert result.failure() is None
    assert result.stop.reason == "reached"
