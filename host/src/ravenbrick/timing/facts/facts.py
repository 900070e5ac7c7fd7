# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Facts of `timing.toml` about a program that cannot be derived from its binary."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot
from ravenbrick.project.workspace import tree
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml, read_toml
from ravenbrick.schemas.validation import validate
from ravenbrick.timing.ipet import FlowFact
from ravenbrick.trace.interrupts import SOURCES

__all__ = [
    "SOURCE_NUMBERS",
    "TIMING_FILE",
    "Chain",
    "EventLoad",
    "Facts",
    "InterruptLoad",
    "Mode",
    "OutsideLoad",
    "TransferLoad",
    "annotations_of",
    "has_unit",
    "place_of",
    "read_facts",
]

TIMING_FILE = "timing.toml"
OWN_TABLES = frozenset(
    {
        "schema_version",
        "interrupt",
        "timing_event",
        "transfer",
        "suspension",
        "chain",
        "mode",
        "flow",
        "outside",
        "common_release",
        "request",
        "job_kind",
        "jobs_in_turn",
    }
)
OUTSIDE_COSTS = ("task", "period_us")
SOURCE_NUMBERS = {name: number for number, name in SOURCES.items()}


@dataclass(frozen=True)
class InterruptLoad:
    """At most `at_most` interrupts of a source in any window of `window_us`.

    Several loads of one source hold together. With `late_us`, they come as if `at_most` came each
    `window_us` and each was late by at most that: in a window of any length w, `at_most` times (w +
    late_us) / window_us, rounded up. With `task`, the windows are those from a release of this
    task on, with `unit` only programs that have this library unit are meant.
    """

    source: int
    at_most: int
    window_us: int
    reason: str
    task: str | None = None
    file: str = TIMING_FILE
    unit: str | None = None
    late_us: int = 0


@dataclass(frozen=True)
class EventLoad:
    """At most `at_most` times in any window of `window_us` for which timing events with this
    handler are set, those counted that are cancelled or moved before."""

    handler: str
    at_most: int
    window_us: int
    reason: str


@dataclass(frozen=True)
class TransferLoad:
    """At most `at_most` transfers of a peripheral by the data controller in any window of
    `window_us`; with `unit`, an Ada library unit, in programs that have it."""

    peripheral: str
    at_most: int
    window_us: int
    reason: str
    unit: str | None = None


@dataclass(frozen=True)
class Suspension:
    """A job of `task` waits for something else than its release, `count` times, in all for
    `longest_us`."""

    task: str
    count: int
    longest_us: int
    reason: str


@dataclass(frozen=True)
class Operation:
    """Each call of the subprogram `symbol` waits `count` times, in all for `longest_us`."""

    symbol: str
    count: int
    longest_us: int
    reason: str


@dataclass(frozen=True)
class Chain:
    """Tasks that pass data on; a stage acts on every n-th of its releases.

    `transfer_us` is the longest time from the last stage to the output, `edge` the interrupt source
    that counts what the first stage samples.
    """

    name: str
    stages: tuple[tuple[str, int], ...]
    transfer_us: int
    edge: str = ""


@dataclass(frozen=True)
class RequestedInterrupts:
    """Interrupts of a source come only from a job's call of the library unit `unit` until
    `lasts_us` after its end."""

    source: int
    unit: str
    lasts_us: int
    reason: str
    file: str = TIMING_FILE

    @property
    def begin(self) -> str:
        """How symbols of the unit begin."""
        return f"{self.unit.lower().replace('.', '__')}__"


@dataclass(frozen=True)
class OutsideLoad:
    """`task` has jobs without a deadline, after which it is released no sooner than `period_us`
    after the release before."""

    task: str
    period_us: int
    reason: str
    file: str = TIMING_FILE


@dataclass(frozen=True)
class KindOfJob:
    """Jobs of `task` that do not execute the subprograms `never`, and after whose release, until
    the next, at most so many interrupts of each source of `most` come. The kinds of a task together
    are all its jobs."""

    task: str
    name: str
    annotations: str
    most: tuple[tuple[int, int], ...]
    reason: str
    file: str = TIMING_FILE


