# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The marker `long` (`make conformance` runs it), machines without a sandbox, tests that hang.

Where submissions cannot be isolated, tests that grade trust their own; tests of the border skip.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

import pytest
import ravenbrick as ravenbrick  # limits the threads of linear algebra, before NumPy is loaded
from ravenbrick.grading.isolation import IsolationError, find_isolation

# Far above the longest test on a busy machine.
HANGS_AFTER_S = 900

# A shell that starts the tests in the background has it ignored, and programs inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

try:
    find_isolation()
except IsolationError as no_isolation:
    os.environ["RAVENBRICK_TRUST_SUBMISSIONS"] = "1"
    NO_ISOLATION = no_isolation.sentence
else:
    NO_ISOLATION = ""


def _hangs(_number: int, _frame: FrameType | None) -> NoReturn:
    raise TimeoutError(f"the test does not end within {HANGS_AFTER_S} s")


@contextmanager
def _ended() -> Iterator[None]:
    """A test that waits for ever fails, where else the whole run would never end."""
    before = signal.signal(signal.SIGALRM, _hangs)
    signal.alarm(0 if os.environ.get("RAVENBRICK_LONG") else HANGS_AFTER_S)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call() -> Generator[None, None, None]:
    """Of the test itself; what fixtures wait for is theirs."""
    with _ended():
        return (yield)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test with the marker, unless RAVENBRICK_LONG is set."""
    marker = item.get_closest_marker("long")
    if NO_ISOLATION and item.get_closest_marker("isolated"):
        pytest.skip(NO_ISOLATION)
    if marker is not None and not os.environ.get("RAVENBRICK_LONG"):
        pytest.skip(f"{marker.args[0]}: make conformance, or RAVENBRICK_LONG=1")
