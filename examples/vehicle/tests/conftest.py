# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Puts the vehicle on a virtual brick, wheels off the floor."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import virtual_brick

from verification.support.bricks.observe import Brick, bench

VEHICLE = Path(__file__).resolve().parent.parent
ROOT = VEHICLE.parent.parent
BUILD = Path(os.environ.get("RAVENBRICK_BUILD", ROOT / "build"))


@pytest.fixture(scope="session")
def image() -> bytes:
    """The vehicle's image for the boot monitor."""
    command = ["make", "-C", str(VEHICLE), "ram", f"PYTHON={sys.executable}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return (BUILD / "vehicle" / "ram" / "vehicle.elf").read_bytes()


@pytest.fixture
def vehicle(image: bytes) -> Callable[..., Brick]:
    """A vehicle about to be switched on; keywords replace parts of the configuration."""

    def start(**changes: Any) -> Brick:
        return Brick(virtual_brick.VirtualBrick(json.dumps(bench() | changes), image))

    return start
