# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick schedule` as a user sees it, with the set of the guide."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode
from ravenbrick.schedule.model import Task, TaskSet
from ravenbrick.schedule.quantity import exact
from ravenbrick.schedule.report.gantt import gantt_figure
from ravenbrick.schedule.simulation import simulate
from ravenbrick.schedule.task_file import read_task_file

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


LATE = """schema_version = 1
[[tasks]]
name = "a"
period = 10
wcet = 6
priority = 2
[[tasks]]
name = "b"
period = 14
wcet = 5
priority = 1
"""


def test_the_picture_shows_both_schedules_and_who_misses(tmp_path: Path) -> None:
    """Fixed priorities miss where earliest deadline first does not; the end can be chosen."""
    path, picture = tmp_path / "set.toml", tmp_path / "set.svg"
    path.write_text(LATE)
    result = CliRunner().invoke(app, ["schedule", str(path), "--gantt", str(picture), "--json"])
    assert result.exit_code == ExitCode.DEADLINE_CAN_BE_MISSED, result.output
    answer = json.loads(result.output)
    assert answer["gantt"] == str(picture)
    assert answer["error"] == "NOT schedulable: b: response time 17 ms is above the deadline 14 ms"
    axes = gantt_figure(read_task_file(path).task_set, "ms").axes
    titles = [axis.get_title() for axis in axes]
    crosses = [line for axis in axes for line in axis.lines if line.get_marker() == "x"]
    assert [np.size(line.get_xdata()) for line in crosses] == [int(titles[0].split()[2]), 0]
    assert re.fullmatch(r"fixed priorities: [1-9]\d* missed deadlines", titles[0])
    assert titles[1] == "earliest deadline first: no deadline is missed"
    short = gantt_figure(read_task_file(path).task_set, "ms", exact(12))
    assert short.axes[1].get_xlim()[1] < 13
    idle = gantt_figure(TaskSet((Task("short", 50, 1),)), "ms", exact(40))
    assert [axis.get_xlim() for axis in idle.axes] == [pytest.approx((-0.4, 40.4))] * 2


def test_the_picture_of_a_set_with_jitter_shows_who_misses(tmp_path: Path) -> None:
    """A late first job and the next one in time delay the less urgent task past its deadline."""
    path = tmp_path / "set.toml"
    text = LATE.replace("wcet = 6", "wcet = 4").replace("wcet = 5", "wcet = 5\ndeadline = 10")
    path.write_text(text)
    title = gantt_figure(read_task_file(path).task_set, "ms").axes[0].get_title()
    assert title == "fixed priorities: no deadline is missed"
    path.write_text(text.replace("priority = 2", "priority = 2\nrelease_jitter = 4"))
    title = gantt_figure(read_task_file(path).task_set, "ms").axes[0].get_title()
    assert re.fullmatch(r"fixed priorities, late first releases: \d+ missed deadlines", title)


def test_an_interrupt_that_misses_is_named_with_the_code_of_deadlines(tmp_path: Path) -> None:
    path = tmp_path / "set.toml"
    burst = LATE.replace(
        'name = "a"\nperiod',
        'name = "burst"\nrelease = "interrupt"\ndeadline = 3\nminimum_interrelease_time',
    )
    path.write_text(burst)
    result = CliRunner().invoke(app, ["schedule", str(path)])
    assert result.exit_code == ExitCode.DEADLINE_CAN_BE_MISSED
    assert "NOT schedulable: burst: response time 6 ms is above the deadline 3 ms" in result.output


@pytest.mark.parametrize("option", ["protocol", "scheduler"])
def test_a_simulation_under_an_unknown_rule_is_refused(option: str, tmp_path: Path) -> None:
    task_set = read_task_file(guide_set(tmp_path)).task_set
    options: dict[str, Any] = {option: "typo"}
    with pytest.raises(ValueError, match=f"{option} is 'typo'; expected one of "):
        simulate(task_set, exact(12), **options)


def test_a_task_that_may_not_execute_at_all_is_no_advice(tmp_path: Path) -> None:
    """The second fills its own deadline."""
    path = tmp_path / "set.toml"
    path.write_text(LATE.replace("period = 14\nwcet = 5", "period = 20\ndeadline = 9\nwcet = 9"))
    answer = json.loads(CliRunner().invoke(app, ["schedule", str(path), "--json"]).stdout)
    assert answer["tasks"][0]["wcet_max"] == "0"
    assert not any("executes for 0" in line for line in answer["advice"])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--gantt", "set.gif"], "end its name in .png, .svg, .pdf"),
        (["--gantt", "set.png", "--until", "soon"], "expected a number"),
        (["--gantt", "set.png", "--until", "0"], "expected more than 0"),
        (["--gantt", "set.png", "--until", "1e999999999"], "expected a number"),
        (["--until", "60"], "name its file with --gantt"),
    ],
)
def test_a_picture_that_cannot_be_drawn_is_refused(
    options: list[str], message: str, tmp_path: Path
) -> None:
    """With the code of a wrong command line, before anything is written."""
    result = CliRunner().invoke(app, ["schedule", str(guide_set(tmp_path)), *options, "--json"])
    assert result.exit_code == 2
    assert message in json.loads(result.output)["error"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["schedule", "--json"], "Missing argument 'file'; see 'ravenbrick schedule --help'"),
        (["schedule", "set.toml", "--priorites", "x", "--json"], "Possible options: --priorities"),
        (["schedle", "set.toml", "--json"], "Did you mean 'schedule'?"),
    ],
)
def test_a_wrong_command_line_is_answered_in_json_too(arguments: list[str], message: str) -> None:
    result = CliRunner().invoke(app, arguments)
    answer = json.loads(result.stdout)
    assert (result.exit_code, answer["ok"], answer["exit_code"]) == (2, False, 2)
    assert message in answer["error"]


def test_an_interrupted_command_says_so_in_json(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def pressed(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("ravenbrick.cli.schedule.read_task_file", pressed)
    result = CliRunner().invoke(app, ["schedule", str(guide_set(tmp_path)), "--json"])
    answer = json.loads(result.stdout)
    assert (result.exit_code, answer["exit_code"], answer["error"]) == (130, 130, "interrupted")


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_an_output_that_takes_nothing_is_named(options: list[str], tmp_path: Path) -> None:
    """A full disk behind the standard output: one sentence, no traceback."""
    code = "from ravenbrick.cli import main; main()"
    command = [sys.executable, "-c", code, "schedule", str(guide_set(tmp_path)), *options]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("ravenbrick: the output: No space left on device; free space")
    assert done.stderr.count("\n") == 1


def test_a_picture_that_does_not_fit_leaves_nothing_behind(tmp_path: Path) -> None:
    picture = tmp_path / "set.png"
    picture.symlink_to("/dev/full")
    arguments = ["schedule", str(guide_set(tmp_path)), "--gantt", str(picture), "--json"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2
    assert f"{picture}: No space left on device" in json.loads(result.stdout)["error"]