@dataclass(frozen=True)
class JobsInTurn:
    """Jobs of `task` in turn, the first at a common release: one of turn n does not execute the
    subprograms `never[n]`."""

    task: str
    never: tuple[tuple[str, ...], ...]
    reason: str
    file: str = TIMING_FILE

    @property
    def annotations(self) -> list[tuple[str, str]]:
        """Name and text of what the jobs of each turn leave out."""
        never = ([{"symbol": symbol} for symbol in symbols] for symbols in self.never)
        return [
            (f"{self.file}, turn {turn} of {self.task}", annotations_of({"never": rows}))
            for turn, rows in enumerate(never, 1)
        ]


@dataclass(frozen=True)
class Mode:
    """How the program runs most of the time: `annotations` and the rates of `interrupts` hold only
    then."""

    name: str
    file: str
    reason: str
    annotations: str
    interrupts: tuple[InterruptLoad, ...] = ()

    @property
    def title(self) -> str:
        """What its annotations are called."""
        return f"{self.file}, mode '{self.name}'"


@dataclass(frozen=True)
class Facts:
    """All facts; `annotations` is TOML for the execution-time analysis.

    `shared` are annotations that hold for every project: names of files and TOML. `outside` is TOML
    that holds for jobs only, `outside_loads` what such code costs others. `together` are the tasks
    (in lower case) with a common release: all their releases lie whole periods of theirs after it.
    Those of the tasks in `in_jobs` lie so many microseconds behind that, but not while they set up
    or execute code outside of jobs.
    """

    document: LocatedToml | None
    annotations: str
    shared: tuple[tuple[str, str], ...] = ()
    outside: str = ""
    outside_loads: tuple[OutsideLoad, ...] = ()
    interrupts: tuple[InterruptLoad, ...] = ()
    events: tuple[EventLoad, ...] = ()
    transfers: tuple[TransferLoad, ...] = ()
    suspensions: tuple[Suspension, ...] = ()
    operations: tuple[Operation, ...] = ()
    chains: tuple[Chain, ...] = ()
    modes: tuple[Mode, ...] = ()
    flows: tuple[FlowFact, ...] = ()
    together: frozenset[str] = frozenset()
    in_jobs: Mapping[str, int] = field(default_factory=dict)
    requests: tuple[RequestedInterrupts, ...] = ()
    kinds: tuple[KindOfJob, ...] = ()
    turns: tuple[JobsInTurn, ...] = ()

    @property
    def name(self) -> str:
        """The file, for messages."""
        return TIMING_FILE if self.document is None else str(self.document.path)

    @property
    def of_jobs(self) -> tuple[str, str]:
        """Name and text of the annotations that hold for jobs only."""
        return f"{self.name}, [[outside]]", self.outside

    def suspension(self, task: str) -> Suspension | None:
        """The suspension of a task, if the file states one."""
        named = (found for found in self.suspensions if found.task.lower() == task.lower())
        return next(named, None)

    def in_turn(self, task: str) -> JobsInTurn | None:
        """The turns of a task's jobs, if they are stated and the task keeps a common release."""
        named = (found for found in self.turns if found.task.lower() == task.lower())
        kept = task.lower() in self.together and task.lower() not in self.in_jobs
        return next(named, None) if kept else None

    def outside_of(self, task: str) -> tuple[OutsideLoad, ...]:
        """What jobs of a task without a deadline cost others."""
        named = (found for found in self.outside_loads if found.task.lower() == task.lower())
        return tuple(named)

    def loads(self, source: int, task: str | None = None) -> tuple[InterruptLoad, ...]:
        """Loads of a source in any window, the longest window first; with `task`, only those in
        windows from its releases on."""
        wanted = None if task is None else task.lower()
        found = (
            load
            for load in self.interrupts
            if load.source == source and (load.task and load.task.lower()) == wanted
        )
        return tuple(sorted(found, key=lambda load: (load.late_us > 0, -load.window_us)))

    def of_image(self, image: ElfImage) -> Facts:
        """The facts without the rates of interrupts in units that this program does not have."""
        return replace(self, interrupts=_present(self.interrupts, image))

    def transfer_loads(self, image: ElfImage) -> dict[str, tuple[TransferLoad, ...]]:
        """Loads of transfers in this program by peripheral, the longest window first."""
        found: dict[str, list[TransferLoad]] = {}
        for load in sorted(self.transfers, key=lambda load: (load.peripheral, -load.window_us)):
            if load.unit is None or has_unit(image, load.unit):
                found.setdefault(load.peripheral, []).append(load)
        return {peripheral: tuple(loads) for peripheral, loads in found.items()}

    def event_loads(self, handler: str) -> tuple[EventLoad, ...]:
        """Loads of timing events with this handler, the longest window first."""
        found = (load for load in self.events if load.handler.lower() == handler.lower())
        return tuple(sorted(found, key=lambda load: -load.window_us))


