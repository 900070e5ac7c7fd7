# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The tables `suites.toml`: one entry for each suite, or for each part of the benchmarks."""

from __future__ import annotations

import shutil
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verification.outside import Data, data_sets

__all__ = ["BENCHMARKS", "SUITES", "Suite", "TableError", "chosen", "read_suites"]

HERE = Path(__file__).resolve().parent
SUITES = HERE / "suites.toml"
BENCHMARKS = HERE / "benchmarks" / "suites.toml"
COMMANDS = ("pytest", "cargo_test", "cargo_example", "call")
TRUTHS = ("outside", "own")


class TableError(Exception):
    """An entry is wrong, or a name matches none; the text says which and why."""


@dataclass(frozen=True)
class Need:
    """What a suite needs that a machine may lack: data of `outside.toml`, a file, a program."""

    data: str = ""
    file: str = ""
    program: str = ""
    install: str = ""

    def __post_init__(self) -> None:
        if self.data and self.data not in data_sets():
            raise ValueError(f"needs data = '{self.data}': not in outside.toml")

    def missing(self) -> str | None:
        """Why it is not there, with what to do; None when it is."""
        if self.data and (found := data_sets()[self.data]).place() is None:
            return found.advice()
        if self.file and not (HERE.parent / self.file).exists():
            return f"{self.file} is absent: {self.install}"
        if self.program and shutil.which(self.program) is None:
            return f"{self.program} is absent: {self.install}"
        return None


@dataclass(frozen=True)
class Suite:
    """One entry; `kind` is one of `COMMANDS` and `command` its value.

    `minutes` is an estimate until the suite has run. Suites with the same `job` run one after
    another in one process; `workers` is how many processors a suite uses.
    """

    area: str
    name: str
    truth: str
    compared_with: str
    kind: str
    command: str | tuple[str, ...]
    minutes: float = 1
    arguments: tuple[str, ...] = ()
    needs: tuple[Need, ...] = ()
    examples: tuple[str, ...] = ()
    workers: int = 1
    job: str = ""

    def missing(self) -> str | None:
        """The first reason why it cannot run here; None when it can."""
        return next((reason for need in self.needs if (reason := need.missing())), None)

    def data(self) -> list[Data]:
        """Data from outside that it needs."""
        return [data_sets()[need.data] for need in self.needs if need.data]


def _suite(entry: dict[str, Any]) -> Suite:
    kinds = [kind for kind in COMMANDS if kind in entry]
    if len(kinds) != 1:
        raise ValueError(f"one of {', '.join(COMMANDS)} is expected, there are {kinds or 'none'}")
    if entry.get("truth") not in TRUTHS:
        raise ValueError(f"truth = {entry.get('truth')!r}: 'outside' or 'own' is expected")
    command = entry.pop(kinds[0])
    return Suite(
        kind=kinds[0],
        command=tuple(command) if isinstance(command, list) else command,
        arguments=tuple(entry.pop("arguments", ())),
        needs=tuple(Need(**need) for need in entry.pop("needs", ())),
        examples=tuple(entry.pop("examples", ())),
        **entry,
    )


def read_suites(path: Path) -> list[Suite]:
    """The entries in their order; raises `TableError`."""
    suites: list[Suite] = []
    for entry in tomllib.loads(path.read_text(encoding="utf-8"))["suite"]:
        name = entry.get("name", "entry without a name")
        try:
            suites.append(_suite(entry))
        except (TypeError, ValueError) as error:
            raise TableError(f"{path.name}: '{name}': {error}") from None
        if any(suite.name == name for suite in suites[:-1]):
            raise TableError(f"{path.name}: '{name}' stands twice")
    return suites


def chosen(suites: list[Suite], words: list[str]) -> list[Suite]:
    """Suites whose area is one of the words or whose name has one in it; all without words."""
    for word in words:
        if not any(_matches(suite, word) for suite in suites):
            areas = ", ".join(dict.fromkeys(suite.area for suite in suites))
            raise TableError(
                f"--only {word}: no suite has this in its name, and the areas are {areas}; "
                "--list shows all"
            )
    return [s for s in suites if not words or any(_matches(s, word) for word in words)]


def _matches(suite: Suite, word: str) -> bool:
    return suite.area == word or word.lower() in suite.name.lower()
