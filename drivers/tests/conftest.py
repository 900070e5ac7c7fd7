# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Puts the test programs on virtual bricks."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
import virtual_brick

from verification.support.bricks.driver_programs import image_of
from verification.support.bricks.observe import Brick, bench

OTHER_TIMING = pytest.mark.long("the drivers at another end of the timing")
PROFILES = (
    "nominal",
    pytest.param("optimistic", marks=OTHER_TIMING),
    pytest.param("pessimistic", marks=OTHER_TIMING),
)


@pytest.fixture(params=PROFILES)
def timing_profile(request: pytest.FixtureRequest) -> str:
    """Each end of the timing that no document specifies (docs/reference/timing.md)."""
    return str(request.param)


@pytest.fixture
def brick(timing_profile: str) -> Callable[..., Brick]:
    """From the name of a test program to a brick that is about to start it."""

    def start(name: str, kind: str = "ram", **changes: Any) -> Brick:
        timing = {"profile": timing_profile} | changes.pop("timing", {})
        configuration = json.dumps(bench() | changes | {"timing": timing})
        return Brick(virtual_brick.VirtualBrick(configuration, image_of(name, kind)))

    return start
