# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The first line that a person sees after a slip of the first hour names the cause."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from ravenbrick.cli.app import app
from ravenbrick.project.workspace import Workspace

# What is typed, with the project's folder as {project}; what the first line begins with.
SLIPS = [
    ("run {project} drive --replay none", "none: there is no such recording; make one with"),
    ("run {project} drive --from-snapshot none", "none: there is no such snapshot;"),
    ("run {project} drive --image rom", "Invalid value for '--image': 'rom' is not one of"),
    ("run {project} nope", "examples/vehicle/scenarios/nope.toml: there is no such scenario;"),
    ("analyse {project} --scenario nope", "examples/vehicle/scenarios/nope.toml: there is no"),
    ("export none.npz", "none.npz: there is no such recording; make one with"),
    ("export {project}/robot.toml", "examples/vehicle/robot.toml: not a recording of a run"),
    ("export {project} drive", "out/vehicle/recordings/drive.npz: the scenario has not been run"),
    ("grade {project} --rubric none", "none:1: cannot be read"),
    ("monitor ttyUSB0", "'ttyUSB0' is not a device: expected tcp:PORT,"),
    ("monitor {project}", "'examples/vehicle' is a folder: expected tcp:PORT,"),
    ("monitor {project}/robot.toml", "'examples/vehicle/robot.toml' is a file: expected tcp:"),
    ("monitor tcp:99999", "'tcp:99999': expected tcp:PORT or tcp:HOST:PORT, the port 1 to"),
    ("monitor none.rbt", "none.rbt: No such file or directory; correct its name"),
]


@pytest.mark.parametrize(("typed", "begins"), SLIPS, ids=[typed for typed, _ in SLIPS])
def test_the_first_line_after_a_slip(
    project: Path, monkeypatch: pytest.MonkeyPatch, typed: str, begins: str
) -> None:
    monkeypatch.chdir(Workspace.of(project).root)
    words = typed.format(project=project.relative_to(Path.cwd())).split()
    result = CliRunner().invoke(app, words)
    assert result.exit_code not in (0, 1)
    first = next(line for line in result.stderr.splitlines() if line.startswith("ravenbrick: "))
    assert first.removeprefix("ravenbrick: ").startswith(begins)


def test_a_word_names_the_same_recording_from_every_place(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From where the user stands, else in the project, else among the project's recordings."""
    workspace = Workspace.of(project)
    kept = workspace.recording("drive")
    kept.parent.mkdir(parents=True)
    kept.touch()
    monkeypatch.chdir(workspace.root)
    assert workspace.named_recording("drive") == kept
    (project / "other.npz").touch()
    assert workspace.named_recording("other.npz") == project / "other.npz"
    (workspace.root / "other.npz").touch()
    assert workspace.named_recording("other.npz") == Path("other.npz")


def test_a_rubric_of_the_lab_sheets_is_named_by_its_number() -> None:
    """As a path in the tree, and by its name alone."""
    from ravenbrick.grading.rubric import read_rubric

    assert (
        read_rubric(Path("lab-01")).digest
        == read_rubric(Path("docs/lessons/rubrics/lab-01.toml")).digest
    )
