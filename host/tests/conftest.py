# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A project folder in a tree of its own, with the vehicle's files, for tests that change them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from verification.support.projects import make_project

from ravenbrick.project.robot import Robot, read_robot


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
