# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Stacks, termination, tagged types, library units."""

from __future__ import annotations

import math
import struct

import pytest

from verification.support.bricks.runtime_programs import CYCLES_PER_MS, Runner


class TestMemory:
    def test_stacks_have_the_requested_size(self, run: Runner) -> None:
        """The control blocks tell the Storage_Size of each task; the linker's map has it, too."""
        result = run("stacks")
        threads = result.brick.threads()
        sizes = {thread.base_priority: thread.stack_size for thread in threads}
        assert sizes == {7: 4096, 10: 400, 11: 3_000, 13: 512, 3: 600, 4: 600}
        assert result.brick.read_int("asked_bytes", "u32") == 3_000
        for thread in threads[1:]:
            assert 40 <= thread.stack_used <= thread.stack_size

    def test_the_high_water_mark_sees_deep_use(self, run: Runner) -> None:
        """2000 bytes of local data show in the task that has them, not in the others."""
        used = {t.base_priority: t.stack_used for t in run("stacks").brick.threads()}
        assert 2_000 <= used[11] <= 2_200
        assert used[10] <= 200

    def test_a_task_that_ends_is_terminated(self, run: Runner) -> None:
        """So is the environment task after the main procedure; the others go on."""
        states = {t.base_priority: t.state for t in run("stacks").brick.threads()}
        assert states == {7: 5, 10: 2, 11: 2, 13: 5, 3: 2, 4: 2}

    def test_arithmetic_of_tasks_does_not_mix(self, run: Runner) -> None:
        """Two tasks compute in floating point while one preempts the other 500 times."""
        result = run("arithmetic", cycles=300 * CYCLES_PER_MS)
        assert result.brick.read_int("rounds", "u32") == 500

        expected_float = 0.0
        for index in range(1, 501):
            square = struct.unpack("f", struct.pack("f", float(index) ** 2))[0]
            term = struct.unpack("f", struct.pack("f", 1.0 / square))[0]
            expected_float = struct.unpack("f", struct.pack("f", expected_float + term))[0]
        assert result.brick.read_float("sum_of_floats", "f32") == expected_float

        expected_double = 0.0
        for index in range(2_000):
            expected_double += (-4.0 if index % 2 else 4.0) / (2 * index + 1)
        assert result.brick.read_float("sum_of_doubles", "f64") == expected_double
        assert result.brick.read_int("product", "i64") == math.factorial(20)
        address, _ = result.brick.symbol("text")
        assert result.brick.read_memory(address, 12) == b"< 1234.....>"


class TestTermination:
    def test_the_fall_back_handler_is_called_by_each_task_that_ends(self, run: Runner) -> None:
        """At the end of its body, with its identity and the cause Normal; then it is terminated."""
        assert run("termination").journal().startswith("s+Sl+Lt")


class TestTaggedTypes:
    def test_calls_dispatch_over_a_library_level_hierarchy(self, run: Runner) -> None:
        """Overriding, interface and membership need no table of names."""
        result = run("tagged_types")
        assert result.words("areas", 2) == [90, 200]
        assert result.words("kinds", 2) == [1, 2]


def test_library_units_without_a_heap(run: Runner) -> None:
    """Storage pools, elementary functions, images, packed arrays, atomics and strings of C."""
    result = run("library_units")
    assert result.failure() is None
    assert result.journal() == "abcdefghij"
    angle = 0.5
    expected = (math.sin(angle), math.exp(angle), math.atan2(angle, 2.0), angle**1.5)
    *values, cycles, _ = result.words("results", 6)
    assert values == [pytest.approx(1e6 * value, abs=1) for value in expected]
    assert 500 < cycles < 5_000
