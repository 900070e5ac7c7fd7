# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a program asks for when it is built: execution-time clocks, stack checking, names."""

from __future__ import annotations

import subprocess
from itertools import pairwise

import pytest

from verification.support.bricks.runtime_programs import CYCLES_PER_MS, Run, Runner, build, is_in

UNITS_PER_TICK = 7
CYCLES_PER_TICK = 16
# Least and most of a job that is interrupted or not, from readings of the clock around it
JOB_SPREAD_UNITS = 4 * UNITS_PER_TICK


@pytest.fixture(scope="module")
def timed(run: Runner) -> Run:
    """Two tasks, the environment task and a handler, all of which spin, for 100 ms."""
    return run("execution_times", runtime="timed")


class TestExecutionTime:
    def test_nothing_is_lost_and_nothing_counted_twice(self, timed: Run) -> None:
        """Tasks and handlers together have executed as long as the clock has run."""
        *parts, interrupts = timed.words("clocks", 6, "<i8")
        assert interrupts == sum(parts[3:])
        present = timed.brick.cycles * UNITS_PER_TICK // CYCLES_PER_TICK
        since_last_reading = 60_000
        start_up = 2_000
        assert present - since_last_reading - start_up <= sum(parts) <= present

    def test_handlers_do_not_cost_the_task_that_they_interrupt(self, timed: Run) -> None:
        """A job takes the same execution time whenever it runs, but not the same time."""
        least, most, least_wall, most_wall, *_ = timed.words("own", 6, "<i8")
        assert timed.brick.read_int("jobs", "u32") >= 90
        assert 0 < most - least <= JOB_SPREAD_UNITS + 7 * UNITS_PER_TICK
        assert most_wall - least_wall > 200

    def test_execution_times_only_grow(self, run: Runner) -> None:
        """Of every task and handler, in 20 readings."""
        brick = run("execution_times", runtime="timed", cycles=10 * CYCLES_PER_MS).brick
        readings = []
        for ms in range(11, 31):
            brick.run_until(ms * CYCLES_PER_MS)
            address, size = brick.symbol("clocks")
            readings.append(memoryview(brick.read_memory(address, size)).cast("q").tolist())
        for before, after in pairwise(readings):
            assert all(old <= new for old, new in zip(before, after, strict=True))

    def test_a_program_without_the_option_does_not_link(self) -> None:
        """The kernel that counts is asked for by name."""
        with pytest.raises(subprocess.CalledProcessError):
            build("execution_times")

    def test_others_pay_nothing(self) -> None:
        """The image of a program that does not ask has no account and no charge."""
        symbols = subprocess.run(
            ["arm-none-eabi-nm", build("entries")], capture_output=True, text=True, check=True
        ).stdout
        assert "ravenbrick_running_thread" in symbols
        assert "account" not in symbols
        assert "charge" not in symbols


class TestStackChecking:
    @pytest.mark.parametrize("code", ["arm", "thumb"])
    def test_an_overflow_is_found_before_it_overwrites_anything(
        self, run: Runner, code: str
    ) -> None:
        """The recursion stops while the margin is still free."""
        result = run("stack_overflow", code=code, options=("-XSTACK_CHECK=yes",))
        assert result.stop.reason == "halted"
        assert result.failure() == ("Storage_Error: stack overflow", 0)
        (recursive,) = (thread for thread in result.brick.threads() if thread.base_priority == 12)
        assert recursive.stack_used <= recursive.stack_size - 100
        assert 8 <= result.brick.read_int("depth", "u32") <= 40


class TestNames:
    def test_an_image_is_the_given_name_or_the_place_of_the_control_block(
        self, run: Runner
    ) -> None:
        """Pragma Task_Name gives the name; the compiler passes no other."""
        result = run("task_names")
        address, size = result.brick.symbol("images")
        text = result.brick.read_memory(address, size).decode("ascii")
        named, unnamed, environment, null = (text[i : i + 16].strip() for i in range(0, 64, 16))
        assert (named, environment, null) == ("pilot", "environment", "")
        assert is_in(result, "named__without_name", int(unnamed, 16))
