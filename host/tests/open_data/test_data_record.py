# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Contributed records: what is refused and how, and what the committed ones are good for."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from ravenbrick.catalogue import part_values
from ravenbrick.cli.app import app
from ravenbrick.control.estimation.identification import fit_motor, validate_motor
from ravenbrick.errors import DesignError, RecordError
from ravenbrick.open_data.data_record import read_data_record, write_data_record
from ravenbrick.open_data.making import self_test_of
from ravenbrick.project.workspace import tree

DATA = tree() / "data" / "virtual"


def record(name: str = "step-0001") -> dict[str, Any]:
    """The fields of a committed record."""
    fields: dict[str, Any] = json.loads((DATA / f"{name}.json").read_text("utf-8"))
    return fields


def test_the_committed_records_are_right_and_small() -> None:
    """Both bricks of each kind; the folder stays what a person can read."""
    files = sorted(DATA.glob("*.json"))
    kinds = [read_data_record(file).kind for file in files]
    assert {kind: kinds.count(kind) for kind in kinds} == {
        "identification": 4,
        "step_response": 2,
        "timing": 2,
    }
    assert sum(file.stat().st_size for file in files) < 200_000


def set_to(path: str, value: Any) -> Callable[[dict[str, Any]], None]:
    """A change of one field; the value `...` removes it."""

    def change(fields: Any) -> None:
        *outer, last = [int(p) if p.isdigit() else p for p in path.split(".")]
        for part in outer:
            fields = fields[part]
        if value is ...:
            del fields[last]
        else:
            fields[last] = value

    return change


WRONG = [
    ("battery.kind", "lead", "battery.kind: is 'lead'; expected one of"),
    ("battery", ..., "battery: is missing"),
    ("battery.voltage_V", 80, "battery.voltage_V: is 80; expected at most 12"),
    ("program.sha256", "f" * 63 + "G", "program.sha256: is no digest"),
    ("taken.on", "2026-13-01", "taken.on: is no day"),
    ("taken.by", "\x1b]0;owned\x07", "taken.by: has control characters"),
    ("licence", "MIT", "licence: is 'MIT'; expected 'CC0-1.0'"),
    ("brick.kind", "real", "brick.altered: belongs to virtual bricks"),
    ("brick.motor", ..., "brick.motor: is missing"),
    ("brick.altered.inertia", [1], "brick.altered.inertia: is no number"),
    ("signals.1.unit", "V", "signals[1].unit: is 'V'; 'angle' has the unit 'count'"),
    ("signals.1.time_s.7", 0.0, "signals[1].time_s[7]: is 0.0; expected more than"),
    ("signals.1.value.9", ..., "signals[1].value: has 524 values; 'time_s' has 525"),
    ("signals.0.value.0", 8000.0, "signals[0].value[0]: is 8000.0; expected at most 15"),
    ("signals.0.value.0", "8", "signals[0].value[0]: is '8'; expected a number"),
    ("signals.0.name", "angle", "signals: has angle, angle; expected voltage and angle"),
    ("signals", ..., "signals: is missing; a record of kind 'step_response' needs it"),
    ("kind", "timing", "rows: is missing; a record of kind 'timing' needs it"),
    ("colour", "red", "colour: unknown field"),
]


@pytest.mark.parametrize(("path", "value", "sentence"), WRONG)
def test_an_error_names_file_and_field(
    path: str, value: Any, sentence: str, tmp_path: Path
) -> None:
    """No control character is repeated; a wrong record is not written either."""
    fields = record()
    set_to(path, value)(fields)
    file = tmp_path / "wrong.json"
    with pytest.raises(RecordError):
        write_data_record(file, fields)
    assert not file.exists()
    file.write_text(json.dumps(fields, indent=1))
    with pytest.raises(RecordError) as error:
        read_data_record(file)
    assert sentence in error.value.sentence and "wrong.json:" in error.value.sentence
    assert "\x1b" not in error.value.sentence + str(error.value.detail)


def test_an_error_names_the_line(tmp_path: Path) -> None:
    """That of the field."""
    file = tmp_path / "wrong.json"
    text = (DATA / "step-0001.json").read_text("utf-8")
    file.write_text(text.replace('"li_ion"', '"lead"'))
    line = text[: text.index('"li_ion"')].count("\n") + 1
    with pytest.raises(RecordError, match=rf"wrong.json:{line}: battery.kind"):
        read_data_record(file)