def _present(loads: Sequence[InterruptLoad], image: ElfImage) -> tuple[InterruptLoad, ...]:
    return tuple(load for load in loads if load.unit is None or has_unit(image, load.unit))


def has_unit(image: ElfImage, unit: str) -> bool:
    """Does the program have code or data of this Ada library unit?"""
    begin = f"{unit.lower().replace('.', '__')}__"
    return any(symbol.startswith(begin) for symbol in image.symbols)


def annotations_of(tables: dict[str, list[dict[str, Any]]]) -> str:
    """Lists of facts as TOML tables."""
    lines: list[str] = []
    for table, rows in tables.items():
        for row in rows:
            lines.append(f"[[{table}]]")
            lines += [f"{key} = {json.dumps(value)}" for key, value in row.items()]
    return "\n".join(lines) + "\n"


def _check_tasks(document: LocatedToml, robot: Robot) -> None:
    named: list[tuple[KeyPath, str]] = [
        ((table, index, "task"), row["task"])
        for table in ("suspension", "interrupt", "job_kind", "jobs_in_turn", "outside")
        for index, row in enumerate(document.values.get(table, []))
        if "task" in row
    ]
    named += [
        (("chain", index, "stages"), stage["task"])
        for index, row in enumerate(document.values.get("chain", []))
        for stage in row["stages"]
    ]
    named += [
        (("mode", index, "interrupt", number, "task"), load["task"])
        for index, row in enumerate(document.values.get("mode", []))
        for number, load in enumerate(row.get("interrupt", []))
        if "task" in load
    ]
    named += [
        (("common_release", index, "tasks"), name)
        for index, row in enumerate(document.values.get("common_release", []))
        for name in row["tasks"]
    ]
    named += [
        (("common_release", index, "in_jobs", number, "task"), task["task"])
        for index, row in enumerate(document.values.get("common_release", []))
        for number, task in enumerate(row.get("in_jobs", []))
    ]
    for place, name in named:
        if robot.task(name) is None:
            known = ", ".join(task.name for task in robot.tasks)
            raise document.error(place, f"robot.toml has no task '{name}'; it has: {known}")


def _chain(row: dict[str, Any]) -> Chain:
    stages = tuple((stage["task"], stage.get("every", 1)) for stage in row["stages"])
    return Chain(row["name"], stages, row["transfer_us"], row.get("edge", ""))


def place_of(row: dict[str, Any]) -> dict[str, Any]:
    """Where code lies that is outside of jobs."""
    return {key: value for key, value in row.items() if key not in OUTSIDE_COSTS}


def _outside(row: dict[str, Any], path: Path) -> OutsideLoad:
    return OutsideLoad(row["task"], row["period_us"], row["reason"], str(path))


def _kind(row: dict[str, Any], path: Path) -> KindOfJob:
    never = [{"symbol": symbol} for symbol in row.get("never", [])]
    most = tuple((SOURCE_NUMBERS[m["source"]], m["at_most"]) for m in row.get("most", []))
    annotations = annotations_of({"never": never})
    return KindOfJob(row["task"], row["name"], annotations, most, row["reason"], str(path))


def _mode(row: dict[str, Any], path: Path, robot: Robot) -> Mode:
    tables = {"avoided": row.get("never", []), "loop": row.get("loop", [])}
    loads = _interrupts(row.get("interrupt", []), path, robot)
    return Mode(row["name"], str(path), row["reason"], annotations_of(tables), loads)


