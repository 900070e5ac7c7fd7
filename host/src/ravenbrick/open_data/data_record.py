# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A contributed record: read, checked against the schema, written.

A record may come from anybody: its size is limited before it is read, numbers are finite, texts
are printable, and an error names file, line and field without control characters.
"""

from __future__ import annotations

import datetime
import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ravenbrick.atomic_write import atomic_write
from ravenbrick.control.estimation.identification import MotorData
from ravenbrick.errors import ProjectFileError, RecordError, shown_path
from ravenbrick.schemas.located_json import read_json
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml
from ravenbrick.schemas.validation import validate

__all__ = ["LICENCE", "UNITS", "VERSION", "DataRecord", "read_data_record", "write_data_record"]

VERSION = 1
LICENCE = "CC0-1.0"
LARGEST_BYTES = 1_000_000
UNITS = {"voltage": "V", "angle": "count"}
_DIGEST = re.compile(r"[0-9a-f]{64}\Z")
# A motor on a bench: what is beyond is a wrong unit.
_LARGEST = {"voltage": 15.0, "angle": 1e7, "time_s": 3600.0, "value": 1e9}

Complaint = tuple[KeyPath, str]


@dataclass(frozen=True)
class DataRecord:
    """The checked fields of a record, as in the file."""

    values: dict[str, Any]

    @property
    def kind(self) -> str:
        """`step_response`, `identification` or `timing`."""
        return str(self.values["kind"])

    @property
    def size(self) -> int:
        """Rows, or samples of all signals."""
        rows = len(self.values.get("rows", ()))
        return rows + sum(len(s["value"]) for s in self.values.get("signals", ()))

    def motor_data(self) -> MotorData:
        """Counts, and voltages from the first one on, as `identify` fits them.

        Raises `RecordError` for the timing of a brick, and `DesignError` for too few samples.
        """
        if self.kind == "timing":
            raise RecordError(
                "this record has the timing of a brick, not a motor's voltage and angle"
            )
        signals = {s["name"]: s for s in self.values["signals"]}
        angle, voltage = signals["angle"], signals["voltage"]
        columns = (angle["time_s"], angle["value"], voltage["time_s"], voltage["value"])
        times, counts, changes, volts = (np.array(c, dtype=np.float64) for c in columns)
        driven = np.flatnonzero(volts)
        first = int(driven[0]) if driven.size else len(volts)
        return MotorData(times, counts, changes[first:], volts[first:])


def _texts_and_numbers(value: Any, path: KeyPath = ()) -> Iterator[Complaint]:
    if isinstance(value, str) and not value.isprintable():
        yield path, "has control characters; write printable text"
    elif isinstance(value, float) and not math.isfinite(value):
        yield path, "is no finite number; leave the sample out"
    elif isinstance(value, int) and not isinstance(value, bool) and abs(value) > 1 << 53:
        yield path, "is too large; expected a measured number"
    elif isinstance(value, dict):
        for name, part in value.items():
            if not name.isprintable() or len(name) > 80:
                yield path, "has a name that is no printable word; remove it"
                return
            yield from _texts_and_numbers(part, (*path, name))
    elif isinstance(value, list):
        for index, part in enumerate(value):
            yield from _texts_and_numbers(part, (*path, index))


def _signals(signals: list[dict[str, Any]]) -> Iterator[Complaint]:
    for index, signal in enumerate(signals):
        path: KeyPath = ("signals", index)
        name, times, values = signal["name"], signal["time_s"], signal["value"]
        if signal["unit"] != UNITS[name]:
            yield (*path, "unit"), f"is '{signal['unit']}'; '{name}' has the unit '{UNITS[name]}'"
        if len(times) != len(values):
            text = f"has {len(values)} values; 'time_s' has {len(times)}"
            yield (*path, "value"), text
        for place, (before, after) in enumerate(pairwise(times), 1):
            if after <= before:
                yield (*path, "time_s", place), f"is {after}; expected more than {before} before it"
                break
        for column, limit in (("time_s", _LARGEST["time_s"]), ("value", _LARGEST[name])):
            large = [place for place, v in enumerate(signal[column]) if abs(v) > limit]
            for place in large[:1]:
                text = f"is {signal[column][place]}; expected at most {limit:g} in this unit"
                yield (*path, column, place), text


def _is_day(text: str) -> bool:
    try:
        return datetime.date.fromisoformat(text).isoformat() == text
    except ValueError:
        return False


def _meaning(values: dict[str, Any]) -> Iterator[Complaint]:
    """What the schema cannot say."""
    timing = values["kind"] == "timing"
    wanted, other = ("rows", "signals") if timing else ("signals", "rows")
    if wanted not in values:
        yield (wanted,), f"is missing; a record of kind '{values['kind']}' needs it"
    if other in values:
        yield (other,), f"does not belong to a record of kind '{values['kind']}'; remove it"
    names = [signal["name"] for signal in values.get("signals", ())]
    if names and sorted(names) != sorted(UNITS):
        yield ("signals",), f"has {', '.join(names)}; expected voltage and angle, once each"
    if not timing and "motor" not in values["brick"]:
        yield ("brick", "motor"), "is missing; name the motor's port, A, B or C"
    yield from _signals(values.get("signals", []))
    seen: set[str] = set()
    for index, row in enumerate(values.get("rows", ())):
        if row["name"] in seen:
            yield ("rows", index, "name"), "is there twice; leave one row"
        seen.add(row["name"])
        if abs(row["value"]) > _LARGEST["value"]:
            yield ("rows", index, "value"), f"is {row['value']}; expected at most 1e9"
    if not _DIGEST.match(values["program"]["sha256"]):
        yield ("program", "sha256"), "is no digest; expected 64 hexadecimal digits, small letters"
    for name in ("altered", "seed"):
        if name in values["brick"] and values["brick"]["kind"] == "real":
            yield ("brick", name), "belongs to virtual bricks; remove it"
    for name, value in values["brick"].get("altered", {}).items():
        if isinstance(value, dict | list) or value is None:
            yield ("brick", "altered", name), "is no number, text or truth value"
    if not _is_day(values["taken"]["on"]):
        yield ("taken", "on"), "is no day; expected YYYY-MM-DD"


def _checked(document: LocatedToml) -> DataRecord:
    """Raises `ProjectFileError` for the first wrong field; the others are in its detail."""
    for stage in (_texts_and_numbers, None, _meaning):
        if stage is None:
            validate(document, "record")
            continue
        found = [document.error(path, text) for path, text in stage(document.values)]
        if found:
            found[0].detail = "\n".join(error.sentence for error in found[1:20])
            raise found[0]
    return DataRecord(document.values)


def _refused(error: ProjectFileError) -> RecordError:
    refused = RecordError(error.sentence)
    refused.detail = error.detail
    return refused


def read_data_record(path: Path) -> DataRecord:
    """A record of anybody; raises `RecordError`, which names file, line and field."""
    try:
        if path.stat().st_size > LARGEST_BYTES or not path.is_file():
            limit = f"expected a file of at most {LARGEST_BYTES:,} bytes"
            raise RecordError(f"{shown_path(path)}: {limit}")
        return _checked(read_json(path, "a record", parse_float=float))
    except RecursionError:
        raise RecordError(f"{shown_path(path)}: nested too deeply; write a record") from None
    except OSError as error:
        problem = f"cannot be read ({error.strerror}); name a record"
        raise RecordError(f"{shown_path(path)}: {problem}") from None
    except ProjectFileError as error:
        raise _refused(error) from None


def write_data_record(path: Path, values: dict[str, Any]) -> DataRecord:
    """Check a record, and write it with all samples of a signal on one line.

    Raises `RecordError`, and then writes nothing.
    """
    try:
        record = _checked(LocatedToml(path, values, {}))
    except ProjectFileError as error:
        raise _refused(error) from None
    text = json.dumps(values, indent=1, ensure_ascii=False, allow_nan=False)
    text = re.sub(r"\[\s+(-?\d[-+.,\se\d]*?)\s+\]", _one_line, text)
    atomic_write(path, f"{text}\n".encode())
    return record


def _one_line(numbers: re.Match[str]) -> str:
    return "[" + ",".join(number.strip() for number in numbers[1].split(",")) + "]"
