# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The record of a self-test: a header of the host, then the brick's own JSON lines."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import ImageFileError, RecordError, shown_path
from ravenbrick.image.elf import ElfImage, read_image

__all__ = ["PARTS", "Record", "Row", "parse_lines", "read_record", "recorded_image", "write_record"]

VERSION = 1
PARTS = ("timing", "test")
"""What the brick finishes, in this order."""


@dataclass(frozen=True)
class Row:
    """A measured value with its unit, as the brick names it."""

    value: float
    unit: str


@dataclass(frozen=True)
class Record:
    """What a brick measured; `skipped` has the reasons of rows that it did not measure."""

    source: str
    image: str
    rows: Mapping[str, Row]
    skipped: Mapping[str, str]
    lines: tuple[str, ...] = field(repr=False, default=())


def parse_lines(lines: Iterable[str], source: str, image: str) -> Record:
    """The record in the brick's lines; raises `ValueError` naming the line (1-based)."""
    rows: dict[str, Row] = {}
    skipped: dict[str, str] = {}
    kept = tuple(lines)
    finished = []
    for number, line in enumerate(kept, 1):
        try:
            entry: dict[str, Any] = json.loads(line)
            if "row" in entry:
                rows[entry["row"]] = Row(float(entry["value"]), entry["unit"])
            elif "skipped" in entry:
                skipped[entry["skipped"]] = entry["reason"]
            elif "finished" in entry:
                finished.append(entry["finished"])
            elif entry.get("self_test") != VERSION:
                raise ValueError(f"is of version {entry.get('self_test')}, not {VERSION}")
        except (AttributeError, KeyError, RecursionError, TypeError, json.JSONDecodeError):
            raise ValueError(f"line {number} is not of a self-test: {line[:60]!r}") from None
        except ValueError as error:
            raise ValueError(f"line {number} {error}") from None
    if PARTS[0] not in finished:
        raise ValueError("ends before the part 'timing' is finished")
    return Record(source, image, rows, skipped, kept)


def write_record(path: Path, record: Record, image: ElfImage) -> None:
    """Write the record, and beside it the image that was run, for later comparisons."""
    header = {"record": VERSION, "source": record.source, "image": record.image}
    text = "\n".join([json.dumps(header), *record.lines]) + "\n"
    atomic_write(path, text.encode())
    atomic_write(path.with_suffix(".elf"), image.content)


def read_record(path: Path) -> Record:
    """A saved record; raises `RecordError`."""
    try:
        first, *lines = path.read_text().splitlines() or [""]
        header = json.loads(first)
        if header["record"] != VERSION:
            raise ValueError(f"the record is of version {header['record']}, not {VERSION}")
        return parse_lines(lines, header["source"], header["image"])
    except OSError as error:
        problem = f"cannot be read ({error.strerror}); '--take usb' writes it"
    except (KeyError, RecursionError, TypeError, json.JSONDecodeError, UnicodeDecodeError):
        problem = "is not a record of a self-test: its first line has no 'record'"
    except ValueError as error:
        problem = str(error)
    raise RecordError(f"{shown_path(path)}: {problem}")


def recorded_image(path: Path, record: Record) -> ElfImage:
    """The image beside the record; raises `ImageFileError` when it is another."""
    image = read_image(path.with_suffix(".elf"))
    if image.digest != record.image:
        raise ImageFileError(
            f"{shown_path(image.path)}: is not the image with which {path.name} was taken; take "
            "the record again"
        )
    return image
