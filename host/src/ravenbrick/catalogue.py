# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The tree's `catalogue/`: motors, bodies, batteries and sensors, each constant once.

`parts.json` has the entries that a `robot.toml` names, `sensors.json` what a sensor port takes,
`trace.json` the numbers in traces, which crate `trace`, this package and the page share.
An installed package has its own copy: code and catalogue always fit together.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

__all__ = [
    "SensorInput",
    "SensorKind",
    "event_numbers",
    "interrupt_sources",
    "part_source",
    "part_values",
    "parts",
    "sensor_input",
    "sensor_kinds",
]

_PACKAGE = Path(__file__).resolve().parent
_FOLDERS = (_PACKAGE.parents[2] / "catalogue", _PACKAGE / "tree" / "catalogue")


@dataclass(frozen=True)
class SensorInput:
    """An input of a sensor, in SI units; `{port}` in `name` stands for the port's number.

    `measured`: the plant gives it instead when the sensor sits on the robot.
    """

    name: str
    lowest: float
    highest: float
    unit: str
    measured: bool


@dataclass(frozen=True)
class SensorKind:
    """A kind of sensor: its optional fields in `robot.toml`, and its inputs.

    `looks_at` is the table of `robot.toml` that a sensor with a `mount` measures.
    """

    name: str
    description: str
    fields: tuple[str, ...]
    looks_at: str | None
    inputs: tuple[SensorInput, ...]


@cache
def _content(name: str) -> dict[str, Any]:
    folder = next((folder for folder in _FOLDERS if folder.is_dir()), _FOLDERS[0])
    content: dict[str, Any] = json.loads((folder / name).read_text("utf-8"))
    return content


def parts(group: str) -> Mapping[str, Mapping[str, Any]]:
    """The entries of `motors`, `bodies` or `batteries`, as tables of `robot.toml` have them."""
    entries = _content("parts.json")[group]
    return {
        name: {key: value for key, value in entry.items() if key != "description"}
        for name, entry in entries.items()
    }


def part_values(group: str, name: str) -> dict[str, float]:
    """The constants of an entry in SI units, without tolerances and sources."""
    entry = parts(group)[name]
    return {key: float(q["value"]) for key, q in entry.items() if isinstance(q, dict)}


def part_source(group: str, name: str) -> str:
    """What an entry describes, and where its constants come from as a whole."""
    return str(_content("parts.json")[group][name]["description"])


@cache
def sensor_kinds() -> Mapping[str, SensorKind]:
    """The kinds of sensors that `robot.toml` may plug in, by name."""
    return {
        name: SensorKind(
            name,
            entry["description"],
            tuple(entry.get("fields", ())),
            entry.get("looks_at"),
            tuple(
                SensorInput(i["name"], low, high, i["unit"], i.get("measured", False))
                for i in entry["inputs"]
                for low, high in [i["range"]]
            ),
        )
        for name, entry in _content("sensors.json").items()
        if not entry.get("test_only")
    }


def sensor_input(name: str) -> tuple[SensorKind, SensorInput, str] | None:
    """The kind of sensor, the input and the port that the name of an input stands for."""
    for kind in sensor_kinds().values():
        for one in kind.inputs:
            before, after = one.name.split("{port}")
            match = re.fullmatch(rf"{re.escape(before)}(\w+){re.escape(after)}", name)
            if match:
                return kind, one, match[1]
    return None


def event_numbers() -> Mapping[str, int]:
    """The number of each kind of event in a trace, by its name."""
    return {name: int(number) for name, number in _content("trace.json")["events"].items()}


def interrupt_sources() -> Mapping[int, str]:
    """Names of the chip's interrupt sources (AT91SAM7S256 datasheet, peripheral identifiers)."""
    names = _content("trace.json")["interrupt_sources"]
    return {int(number): str(name) for number, name in names.items()}
