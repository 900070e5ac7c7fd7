# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Protected objects, entries and their queues."""

from __future__ import annotations

import pytest

from verification.support.bricks.runtime_programs import (
    CYCLES_PER_MS,
    Runner,
    assert_repeats,
    is_in,
)


class TestProtectedObjects:
    def test_the_ceiling_keeps_out_tasks_up_to_it(self, run: Runner) -> None:
        """Inside the object, only a task above the ceiling preempts; the others by priority."""
        assert_repeats(run("ceiling").journal(), "(12a)lb;", 20)

    def test_a_caller_above_the_ceiling_gets_program_error(self, run: Runner) -> None:
        """The task at the ceiling passes, the one above stops the program."""
        result = run("ceiling_violation")
        assert result.journal() == "ta"
        assert result.failure() == ("Program_Error: ceiling violated", 0)
        *_, failed, violated = result.words("ravenbrick_failure", 4)
        assert is_in(result, "low_ceiling__above_ceiling", failed)
        assert is_in(result, "low_ceiling__object", violated)

    def test_blocking_in_a_protected_action_gets_program_error(self, run: Runner) -> None:
        """A delay is detected even when the ceiling is the caller's own priority."""
        result = run("blocking_in_action")
        assert result.journal() == "s"
        assert result.failure() == ("Program_Error: blocking in protected action", 0)

    def test_the_opener_of_an_entry_executes_its_body(self, run: Runner) -> None:
        """The waiting task goes on at once when it is higher than the opener, else afterwards."""
        result = run("entries")
        assert_repeats(result.journal(), "wpg1lpgh2", 5)

    def test_entry_parameters_reach_the_caller(self, run: Runner) -> None:
        """The consumer has received the sum of what both producers sent."""
        result = run("entries", cycles=104 * CYCLES_PER_MS)
        assert result.brick.read_int("received", "i32") == 10 * 1 + 9 * 2

    def test_a_second_task_on_an_entry_gets_program_error(self, run: Runner) -> None:
        """Max_Entry_Queue_Length is 1."""
        result = run("second_waiter")
        assert result.journal() == "12"
        assert result.failure() == ("Program_Error: second caller of entry", 0)

    def test_a_suspension_object_keeps_one_release(self, run: Runner) -> None:
        """Set twice it lets one pass and is false again; a second task may not wait."""
        result = run("second_suspended")
        assert result.journal() == "01002"
        assert result.failure() == ("Program_Error: second task suspended", 0)


def test_jorvik_queues(run: Runner) -> None:
    """Several entries, served in the order of declaration, their callers in the order of calls."""
    result = run("jorvik_queues", runtime="jorvik")
    assert result.failure() is None
    assert result.journal() == "a1b23ldce"


by_priority = pytest.param(
    "jorvik-priority",
    "hmlwsp21",
    marks=pytest.mark.long("builds a library of its own"),
)


@pytest.mark.parametrize(("runtime", "order"), [("jorvik", "mwlhsp12"), by_priority])
def test_entries_are_served_by_the_policy(run: Runner, runtime: str, order: str) -> None:
    """By the order of declarations and calls, or by the callers' priorities (RM D.4).

    Then a call opens the entry whose barrier asks how many wait on its own (RM 9.5.3), and the
    members of a family are served by their index or by priority.
    """
    result = run("entry_order", runtime=runtime)
    assert result.failure() is None
    assert result.journal() == order
