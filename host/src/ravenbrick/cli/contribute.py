# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick contribute`: a record for the open data."""

from __future__ import annotations

import datetime
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import UsageError, shown_path
from ravenbrick.image.elf import read_image
from ravenbrick.open_data.data_record import LICENCE, write_data_record
from ravenbrick.open_data.making import SELF_TEST, Origin, of_motor, of_self_test
from ravenbrick.schemas import schema
from ravenbrick.self_test.record import read_record, recorded_image
from ravenbrick.trace.recording import Recording

__all__ = ["contribute_command"]

BATTERIES = ", ".join(schema("record")["properties"]["battery"]["properties"]["kind"]["enum"])


class MotorRecord(StrEnum):
    """What a recording of a motor shows."""

    STEP = "step_response"
    IDENTIFICATION = "identification"


def _of_recording(
    source: Path, kind: MotorRecord, signals: str, motor: str, volts: float, origin: Origin
) -> dict[str, Any]:
    recording = Recording.load(source)
    voltage, colon, angle = signals.partition(":")
    if not (voltage and colon and angle):
        raise UsageError(f"--signals {signals}: expected VOLTAGE:ANGLE, the names of two signals")
    columns = recording.signal(voltage), recording.signal(angle)
    window = float(columns[1][0][0]), float(columns[1][0][-1])
    return of_motor(kind.value, *columns, window, motor, volts, origin)


@command("ravenbrick contribute my-brick.jsonl --by 'Ada L.' --battery nimh")
def contribute_command(
    source: Annotated[Path, typer.Argument(help="Self-test (.jsonl) or live recording (.npz).")],
    by: Annotated[str, typer.Option(help="Name of whoever took it, as it shall be published.")],
    battery: Annotated[str, typer.Option(help=f"Battery in the brick: {BATTERIES}.")],
    description: Annotated[str, typer.Option(help="Text about brick and motors.")] = "NXT",
    on: Annotated[str | None, typer.Option(help="Day, YYYY-MM-DD (default: today).")] = None,
    kind: Annotated[
        MotorRecord, typer.Option(help="Of a recording: what it shows.")
    ] = MotorRecord.IDENTIFICATION,
    image: Annotated[
        Path | None, typer.Option(help="Of a recording: the ELF file that ran.")
    ] = None,
    volts: Annotated[
        float | None, typer.Option(help="Of a recording: voltage of the battery (V).")
    ] = None,
    motor: Annotated[str, typer.Option(help="Of a recording: motor A, B or C.")] = "B",
    signals: Annotated[
        str, typer.Option(help="Of a recording: VOLTAGE:ANGLE, in V and encoder counts.")
    ] = "control:angle",
    output: Annotated[
        Path | None, typer.Option(help="File (default: the source's name with .json).")
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    day = on or datetime.date.today().isoformat()
    if source.suffix == ".npz":
        if image is None or volts is None:
            raise UsageError("a recording needs --image and --volts; add them")
        program, ran, brick = image.stem, read_image(image), "real"
    else:
        taken = read_record(source)
        program, ran = SELF_TEST, recorded_image(source, taken)
        brick = "real" if taken.source == "usb" else "virtual"
        if brick == "virtual":
            description = f"{description} ({taken.source})"
    origin = Origin(description, brick, program, ran, battery, by, day)
    if source.suffix == ".npz":
        values = _of_recording(source, kind, signals, motor, volts or 0.0, origin)
    else:
        values = of_self_test(taken, origin)
    file = output or source.with_suffix(".json")
    record = write_data_record(file, values)
    Reporter(json_output).print(
        f"{shown_path(file)}: {record.size} values; sending it publishes it under {LICENCE}"
    )
    return {"file": str(file), "kind": record.kind, "brick": brick, "values": record.size}
