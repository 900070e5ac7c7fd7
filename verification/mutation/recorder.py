# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A plugin of pytest: lines and processor time of each test, and a limit of time for each.

`TIMES` names a file for the seconds of each test, its fixtures and children among them. `LIMIT_S`
bounds the processor time of each test, so that an endless one costs little more than a long one.
"""

from __future__ import annotations

import json
import os
import resource
from collections.abc import Generator
from pathlib import Path

import coverage
import pytest

__all__ = ["LIMIT_S", "TIMES"]

TIMES = "RAVENBRICK_MUTATION_TIMES"
LIMIT_S = "RAVENBRICK_MUTATION_LIMIT_S"
_used_s: dict[str, float] = {}


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Count what a test and its fixtures do as the test's."""
    recording = coverage.Coverage.current()
    before = os.times()
    if recording is not None:
        recording.switch_context(item.nodeid)
    if LIMIT_S in os.environ:
        _, hard = resource.getrlimit(resource.RLIMIT_CPU)
        end_s = int(before.user + before.system + float(os.environ[LIMIT_S]))
        resource.setrlimit(resource.RLIMIT_CPU, (end_s, hard))
    try:
        return (yield)
    finally:
        if recording is not None:
            recording.switch_context("")
        _used_s[item.nodeid] = sum(os.times()[:4]) - sum(before[:4])


def pytest_sessionfinish() -> None:
    """Write the times down."""
    if TIMES in os.environ:
        Path(os.environ[TIMES]).write_text(json.dumps(_used_s), encoding="utf-8")
