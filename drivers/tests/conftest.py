# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Builds the test programs and puts them on virtual bricks."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import virtual_brick

from verification.support.bricks.observe import Brick, bench

TESTS = Path(__file__).resolve().parent
ROOT = TESTS.parent.parent
BUILD = Path(os.environ.get("RAVENBRICK_BUILD", ROOT / "build"))


@pytest.fixture(scope="session")
def run_time() -> None:
    """The run-time, built once; RAVENBRICK_RTS names another one, taken as it is."""
    if "RAVENBRICK_RTS" not in os.environ:
        subprocess.run(["make", "--silent", "-C", ROOT / "runtime"], check=True)


@pytest.fixture(scope="session")
def image(run_time: None) -> Callable[[str, str], bytes]:
    """From the name of a test program and the kind of image, ram or flash, to its ELF."""
    built: dict[tuple[str, str], bytes] = {}

    def build(name: str, kind: str) -> bytes:
        if (name, kind) not in built:
            config = [f"--config={ROOT / 'tools' / 'ravenbrick.cgpr'}"]
            if "RAVENBRICK_RTS" not in os.environ:
                config.append(f"--implicit-with={ROOT / 'tools' / 'run_time.gpr'}")
            project = ["-P", str(TESTS / "test.gpr"), f"-XTEST={name}", f"-XIMAGE={kind}"]
            done = subprocess.run(
                ["gprbuild", "-q", "-j2", *config, *project],
                capture_output=True,
                text=True,
                check=False,
            )
            assert done.returncode == 0, done.stdout + done.stderr
            elf = BUILD / "drivers" / "tests" / name / kind / f"{name}.elf"
            built[name, kind] = elf.read_bytes()
        return built[name, kind]

    return build


@pytest.fixture
def brick(image: Callable[[str, str], bytes]) -> Callable[..., Brick]:
    """From the name of a test program to a brick that is about to start it."""

    def start(name: str, kind: str = "ram", **changes: Any) -> Brick:
        configuration = json.dumps(bench() | changes)
        return Brick(virtual_brick.VirtualBrick(configuration, image(name, kind)))

    return start
