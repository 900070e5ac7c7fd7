# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every command prints paths that open from where the user stands."""

from __future__ import annotations

from pathlib import Path

import pytest

from ravenbrick.errors import ProjectFileError, shown_path


@pytest.mark.parametrize(
    ("stands", "file", "shown"),
    [
        (".", "robot/out/robot/report.html", "robot/out/robot/report.html"),
        ("robot", "robot/out/robot/report.html", "out/robot/report.html"),
        ("robot/src", "robot/out/robot/report.html", "../out/robot/report.html"),
    ],
)
def test_a_path_is_relative_to_where_the_user_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stands: str, file: str, shown: str
) -> None:
    (tmp_path / stands).mkdir(parents=True, exist_ok=True)
    monkeypatch.chdir(tmp_path / stands)
    assert shown_path(tmp_path / file) == shown
    assert str(ProjectFileError(tmp_path / file, 3, "tasks", "wrong")).startswith(f"{shown}:3: ")


def test_a_path_far_away_is_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    deep = tmp_path / "a" / "b" / "c" / "d" / "e" / "f" / "g" / "h" / "i" / "j" / "k" / "l"
    deep.mkdir(parents=True)
    monkeypatch.chdir(deep)
    assert shown_path(Path("/etc/udev")) == "/etc/udev"
