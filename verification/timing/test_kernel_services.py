# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The run-time's services in their worst situations, against their bounds."""

from __future__ import annotations

import importlib.util

import pytest
from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.timing.kernel_services import service_times


@pytest.mark.parametrize("code", ["arm", "thumb"])
def test_no_service_takes_longer_than_its_bound_and_each_nearly_as_long(code: str) -> None:
    found = service_times(code)
    assert len(found) == 18
    for row in found:
        assert row.count > 0, row
        assert row.is_close, row
