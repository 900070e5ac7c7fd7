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


@pytest.fixture
def brick() -> Callable[..., Brick]:
    """From the name of a test program to a brick that is about to start it."""

    def start(name: str, kind: str = "ram", **changes: Any) -> Brick:
        configuration = json.dumps(bench() | changes)
        return Brick(virtual_brick.VirtualBrick(configuration, image_of(name, kind)))

    return start
