# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The motors are off in time, whatever happens to the program; two phases of each fault."""

from __future__ import annotations

from pathlib import Path

import pytest

from verification.stops.campaign import FAULTS, FEW_PHASES_US, Programs, measure, problems, programs
from verification.stops.faults import EARLIEST_MS, Fault, faulty_program, strike


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Programs:
    """The programs as `ravenbrick new` makes them."""
    return programs(tmp_path_factory.mktemp("stops"), FAULTS, (True,))


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_the_motors_are_off_within_the_limit_of_the_fault(built: Programs, fault: Fault) -> None:
    """And the faults for which there is no limit are those that are said to have none."""
    assert not problems(fault, measure(built, fault, FEW_PHASES_US, supervised=True))


def test_a_program_without_faults_goes_on(built: Programs) -> None:
    """Nothing stops a motor that is commanded in time."""
    (outcome,) = measure(built, Fault("none", None), (0,), supervised=True)
    assert outcome.off_ms is None
    assert outcome.display == ("presses 0",)


def test_motors_without_a_new_command_brake_after_the_timeout_of_the_robot(tmp_path: Path) -> None:
    """The main procedure commands once; the timeout passes long before it ends."""
    program = faulty_program(tmp_path, alone=True, motor_timeout_ms=100)
    outcome = strike(program, Fault("none", None, inputs=((0, "button.left", 1),)), 0)
    assert outcome.commands[0].duty == 50
    on, off = outcome.commands[:2]
    assert off.duty == 0
    assert 100 <= off.at_ms - on.at_ms < 110 < EARLIEST_MS
