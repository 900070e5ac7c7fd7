# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs that the page saved: a session, the inputs that were applied, the end and the digest.

docs/reference/run-files.md describes the fields.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from ravenbrick.errors import ProjectFileError, ScenarioError
from ravenbrick.project.stimuli import Channels, Sequence, TimedInput

__all__ = ["read", "read_run_file"]

FORMAT = "ravenbrick run"
VERSION = 1


@dataclass(frozen=True)
class RunFile:
    """A run that the page saved; `configuration` is what the brick was made of."""

    path: Path
    configuration: dict[str, Any]
    inputs: tuple[TimedInput, ...]
    until_ms: int
    digest: str


def _fields(path: Path, values: Any) -> RunFile:
    if not isinstance(values, dict) or values.get("format") != FORMAT:
        raise ProjectFileError(path, 1, "format", f'expected "{FORMAT}"; save a run in the page')
    if values.get("version") != VERSION:
        raise ProjectFileError(
            path, 1, "version", f"is {values.get('version')!r}; expected {VERSION}"
        )
    try:
        inputs = tuple(
            TimedInput(int(i["at_cycles"]), str(i["name"]), float(i["value"]), f"{path}:1")
            for i in values["inputs"]
        )
        return RunFile(
            path, values["configuration"], inputs, int(values["until_ms"]), str(values["digest"])
        )
    except KeyError as error:
        raise ProjectFileError(path, 1, str(error.args[0]), "is missing") from None
    except (OverflowError, TypeError, ValueError) as error:
        raise ProjectFileError(path, 1, "inputs", f"{error}; save the run again") from None


def read_run_file(path: Path) -> RunFile:
    """Read a saved run; raises `ScenarioError`, `ProjectFileError`."""
    if not path.is_file():
        raise ScenarioError(f"{path}: there is no such file; save a run in the page")
    try:
        return _fields(path, json.loads(path.read_text(encoding="utf-8")))
    except json.JSONDecodeError as error:
        raise ProjectFileError(path, error.lineno, "", f"no JSON: {error.msg}") from None
    except UnicodeDecodeError:
        raise ProjectFileError(path, 1, "", "not UTF-8 text; save the run again") from None
    except (RecursionError, ValueError) as error:
        raise ProjectFileError(path, 1, "", f"{error}; save the run again") from None


def read(sequence: Sequence, channels: Channels) -> None:
    """Fill `sequence`; raises as `read_run_file`."""
    path = sequence.path
    inputs = read_run_file(path).inputs
    channels.require(path, 1, {timed.name for timed in inputs})
    for timed in inputs:
        name = channels.input_of(path, 1, timed.name)
        sequence.at(1, Fraction(timed.at_cycles) / sequence.clock.hertz)
        if name is not None:
            sequence.set(1, name, timed.value)
