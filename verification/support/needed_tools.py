# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Marks of tests that need what 'make setup' installs or builds."""

from __future__ import annotations

import importlib.util

import pytest
from ravenbrick.image.build import TOOLS, find_tool

__all__ = ["NEEDS_TOOLCHAIN", "NEEDS_VIRTUAL_BRICK"]

NEEDS_TOOLCHAIN = pytest.mark.skipif(
    any(find_tool(tool) is None for tool in TOOLS),
    reason="the cross toolchain is not installed; 'make setup' installs it",
)
NEEDS_VIRTUAL_BRICK = pytest.mark.skipif(
    importlib.util.find_spec("virtual_brick") is None,
    reason="the module virtual_brick is not built; 'make setup' builds it",
)
