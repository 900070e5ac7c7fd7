# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Transfers of the peripheral data controller take cycles from the processor, which no handler
shows: bounds hold with what is said about them, and would not without."""

from __future__ import annotations

import importlib.util
from dataclasses import replace

import pytest

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.timing.programs import Subject, analysed, subject

from ravenbrick.timing.facts.facts import TransferLoad
from ravenbrick.timing.observation.observed import Observed, exceeded, observe

TASK = "computation"


@pytest.fixture(scope="module")
def program() -> Subject:
    return subject("stealing", "stealing_load")


@pytest.fixture(scope="module")
def seen(program: Subject) -> dict[str, Observed]:
    return observe(program.robot, program.run())


@pytest.mark.parametrize(
    ("timing", "stolen_cycles"), [("optimistic", 1), ("nominal", 1), ("pessimistic", 4)]
)
def test_bounds_of_a_profile_hold_and_count_the_transfers_that_are_said(
    program: Subject, timing: str, stolen_cycles: int
) -> None:
    seen = observe(program.robot, program.run(timing))
    analysis = analysed(program, program.facts, timing)
    bound = analysis.bounds[TASK].bound
    assert bound is not None and exceeded(analysis, seen) == []
    assert seen[TASK].jobs > 50 and bound < 1.02 * seen[TASK].response_cycles
    transfers = analysis.stolen_cycles(TASK) / stolen_cycles
    assert 1 / 64 < transfers / bound < 1.12 / 64


def test_bounds_of_another_profile_need_not_hold(program: Subject) -> None:
    """Cycles that a transfer takes, synchronisation, register accesses: all are more."""
    slow = observe(program.robot, program.run("pessimistic"))
    assert len(exceeded(analysed(program, program.facts), slow)) == 2


def test_a_fact_left_out_shows_as_a_bound_exceeded(
    program: Subject, seen: dict[str, Observed]
) -> None:
    analysis = analysed(program, replace(program.facts, transfers=()))
    assert analysis.stolen_cycles(TASK) == 0
    response, own = exceeded(analysis, seen)
    assert response.startswith(f"{TASK} showed a response time of")
    assert own.startswith(f"{TASK} showed an execution time of")


def test_facts_of_a_unit_count_in_programs_that_have_it(program: Subject) -> None:
    own, drivers = TransferLoad("SPI", 4, 11, "display", "Mixing"), program.facts.transfers
    other = replace(own, unit="NXT.Display")
    facts = replace(program.facts, transfers=(own, other))
    assert facts.transfer_loads(program.image) == {"SPI": (own,)}
    assert {load.unit for load in drivers} == {
        None, "NXT.SPI", "NXT.Audio", "NXT.Bluetooth_Line", "NXT.RS485",
    }  # fmt: skip
