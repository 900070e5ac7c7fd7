# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick run` for graders, stimuli and replay, and `ravenbrick export`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result
from verification.support.bricks import fake_brick

from ravenbrick.brick import run as virtual
from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.recording import Recording

Edit = Callable[[str, str, str], int]
DRIVE = "scenarios/drive.toml"


@pytest.fixture(autouse=True)
def brick(monkeypatch: pytest.MonkeyPatch) -> None:
    """A brick whose answers are known."""
    monkeypatch.setattr(virtual, "brick_module", lambda: fake_brick)


def call(*arguments: object) -> Result:
    """Run the command line."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def answer(result: Result, code: ExitCode = ExitCode.OK) -> dict[str, Any]:
    """The JSON of a command that ended with `code`."""
    assert result.exit_code == code, result.output
    loaded: dict[str, Any] = json.loads(result.stdout)
    return loaded


def grade(project: Path, *expectations: str) -> Result:
    """Run the drive with expectations."""
    options = [part for text in expectations for part in ("--expect", text)]
    return call("run", project, "drive", *options, "--json")


def test_every_expectation_is_listed_with_value_and_verdict(project: Path) -> None:
    """After the scenario's own criteria, in the order of the command line."""
    given = answer(grade(project, 'lcd shows "vehicle.adb:12"', "body.x at least 2 m at the end"))
    lcd, path = given["criteria"][-2:]
    assert (lcd["expectation"], lcd["value"]) == ('lcd shows "vehicle.adb:12"', "vehicle.adb:12")
    assert path["value"] == pytest.approx(4.06, abs=0.01)
    assert lcd["met"] and path["met"]


def test_an_expectation_that_is_not_met_lists_all_of_them(project: Path) -> None:
    """Exit code 8, and the JSON still has every value and verdict."""
    given = answer(grade(project, "no fault", 'lcd shows "done"'), ExitCode.CRITERIA_NOT_MET)
    assert given["ok"] is False
    assert [c["met"] for c in given["criteria"][-2:]] == [True, False]
    assert 'expected lcd shows "done", found vehicle.adb:12' in given["error"]


def test_expectations_stand_in_scenarios_too(project: Path, edit: Edit) -> None:
    """A criterion in words fails with the line of the scenario."""
    line = edit(DRIVE, '[[criteria]]\nmeasure = "distance"\nminimum = 3.0',
                '[[criteria]]\nexpect = "body.x at least 9 m at the end"')  # fmt: skip
    given = answer(grade(project), ExitCode.CRITERIA_NOT_MET)
    assert f"drive.toml:{line + 1}: expected body.x at least 9 m" in given["error"]


def test_a_misspelt_expectation_in_a_scenario_names_its_line(project: Path, edit: Edit) -> None:
    """Exit code 3."""
    line = edit(DRIVE, '[[criteria]]\nmeasure = "distance"\nminimum = 3.0',
                '[[criteria]]\nexpect = "body.x is large"')  # fmt: skip
    given = answer(grade(project), ExitCode.PROJECT_FILE)
    assert f"drive.toml:{line + 1}: criteria[2].expect: " in given["error"]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("the robot is fast", ExitCode.USAGE),
        ("no-such-file.toml", ExitCode.USAGE),
        ("body.x at least 1 m at 21 s", ExitCode.SCENARIO_UNREACHABLE),
        ("body.x at least 1 m at 19.5 s", ExitCode.SCENARIO_UNREACHABLE),
        ("body.z at least 1", ExitCode.SCENARIO_UNREACHABLE),
    ],
)
def test_each_kind_of_wrong_expectation_has_its_exit_code(
    project: Path, text: str, code: ExitCode
) -> None:
    """Unreadable is 2; beyond the duration, after power-off or not recorded is 9."""
    assert "defect" not in answer(grade(project, text), code)["error"]


