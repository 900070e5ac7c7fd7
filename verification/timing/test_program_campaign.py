# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A few programs of the campaign, on the virtual brick."""

from __future__ import annotations

import importlib.util

import pytest
from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.timing.program_campaign import Load, campaign
from verification.timing.unreached_bounds import MISSED, REACHED, UNEXPLAINED, explain


def test_no_response_time_of_generated_programs_exceeds_its_bound() -> None:
    result = campaign(count=5, seed=7)
    assert result["above_bound"] == []
    assert result["tasks"] >= 10
    assert result["lowest_task_compared"] == result["lowest_task_within_5_percent"] == 5
    assert 1.0 <= result["lowest_task_ratio_mean"] < 1.02


ALONE = [Load(0, 10_000, rounds=1_000, locked_rounds=1)]


def _response(loads: list[Load]) -> int:
    """Of a job of 100 000 cycles and 8 for each further round, which meets another after 1 002."""
    rounds = loads[0].rounds
    return 92_000 + 8 * rounds + (20_000 if rounds > 1_002 else 0)


def test_a_response_that_just_misses_a_release_is_told_from_a_bound_that_is_too_large() -> None:
    def meets(loads: list[Load]) -> tuple[int, int]:
        return _response(loads[:1]) + (20_000 if loads[0].rounds <= 1_002 else 0), _response(loads)

    def never_meets(loads: list[Load]) -> tuple[int, int]:
        return 120_000, 100_000

    found = explain(ALONE, 120_000, _response, meets)
    assert found.reason == MISSED and found.ratio < 1.05 and 0 < found.longer < 0.005
    assert explain(ALONE, 120_000, _response, never_meets).reason == UNEXPLAINED


def test_phases_at_which_a_response_comes_close_to_its_bound_are_found() -> None:
    def longest(loads: list[Load]) -> int:
        return 118_000 if loads[0].phase_us > 15 else 100_000

    found = explain(ALONE, 120_000, longest, lambda loads: (120_000, 100_000))
    assert found.reason == REACHED and found.ratio < 1.05
