# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick contribute`: a record of what a brick measured, and back to a comparison."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ravenbrick.cli.app import app
from ravenbrick.clock import Clock
from ravenbrick.errors import ExitCode
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ElfImage
from ravenbrick.open_data.data_record import read_data_record
from ravenbrick.open_data.making import loaded_digest
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace, tree
from ravenbrick.self_test.comparison import equipment
from ravenbrick.self_test.record import write_record
from ravenbrick.self_test.taking import from_virtual_brick
from ravenbrick.trace.recording import EVENT_TYPE, Recording, Signal, Stop

pytestmark = pytest.mark.usefixtures("self_test_runs")
WHO = ("--by", "Ada L.", "--battery", "nimh", "--on", "2026-11-26")


def called(*arguments: str) -> tuple[int, str]:
    """Exit code and output."""
    done = CliRunner().invoke(app, [*arguments])
    return done.exit_code, done.output


@pytest.fixture(scope="module")
def self_test() -> ElfImage:
    """The image that the owner of a brick uploads."""
    project = tree() / "examples" / "self-test"
    return build_image(Workspace.of(project), read_robot(project), "ram").image


def test_a_self_test_becomes_a_record_that_can_be_compared(
    self_test: ElfImage, tmp_path: Path
) -> None:
    """Every row, who and when; the altered parameter is found again from the record alone."""
    timing = {"pdc_steal_cycles": 4}
    taken = from_virtual_brick(self_test, {**equipment(), "timing": timing})
    file = tmp_path / "brick.jsonl"
    write_record(file, taken, self_test)
    code, output = called("contribute", str(file), *WHO)
    assert code == ExitCode.OK, output
    record = read_data_record(tmp_path / "brick.json")
    assert {row["name"]: row["value"] for row in record.values["rows"]} == {
        name: row.value for name, row in taken.rows.items()
    }
    assert record.values["brick"] == {"kind": "virtual"}
    assert record.values["taken"] == {"by": "Ada L.", "on": "2026-11-26"}
    assert record.values["program"]["sha256"] == loaded_digest(self_test)
    code, output = called("compare-brick", str(tmp_path / "brick.json"), "--json")
    answer = json.loads(output)
    assert (code, answer["timing"]) == (ExitCode.BRICK_DIFFERS, timing)


def recording(path: Path) -> Path:
    """What `monitor` leaves of a motor: 4 V from 1 s on."""
    clock = Clock(Fraction(1000))
    cycles = np.arange(0, 3000, 4, dtype=np.uint64)
    volts = np.where(cycles < 1000, 0.0, 4.0)
    counts = np.floor(np.maximum(cycles.astype(float) - 1000, 0) * 0.464)
    signals = {"control": Signal(cycles, volts), "angle": Signal(cycles, counts)}
    stop = Stop("reached", 3000, "")
    Recording("live", clock, stop, np.array([], EVENT_TYPE), signals, (), (), "").save(path)
    return path


def test_a_recording_of_a_motor_becomes_a_record(self_test: ElfImage, tmp_path: Path) -> None:
    """The voltage by its changes, the counts each 4 ms."""
    file = recording(tmp_path / "live.npz")
    given = ("--image", str(self_test.path), "--volts", "8.1", "--kind", "step_response")
    code, output = called("contribute", str(file), *WHO, *given)
    assert code == ExitCode.OK, output
    voltage, angle = read_data_record(tmp_path / "live.json").values["signals"]
    assert (voltage["time_s"], voltage["value"]) == ([0.0, 1.0], [0.0, 4.0])
    assert angle["time_s"][:3] == [0.0, 0.004, 0.008]
    assert angle["value"][angle["time_s"].index(2.0)] == 464


@pytest.mark.parametrize(
    ("name", "arguments", "sentence"),
    [
        ("live.npz", (), "a recording needs --image and --volts"),
        ("live.npz", ("--volts", "90"), "battery.voltage_V: is 90.0; expected at most 12"),
        ("live.npz", ("--volts", "8", "--on", "today"), "taken.on: is no day"),
        ("live.npz", ("--volts", "8", "--battery", "coal"), "battery.kind: is 'coal'; expected"),
        ("live.npz", ("--volts", "8", "--signals", "x"), "expected VOLTAGE:ANGLE"),
        ("none.jsonl", (), "none.jsonl: cannot be read"),
    ],
)
def test_what_is_wrong_is_named_and_nothing_is_written(
    name: str, arguments: tuple[str, ...], sentence: str, self_test: ElfImage, tmp_path: Path
) -> None:
    """The first line is the cause."""
    recording(tmp_path / "live.npz")
    image = ("--image", str(self_test.path)) if arguments else ()
    code, output = called("contribute", str(tmp_path / name), *WHO, *image, *arguments)
    assert code != ExitCode.OK and sentence in output
    assert not list(tmp_path.glob("*.json"))
