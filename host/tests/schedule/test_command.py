# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick schedule` as a user sees it, with the set of the guide."""

from __future__ import annotations

import json
import re
from pathlib import Path

from typer.testing import CliRunner

from ravenbrick.cli import app

GUIDE = Path(__file__).resolve().parents[3] / "docs" / "guides" / "schedulability.md"


def guide_set(folder: Path) -> Path:
    found = re.search(r"```toml\n(.*?)```", GUIDE.read_text(), re.DOTALL)
    assert found is not None
    path = folder / "taskset.toml"
    path.write_text(found.group(1))
    return path


def guide_output() -> str:
    found = re.search(r"```text\n(.*?)```", GUIDE.read_text(), re.DOTALL)
    assert found is not None
    return found.group(1)


def test_guide_shows_what_the_command_prints(tmp_path: Path) -> None:
    """The file and the table of the guide belong together."""
    result = CliRunner(env={"COLUMNS": "80"}).invoke(app, ["schedule", str(guide_set(tmp_path))])
    assert result.exit_code == 0
    lines = [line.rstrip() for line in result.output.splitlines()]
    assert lines == [line.rstrip() for line in guide_output().splitlines()]


def test_json_holds_each_term(tmp_path: Path) -> None:
    """Own time, interference, blocking and overheads of the worst job, as decimal texts."""
    result = CliRunner().invoke(app, ["schedule", str(guide_set(tmp_path)), "--json"])
    found = json.loads(result.output)
    assert found["ok"] and found["schedulable"]
    control = next(task for task in found["tasks"] if task["name"] == "control")
    assert set(control["terms"]) >= {"own", "interference", "blocking", "context_switches", "clock"}


def test_wrong_file_ends_with_the_code_of_project_files(tmp_path: Path) -> None:
    """Exit code 3 and a sentence with the line."""
    path = tmp_path / "set.toml"
    path.write_text(
        "schema_version = 1\n[[tasks]]\nname = 'a'\nperiod = 0\nwcet = 1\npriority = 1\n"
    )
    result = CliRunner().invoke(app, ["schedule", str(path), "--json"])
    assert result.exit_code == 3
    assert "set.toml:4: tasks[0].period" in json.loads(result.output)["error"]