def _interrupts(
    rows: Sequence[dict[str, Any]], path: Path, robot: Robot
) -> tuple[InterruptLoad, ...]:
    """Those of windows from the releases of a task that the robot does not have are left out; those
    of each motor count for one at least, since a program may have their handler without a motor."""
    each = {"motor": max(1, len(robot.motor_ports))}
    return tuple(
        InterruptLoad(
            SOURCE_NUMBERS[row["source"]],
            row["at_most"] * each.get(row.get("each", ""), 1),
            row["window_us"],
            row["reason"],
            row.get("task"),
            str(path),
            row.get("unit"),
            row.get("late_us", 0),
        )
        for row in rows
        if "task" not in row or robot.task(row["task"]) is not None
    )


def _turns(documents: Sequence[LocatedToml], robot: Robot) -> tuple[JobsInTurn, ...]:
    return tuple(
        JobsInTurn(row["task"], tuple(map(tuple, row["never"])), row["reason"], str(document.path))
        for document in documents
        for row in document.values.get("jobs_in_turn", [])
        if robot.task(row["task"]) is not None
    )


def _annotations(document: LocatedToml) -> str:
    values = document.values
    return annotations_of({key: rows for key, rows in values.items() if key not in OWN_TABLES})


def _read(path: Path) -> LocatedToml | None:
    if not path.exists():
        return None
    document = read_toml(path, missing="write a file of facts, or remove it")
    validate(document, "timing")
    return document


def _drivers_facts() -> LocatedToml | None:
    """Facts about the drivers, which hold in every project."""
    return _read(tree() / "drivers" / TIMING_FILE)


def read_facts(robot: Robot) -> Facts:
    """Facts of a project and those of the drivers, which come second. Raises `ProjectFileError`."""
    own, drivers = _read(robot.directory / TIMING_FILE), _drivers_facts()
    if own is not None:
        _check_tasks(own, robot)
    documents = [document for document in (own, drivers) if document is not None]

    def rows(table: str) -> list[dict[str, Any]]:
        return [row for document in documents for row in document.values.get(table, [])]

    stated = [(row, d.path) for d in documents for row in d.values.get("mode", [])]
    modes = {row["name"]: (row, path) for row, path in reversed(stated)}
    return Facts(
        own,
        "" if own is None else _annotations(own),
        () if drivers is None else ((str(drivers.path), _annotations(drivers)),),
        annotations_of({"avoided": [place_of(row) for row in rows("outside")]}),
        tuple(
            _outside(row, document.path)
            for document in documents
            for row in document.values.get("outside", [])
        ),
        tuple(
            load
            for document in documents
            for load in _interrupts(document.values.get("interrupt", []), document.path, robot)
        ),
        tuple(EventLoad(**row) for row in rows("timing_event")),
        tuple(TransferLoad(**row) for row in rows("transfer")),
        tuple(
            Suspension(row["task"], row.get("count", 1), row["longest_us"], row["reason"])
            for row in rows("suspension")
            if "task" in row
        ),
        tuple(
            Operation(row["symbol"], row.get("count", 1), row["longest_us"], row["reason"])
            for row in rows("suspension")
            if "symbol" in row
        ),
        tuple(_chain(row) for row in rows("chain")),
        tuple(_mode(row, path, robot) for row, path in reversed(modes.values())),
        tuple(
            FlowFact(row["symbol"], tuple(row["lines"]), row["at_most"], row["reason"])
            for row in rows("flow")
        ),
        frozenset(name.lower() for row in rows("common_release") for name in row["tasks"]),
        {
            task["task"].lower(): task["after_us"]
            for row in rows("common_release")
            for task in row.get("in_jobs", [])
        },
        tuple(
            RequestedInterrupts(
                SOURCE_NUMBERS[row["source"]],
                row["unit"],
                row["lasts_us"],
                row["reason"],
                str(document.path),
            )
            for document in documents
            for row in document.values.get("request", [])
        ),
        tuple(
            _kind(row, document.path)
            for document in documents
            for row in document.values.get("job_kind", [])
            if robot.task(row["task"]) is not None
        ),
        _turns(documents, robot),
    )
