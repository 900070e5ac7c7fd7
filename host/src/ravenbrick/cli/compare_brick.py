# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick compare-brick`: the self-test of a brick, taken and compared."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import (
    BrickDiffersError,
    ConnectionFailedError,
    UsageError,
    shown_path,
)
from ravenbrick.hardware.upload import brick_to_load, load
from ravenbrick.hardware.usb_bricks import find_bricks
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ElfImage
from ravenbrick.image.raw_binary import flat_image
from ravenbrick.json_values import json_values
from ravenbrick.open_data.data_record import read_data_record
from ravenbrick.open_data.making import loaded_digest, self_test_of
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace, tree
from ravenbrick.self_test.comparison import Comparison, compare, equipment, verdict
from ravenbrick.self_test.parameters import INSEPARABLE, PARAMETERS, UNSEEN
from ravenbrick.self_test.record import Record, read_record, recorded_image, write_record
from ravenbrick.self_test.taking import from_real_brick, from_virtual_brick
from ravenbrick.telemetry.links import Link, LinkLostError, open_link

__all__ = ["compare_brick_command"]

PROJECT = "examples/self-test"
APPEAR_S = 30.0
RETRY_S = 0.5


class Source(StrEnum):
    """Where a record is taken."""

    USB = "usb"
    VIRTUAL = "virtual"


def _assignment(text: str) -> tuple[str, Any]:
    names = [*(parameter.name for parameter in PARAMETERS), *UNSEEN, *INSEPARABLE]
    name, equals, value = text.partition("=")
    if not equals or name not in names:
        raise UsageError(f"--alter {text}: expected NAME=VALUE; the names are {', '.join(names)}")
    try:
        return name, json_values(value)
    except ValueError:
        return name, value


def _self_test_image(reporter: Reporter) -> ElfImage:
    project = tree() / PROJECT
    with reporter.step("build the self-test") as step:
        image = build_image(Workspace.of(project), read_robot(project), "ram").image
        step.note = shown_path(image.path)
    return image


def _link_to_program() -> Link:
    """The link to the program that has just been started, which first appears on the USB."""
    end = time.monotonic() + APPEAR_S
    while True:
        try:
            return open_link("usb")
        except LinkLostError as error:
            if time.monotonic() > end:
                raise ConnectionFailedError(
                    f"the self-test was loaded but does not appear on the USB: {error}; note what "
                    "the brick's display shows, switch it off and try again"
                ) from None
        time.sleep(RETRY_S)


def _from_usb(image: ElfImage, reporter: Reporter) -> Record:
    brick_to_load(find_bricks())
    with reporter.step("load it into the brick's RAM") as step:
        load(flat_image(image), "ram")
        step.note = "it runs; its display says what to plug in"
    link = _link_to_program()
    try:
        with reporter.step("wait for the record") as step:
            record = from_real_brick(link, image, reporter.print)
            step.note = f"{len(record.rows)} rows"
    except LinkLostError as error:
        raise ConnectionFailedError(f"the record broke off: {error}; take it again") from None
    finally:
        link.close()
    return record


def _take(source: Source, altered: dict[str, Any], reporter: Reporter) -> tuple[Record, ElfImage]:
    image = _self_test_image(reporter)
    if source is Source.USB:
        return _from_usb(image, reporter), image
    with reporter.step("run it on the virtual brick") as step:
        record = from_virtual_brick(image, {**equipment(), "timing": altered})
        step.note = f"{len(record.rows)} rows"
    if altered:
        changes = ", ".join(f"{name} = {value}" for name, value in altered.items())
        record = replace(record, source=f"{record.source}, altered: {changes}")
    return record, image


def _shown(value: float) -> str:
    return f"{value:,.3f}".rstrip("0").rstrip(".")


def _print(reporter: Reporter, comparison: Comparison) -> None:
    reporter.table(
        ("row", "unit", "measured", "virtual", "difference", "tolerance", "verdict"),
        [
            [
                row.row,
                row.unit,
                _shown(row.measured),
                _shown(row.virtual),
                _shown(row.measured - row.virtual),
                "" if row.tolerance is None else _shown(row.tolerance),
                _row_verdict(row.tolerance, row.agrees, row.explained),
            ]
            for row in comparison.rows
        ],
        left=("unit", "verdict"),
    )
    for name, reason in comparison.missing.items():
        reporter.print(f"not measured: {name} ({reason})")
    reporter.print("")
    reporter.table(
        ("parameter", "virtual", "measured", "verdict"),
        [
            [
                estimate.parameter.name,
                str(estimate.parameter.nominal),
                " or ".join(str(value) for value in estimate.values),
                verdict(estimate),
            ]
            for estimate in comparison.estimates
        ],
        left=("verdict",),
    )
    for name, reason in {**UNSEEN, **INSEPARABLE}.items():
        reporter.print(f"not seen by the self-test: {name} ({reason})")
    if comparison.timing:
        reporter.print(
            f'\nin the brick\'s configuration: "timing": {json.dumps(comparison.timing)}'
        )


def _row_verdict(tolerance: float | None, agrees: bool, explained: bool) -> str:
    if tolerance is None:
        return "shown only"
    return "agrees" if agrees else "explained" if explained else "DIFFERS"


def _judge(comparison: Comparison, data: dict[str, Any]) -> None:
    """Raise `BrickDiffersError` unless everything agrees."""
    moved = [f"{name} = {value}" for name, value in comparison.timing.items()]
    if not moved and not comparison.unexplained:
        return
    parts = []
    if moved:
        parts.append(f"parameters moved: {', '.join(moved)}")
    if comparison.unexplained:
        parts.append(f"rows that no parameter explains: {', '.join(comparison.unexplained)}")
    error = BrickDiffersError(f"the brick differs from the virtual brick; {'; '.join(parts)}")
    error.data = data
    raise error


@command("ravenbrick compare-brick my-brick.jsonl --take usb")
def compare_brick_command(
    record: Annotated[
        Path, typer.Argument(help="File of the record; --take writes it; .json: open data.")
    ],
    take: Annotated[
        Source | None,
        typer.Option(help="Take the record first: from the brick on the USB, or a virtual one."),
    ] = None,
    alter: Annotated[
        list[str] | None,
        typer.Option(help="Timing parameter of the virtual brick, NAME=VALUE; repeatable."),
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    reporter = Reporter(json_output)
    if alter and take is not Source.VIRTUAL:
        raise UsageError("--alter changes the virtual brick; use it with '--take virtual'")
    if record.suffix == ".elf":
        raise UsageError(f"{record}: the image is saved under this name; name the record otherwise")
    if take is not None and record.suffix == ".json":
        raise UsageError(f"{record}: 'contribute' writes .json; name the record .jsonl")
    if take is None and record.suffix == ".json":
        taken = self_test_of(read_data_record(record))
        image = _self_test_image(reporter)
        if loaded_digest(image) != taken.image:
            reporter.print("the record was taken with another image of the self-test")
    elif take is None:
        taken = read_record(record)
        image = recorded_image(record, taken)
    else:
        taken, image = _take(take, dict(map(_assignment, alter or ())), reporter)
        write_record(record, taken, image)
    with reporter.step("run it with other timing parameters") as step:
        comparison = compare(taken, image, step.progress)
        step.note = f"{len(comparison.estimates)} parameters estimated"
    _print(reporter, comparison)
    data = {"record": str(record), "source": taken.source, **comparison.data()}
    _judge(comparison, data)
    return data
