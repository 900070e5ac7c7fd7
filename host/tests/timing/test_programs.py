# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A few programs of the campaign in `conformance/timing`, on the virtual brick."""

from __future__ import annotations

import importlib.util

import pytest

from ravenbrick.target.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from conformance.timing.program_campaign import campaign


def test_no_response_time_of_generated_programs_exceeds_its_bound() -> None:
    result = campaign(count=5, seed=7)
    assert result["above_bound"] == []
    assert result["tasks"] >= 10
    assert result["lowest_task_compared"] == 5
    assert 1.0 <= result["lowest_task_ratio_mean"] < 1.2
