# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The motors are off in time, whatever happens to the program; two phases of each fault."""

from __future__ import annotations

import pytest

from verification.stops.campaign import FAULTS, FEW_PHASES_US, Programs, measure, problems, programs
from verification.stops.faults import Fault


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
