# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A project folder in a tree of its own, with the vehicle's files, for tests that change them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from verification.support.projects import make_project

from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.self_test.record import PARTS, Record
from ravenbrick.self_test.taking import Settings, from_virtual_brick

_SELF_TEST_RUNS: dict[tuple[str, str, str], Record] = {}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project that can be run."""
    return make_project(tmp_path)


@pytest.fixture
def robot(project: Path) -> Robot:
    """The vehicle."""
    return read_robot(project)


@pytest.fixture
def edit(project: Path) -> Callable[[str, str, str], int]:
    """Replace a text once in a file of the project; returns the line where it stood."""

    def replace(name: str, old: str, new: str) -> int:
        path = project / name
        text = path.read_text()
        assert text.count(old) >= 1, f"{name} has no '{old}'"
        path.write_text(text.replace(old, new, 1))
        return text[: text.index(old)].count("\n") + 1

    return replace


@pytest.fixture
def self_test_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each run of the self-test is made once in all tests: the same inputs give the same record.

    A comparison makes thirty, most of them with the same parameters in every comparison.
    """

    def remembered(image: ElfImage, settings: Settings, until: str = PARTS[-1]) -> Record:
        run = (image.digest, json.dumps(settings, sort_keys=True), until)
        if run not in _SELF_TEST_RUNS:
            _SELF_TEST_RUNS[run] = from_virtual_brick(image, settings, until)
        return _SELF_TEST_RUNS[run]

    for user in ("self_test.comparison", "cli.compare_brick"):
        monkeypatch.setattr(f"ravenbrick.{user}.from_virtual_brick", remembered)