HOSTILE = {
    "deep": b"[" * 100_000,
    "deep object": b'{"a":' * 900 + b"1" + b"}" * 900,
    "not a number": b'{"a": NaN}',
    "too large a number": b'{"a": 1e999}',
    "many digits": b'{"a": ' + b"9" * 10_000 + b"}",
    "not UTF-8": b'{"a": "\xff"}',
    "surrogate": b'{"a": "\\ud800"}',
    "a list": b"[]",
    "empty": b"",
    "many values": b'{"signals": [' + b"0," * 400_000 + b"0]}",
}


@pytest.mark.parametrize("content", HOSTILE.values(), ids=HOSTILE)
def test_hostile_files_are_refused(content: bytes, tmp_path: Path) -> None:
    """With a sentence, and at most a hundred more."""
    file = tmp_path / "hostile.json"
    file.write_bytes(content)
    with pytest.raises(RecordError, match=r"hostile\.json") as refused:
        read_data_record(file)
    assert refused.value.detail.count("\n") < 100


def test_a_large_file_is_refused_before_it_is_read(tmp_path: Path) -> None:
    """Even one that would be right."""
    file = tmp_path / "large.json"
    file.write_bytes((DATA / "step-0000.json").read_bytes() + b" " * 1_000_000)
    with pytest.raises(RecordError, match="expected a file of at most 1,000,000 bytes"):
        read_data_record(file)


def test_a_motor_that_was_not_driven_is_not_fitted(tmp_path: Path) -> None:
    """Its record is right, its voltage is 0."""
    fields = record("identification-0000")
    fields["signals"][0] |= {"time_s": [0.0], "value": [0.0]}
    file = tmp_path / "still.json"
    write_data_record(file, fields)
    with pytest.raises(DesignError):
        read_data_record(file).motor_data()


def test_what_is_no_file_is_refused() -> None:
    """A device would be read for ever."""
    for name in ("/dev/zero", "/nowhere/x.json", str(DATA)):
        with pytest.raises(RecordError):
            read_data_record(Path(name))


def test_a_motor_is_found_in_its_record() -> None:
    """The joint intervals hold the values that follow from the altered constants."""
    found = fit_motor(read_data_record(DATA / "identification-0001.json").motor_data())
    check = read_data_record(DATA / "identification-check-0001.json").motor_data()
    assert validate_motor(found, check).error < 1.0
    c = {**part_values("motors", "nxt"), **record("identification-0001")["brick"]["altered"]}
    damping = (
        c["viscous_friction"] * c["resistance"] + c["torque_constant"] * c["electric_constant"]
    )
    true = {
        "gain": c["torque_constant"] / damping,
        "time_constant": c["inertia"] * c["resistance"] / damping,
        "friction_voltage": c["resistance"] * c["coulomb_friction"] / c["torque_constant"],
    }
    for one in found.parameters:
        assert one.low <= true[one.name] <= one.high, one.name


def test_a_record_of_a_motor_has_no_timing() -> None:
    """And the other way round."""
    with pytest.raises(RecordError, match="not a motor's"):
        read_data_record(DATA / "timing-0000.json").motor_data()
    with pytest.raises(RecordError, match="a comparison needs 'timing'"):
        self_test_of(read_data_record(DATA / "step-0000.json"))


def called(*arguments: str) -> tuple[int, str]:
    """Exit code and output."""
    done = CliRunner().invoke(app, [*arguments])
    return done.exit_code, done.output


def test_all_files_are_checked(tmp_path: Path) -> None:
    """The first wrong one is the error, the others its detail; the right ones are listed."""
    for number in range(3):
        fields = record("timing-0000")
        if number:
            fields["licence"] = f"own {number}"
        (tmp_path / f"{number}.json").write_text(json.dumps(fields))
    code, output = called("check-data", str(tmp_path), "--json")
    assert code == 6
    assert "1.json:1: licence" in json.loads(output)["error"]
    assert "2.json:1: licence" in json.loads(output)["detail"]
    code, output = called("check-data", str(tmp_path / "0.json"))
    assert code == 0 and "timing" in output
