# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The marker `long`, what `make test` skips and `make conformance` runs; machines without sandbox.

Where submissions cannot be isolated, tests that grade trust their own; tests of the border skip.
"""

from __future__ import annotations

import os
import signal

import pytest
import ravenbrick as ravenbrick  # limits the threads of linear algebra, before NumPy is loaded
from ravenbrick.grading.isolation import IsolationError, find_isolation

# A shell that starts the tests in the background has it ignored, and programs inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

try:
    find_isolation()
except IsolationError as no_isolation:
    os.environ["RAVENBRICK_TRUST_SUBMISSIONS"] = "1"
    NO_ISOLATION = no_isolation.sentence
else:
    NO_ISOLATION = ""


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test with the marker, unless RAVENBRICK_LONG is set."""
    marker = item.get_closest_marker("long")
    if NO_ISOLATION and item.get_closest_marker("isolated"):
        pytest.skip(NO_ISOLATION)
    if marker is not None and not os.environ.get("RAVENBRICK_LONG"):
        pytest.skip(f"{marker.args[0]}: make conformance, or RAVENBRICK_LONG=1")
