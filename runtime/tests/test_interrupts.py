# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Interrupt handlers."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest
import virtual_brick

from verification.support.bricks.runtime_programs import (
    BENCH,
    CYCLES_PER_MS,
    Run,
    Runner,
    assert_repeats,
    build,
)


@pytest.fixture(scope="module")
def stress() -> Callable[[int], Run]:
    """The program of contending tasks and handlers for 4 s, from a seed put into its image."""

    def run_seeded(seed: int) -> Run:
        elf = build("stress").read_bytes()
        standing = (0x5EED_0001).to_bytes(4, "little")
        assert elf.count(standing) == 1
        brick = virtual_brick.VirtualBrick(
            json.dumps(BENCH), elf.replace(standing, seed.to_bytes(4, "little"))
        )
        return Run(brick, brick.run_until(4_000 * CYCLES_PER_MS))

    return run_seeded


class TestInterrupts:
    def test_a_higher_level_interrupts_a_handler(self, run: Runner) -> None:
        """Handlers nest by level only; the released task runs after the outermost."""
        assert_repeats(run("nested_interrupts").journal(), "([]|t)s;[](|t)s.", 8)

    def test_an_interrupt_ceiling_keeps_out_handlers_up_to_it(self, run: Runner) -> None:
        """A higher handler comes through, equal and lower ones wait until the object is left."""
        assert_repeats(run("interrupt_ceiling").journal(), "(h)l,[]hl;", 15)

    @pytest.mark.parametrize("seed", [1, 3, 5, 7])
    def test_objects_shared_at_random_instants_keep_their_rules(
        self, stress: Callable[[int], Run], seed: int
    ) -> None:
        """Tasks and handlers contend for nine objects of six ceilings; `checks.ads` has the rules.

        A mask that outlives the protected action it belongs to shows here within a second.
        """
        result = stress(seed)
        assert result.stop.reason == "reached"
        assert result.words("violations", 6) == [0] * 6
        assert min(result.words("touched", 6)) >= 100
        requests = result.brick.read_int("requests", "u32")
        assert requests - result.brick.read_int("served", "u32") in (0, 1)

    def test_a_handler_opens_an_entry_for_the_waiting_task(self, run: Runner) -> None:
        """Each interrupt of 100 runs the server once, at once, with the handler's data."""
        result = run("handler_entry", cycles=102 * CYCLES_PER_MS)
        journal = result.journal()
        assert journal.startswith("b")
        assert_repeats(journal[1:], "is", 99)
        assert result.brick.read_int("served", "u32") >= 100

    def test_an_interrupt_with_a_handler_takes_no_second_one(self, run: Runner) -> None:
        """Program_Error when it is attached (RM C.3.1 (10)), which is before the main procedure."""
        result = run("second_handler")
        assert result.failure() == ("Program_Error: interrupt reserved or taken", 0)
        assert result.journal() == ""
