# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The power button, held in a scenario: projects of `ravenbrick new`, and programs that failed."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner
from verification.support.failing_program import FailingProgram, failing_project

from ravenbrick.cli.app import app
from ravenbrick.project.templates import TEMPLATES, create_project

CONTROL, MAIN = 1, 3
HOLD = """schema_version = 1
name = "hold"
description = "The power button is held from 1 s on"
seed = 1
duration_ms = 9_000

[[inputs]]
at_ms = 1_000
input = "button.orange"
value = 1

[[criteria]]
expect = "powered off before 4.05 s"
"""
OFF = "the program switched the brick off"


def run(project: Path, *options: str) -> tuple[int, str]:
    """Exit code and output of a run in which the power button is held."""
    (project / "scenarios" / "hold.toml").write_text(HOLD)
    done = CliRunner().invoke(app, ["run", str(project), "hold", *options])
    return done.exit_code, done.output


@pytest.fixture(scope="module")
def failing(tmp_path_factory: pytest.TempPathFactory) -> FailingProgram:
    """With stack checking, as `ravenbrick new` makes it."""
    return failing_project(tmp_path_factory.mktemp("failing"), stack_check=True)


@pytest.mark.parametrize("template", TEMPLATES)
def test_every_template_is_switched_off(template: str, tmp_path: Path) -> None:
    """As it is, without a line of the student's; the run says so."""
    project = create_project(tmp_path / "robot", template).project
    code, output = run(project)
    assert code == 0, output
    assert f"s on the brick: {OFF}" in output


@pytest.mark.parametrize(
    ("task", "way", "amount"),
    [
        (CONTROL, "range_check", 1),
        (CONTROL, "in_protected", 1),
        (CONTROL, "in_handler", 1),
        (CONTROL, "ceiling", 1),
        (CONTROL, "recursion", 1),
        (CONTROL, "no_memory", 1),
        (CONTROL, "wild_jump", 1),
        (CONTROL, "undefined", 1),
        (MAIN, "division", 1),
    ],
)
def test_a_failed_program_is_switched_off_and_stays_failed(
    failing: FailingProgram, task: int, way: str, amount: int
) -> None:
    """The first line still names the cause."""
    code, output = run(failing.project, "--elf", str(failing.image(task, way, amount)))
    first = next(line for line in output.splitlines() if line.startswith("ravenbrick: "))
    assert code == 7
    assert first.endswith(f"; afterwards {OFF}"), first
    assert " at failing" in first
