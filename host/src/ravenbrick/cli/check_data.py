# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick check-data`: records of bricks against their schema."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import RecordError, UsageError, shown_path
from ravenbrick.open_data.data_record import read_data_record

__all__ = ["check_data_command"]


def _files(places: list[Path]) -> list[Path]:
    files: list[Path] = []
    for place in places:
        inside = sorted(place.rglob("*.json")) if place.is_dir() else [place]
        if not inside:
            raise UsageError(f"{shown_path(place)}: has no record (*.json); name files or folders")
        files += inside
    return files


@command("ravenbrick check-data data")
def check_data_command(
    records: Annotated[list[Path], typer.Argument(help="Records, or folders with records.")],
    json_output: JsonOption = False,
) -> dict[str, Any]:
    reporter = Reporter(json_output)
    found: list[dict[str, Any]] = []
    wrong: list[RecordError] = []
    for file in _files(records):
        try:
            record = read_data_record(file)
        except RecordError as error:
            wrong.append(error)
            continue
        brick = record.values["brick"]
        found.append(
            {
                "file": str(file),
                "kind": record.kind,
                "brick": brick["kind"],
                "altered": bool(brick.get("altered")),
                "values": record.size,
            }
        )
    reporter.table(
        ("record", "kind", "brick", "values"),
        [
            [
                row["file"],
                row["kind"],
                row["brick"] + " altered" * row["altered"],
                str(row["values"]),
            ]
            for row in found
        ],
        left=("kind", "brick"),
    )
    if wrong:
        first = wrong[0]
        others = [first.detail, *(error.sentence for error in wrong[1:])]
        first.detail = "\n".join(filter(None, others))
        raise first
    return {"records": found}
