# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Dispatching by priority and in the order of release."""

from __future__ import annotations

from verification.support.bricks.runtime_programs import CYCLES_PER_MS, Runner, assert_repeats


class TestDispatching:
    def test_a_released_task_of_higher_priority_runs_at_once(self, run: Runner) -> None:
        """Releases nest by priority, and each releaser goes on when the released has blocked."""
        result = run("preemption")
        assert result.stop.reason == "reached"
        journal = result.journal()
        assert journal.startswith("s")
        assert_repeats(journal[1:55], "lmhHML", 9)

    def test_equal_priorities_run_in_the_order_of_their_release(self, run: Runner) -> None:
        """First in, first out; one that releases another goes on before it, and a delay until the
        past passes the turn."""
        journal = run("fifo").journal()
        assert journal.startswith("123.")
        assert_repeats(journal[3:], ".cbacbacba", 5)

    def test_a_task_that_yields_lets_its_equals_run(self, run: Runner) -> None:
        """Ada.Dispatching.Yield passes the turn round."""
        assert run("yield").journal() == 10 * "abc"

    def test_a_preempted_task_goes_on_before_its_equals(self, run: Runner) -> None:
        """A busy task that two others preempt 190 times never leaves the processor to its equal."""
        result = run("preempted_first")
        assert result.brick.read_int("ticks", "u32") > 2 * 190
        assert result.brick.read_int("first", "u32") > 100_000
        assert result.brick.read_int("second", "u32") == 0

    def test_sequential_elaboration_starts_tasks_last(self, run: Runner) -> None:
        """Under the sequential policy tasks start after all elaboration, highest first."""
        assert run("sequential").journal() == "e21mn"

    def test_a_main_procedure_without_a_priority_has_the_default_one(self, run: Runner) -> None:
        """System.Default_Priority (RM D.1); with the aspect Priority that one."""
        for program, priority in (("library_units", 15), ("sequential", 1)):
            threads = run(program, cycles=CYCLES_PER_MS).brick.threads()
            (environment,) = (each for each in threads if each.name == "environment")
            assert environment.base_priority == priority
