# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The kernel's subprograms have contracts, which hold in the programs that use all its services.

They need a library of their own (`make CONTRACTS=yes`).
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from verification.support.bricks.runtime_programs import CYCLES_PER_MS, Runner

KERNEL = Path(__file__).resolve().parents[1] / "kernel"
DECLARATION = re.compile(r"^   (?:procedure|function) (\w+)([^;]|;(?=[^()]*\)))*;", re.M)
CONTRACT = re.compile(r"\b(?:Pre|Post|Global) +=>|\bNo_Return\b")

PROGRAMS = (
    *("ceiling", "entries", "fifo", "handler_entry", "interrupt_ceiling", "nested_interrupts"),
    *("periodic", "preemption", "sequential", "six_tasks", "stacks", "stress", "termination"),
    *("timing_events", "yield"),
)


def declarations(text: str) -> dict[str, str]:
    """Declarations of a specification by the name of the subprogram, comments left out."""
    code = re.sub(r"--.*", "", text)
    return {match[1]: match[0] for match in DECLARATION.finditer(code)}


def test_every_subprogram_of_the_kernel_has_a_contract() -> None:
    """But for those with their definition beside the name, and those that contracts are made of."""
    specifications = [path.read_text() for path in sorted(KERNEL.glob("*.ads"))]
    found = {name: text for spec in specifications for name, text in declarations(spec).items()}
    contracts = [text for text in found.values() if CONTRACT.search(text)]
    assert len(contracts) >= 20
    for name, text in found.items():
        words = any(re.search(rf"\b{name}\b", other.split("with", 1)[1]) for other in contracts)
        assert CONTRACT.search(text) or re.search(r"\bis\s*\(", text) or words, name


@pytest.mark.long("builds a library of its own")
@pytest.mark.parametrize("program", PROGRAMS)
def test_the_contracts_of_the_kernel_hold(run: Runner, program: str) -> None:
    """A contract that fails stops the program at its line."""
    result = run(program, runtime="contracts", cycles=150 * CYCLES_PER_MS)
    assert result.failure() is None
    assert result.stop.reason == "reached"
    assert result.brick.symbol("ravenbrick_interrupts_masked")
