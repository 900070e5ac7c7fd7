# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The kernel's contracts hold in the programs that use all its services.

RAVENBRICK_LONG=1 runs them; they need a library of their own (`make CONTRACTS=yes`).
"""

from __future__ import annotations

import os

import pytest

from runtime.tests.harness import CYCLES_PER_MS, Runner

PROGRAMS = (
    *("ceiling", "entries", "fifo", "handler_entry", "interrupt_ceiling", "nested_interrupts"),
    *("periodic", "preemption", "sequential", "six_tasks", "stacks", "stress", "termination"),
    *("timing_events", "yield"),
)


@pytest.mark.skipif(
    not os.environ.get("RAVENBRICK_LONG"),
    reason="builds a library of its own: RAVENBRICK_LONG=1 runs it",
)
@pytest.mark.parametrize("program", PROGRAMS)
def test_the_contracts_of_the_kernel_hold(run: Runner, program: str) -> None:
    """A contract that fails stops the program at its line."""
    result = run(program, runtime="contracts", cycles=150 * CYCLES_PER_MS)
    assert result.failure() is None
    assert result.stop.reason == "reached"