def test_a_fault_ends_the_command_unless_it_is_judged(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit code 7; with an expectation about faults 8."""
    monkeypatch.setattr(fake_brick.VirtualBrick, "fault_ms", 700)
    answer(grade(project), ExitCode.RUN_FAULT)
    given = answer(grade(project, "no fault"), ExitCode.SCENARIO_UNREACHABLE)
    assert "lateral_deviation" in given["error"]
    file = project / DRIVE
    file.write_text(file.read_text().split("[[criteria]]")[0])
    given = answer(grade(project, "no fault"), ExitCode.CRITERIA_NOT_MET)
    assert "unmodelled register 0xFFFA0000" in given["criteria"][0]["value"]
    answer(grade(project, 'a fault saying "0xFFFA0000"'))


def test_stimuli_are_recorded_and_replayed(project: Path, tmp_path: Path) -> None:
    """The recording alone gives the same digest again."""
    file = tmp_path / "hand.csv"
    file.write_text("time_s,motor.A.hand_angle\n9.95,0.2\n9.97,0\n")
    first = answer(call("run", project, "drive", "--stimulus", file, "--json"))
    kept = tmp_path / "kept.npz"
    Path(first["recording"]).rename(kept)
    turned = [i for i in Recording.load(kept).inputs if i.value == 0.2]
    assert [(i.at_cycles, i.name) for i in turned] == [
        (-(-9950 * 336_384 // 7), "motor.A.hand_angle")
    ]
    plain = answer(call("run", project, "drive", "--json"))
    again = answer(call("run", project, "drive", "--replay", kept, "--json"))
    assert again["same_as_replayed"] is True
    assert again["trace_digest"] == first["trace_digest"] != plain["trace_digest"]


CALLBACK = """
def steer(moment):
    if moment.cycles == moment_of(9_950):
        assert moment.signal("motor.B.encoder") > 0 and moment.lcd[0] == "vehicle.adb:12"
        return {"motor.A.hand_angle": 0.3}

def moment_of(ms):
    return -(-ms * 336_384 // 7)

def crash(moment):
    return 1 / 0

def nonsense(moment):
    return 5

def unheard(moment):
    return [("unheard.1", 1)]
"""


def test_a_callback_is_recorded_and_replayed_without_it(project: Path, tmp_path: Path) -> None:
    """What it returned is an input at that very instant."""
    module = tmp_path / "hand.py"
    module.write_text(CALLBACK)
    first = answer(call("run", project, "drive", "--callback", f"{module}:steer", "--json"))
    kept = tmp_path / "kept.npz"
    Path(first["recording"]).rename(kept)
    (turned,) = [i for i in Recording.load(kept).inputs if i.value == 0.3]
    assert (turned.at_cycles, turned.name) == (-(-9950 * 336_384 // 7), "motor.A.hand_angle")
    module.unlink()
    again = answer(call("run", project, "drive", "--replay", kept, "--json"))
    assert again["same_as_replayed"] is True


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("crash", "hand.py:11: "),
        ("nonsense", "returned 5 at 0.000000 s; return a mapping"),
        ("unheard", "returned what is refused: unknown input unheard.1"),
        ("absent", "has no function 'absent'"),
        ("not-a-name", "is not of the form module:function"),
    ],
)
def test_a_wrong_callback_names_file_and_line(
    project: Path, tmp_path: Path, name: str, problem: str
) -> None:
    """Exit code 2, no traceback."""
    module = tmp_path / "hand.py"
    module.write_text(CALLBACK)
    result = call("run", project, "drive", "--callback", f"{module}:{name}", "--json")
    assert problem in answer(result, ExitCode.USAGE)["error"]


def test_a_project_file_cannot_name_a_callback(project: Path, edit: Edit) -> None:
    """Code runs only when the user names it on the command line."""
    edit(DRIVE, "[straight]", '[[stimuli]]\ncallback = "os:system"\n\n[straight]')
    assert "unknown field" in answer(grade(project), ExitCode.PROJECT_FILE)["error"]


@pytest.mark.parametrize("file_format", ["perfetto", "vcd", "mcap", "csv", "parquet"])
def test_a_project_exports_its_last_recording(project: Path, file_format: str) -> None:
    """The files lie with the results; the answer names them."""
    answer(call("run", project, "step", "--json"), ExitCode.OK)
    given = answer(call("export", project, "step", "--format", file_format, "--json"))
    folder = Workspace.of(project).results / "exports"
    for written in given["files"]:
        assert Path(written["file"]).parent == folder
        assert Path(written["file"]).stat().st_size == written["bytes"] > 1000


def test_export_says_what_is_missing(project: Path, tmp_path: Path) -> None:
    """No recording, no scenario, a scenario too many, a file that is none."""
    missing = answer(call("export", project, "drive", "--json"), ExitCode.USAGE)
    assert "run it with 'ravenbrick run" in missing["error"]
    assert "name a scenario" in answer(call("export", project, "--json"), ExitCode.USAGE)["error"]
    broken = tmp_path / "broken.npz"
    broken.write_bytes(b"nothing")
    assert "not a recording" in answer(call("export", broken, "--json"), ExitCode.USAGE)["error"]
    both = answer(call("export", broken, "drive", "--json"), ExitCode.USAGE)
    assert "omit 'drive'" in both["error"]
