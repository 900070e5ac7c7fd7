# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The marker `long`: what `make test` skips and `make conformance` runs."""

from __future__ import annotations

import os

import pytest
import ravenbrick as ravenbrick  # limits the threads of linear algebra, before NumPy is loaded


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test with the marker, unless RAVENBRICK_LONG is set."""
    marker = item.get_closest_marker("long")
    if marker is not None and not os.environ.get("RAVENBRICK_LONG"):
        pytest.skip(f"{marker.args[0]}: make conformance, or RAVENBRICK_LONG=1")
