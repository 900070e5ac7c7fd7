# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Task sets from TOML or JSON files; the format is described in the schedulability guide."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, fields
from enum import StrEnum
from pathlib import Path
from typing import Any

from ravenbrick.errors import ProjectFileError
from ravenbrick.schedule.assignment import audsley, deadline_monotonic, rate_monotonic
from ravenbrick.schedule.driver_costs import CostError, DriverCosts, read_driver_costs
from ravenbrick.schedule.model import (
    NO_OVERHEADS,
    RELEASES,
    CriticalSection,
    Overheads,
    Task,
    TaskSet,
    TaskSetError,
)
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schemas.located_json import read_json
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml, read_toml

__all__ = ["Rule", "TaskFile", "read_task_file"]

SCHEMA_VERSION = 1


class Rule(StrEnum):
    """How priorities are assigned."""

    DECLARED = "declared"
    RATE_MONOTONIC = "rate_monotonic"
    DEADLINE_MONOTONIC = "deadline_monotonic"
    AUDSLEY = "audsley"


_ROOT = (
    "schema_version",
    "name",
    "unit",
    "priorities",
    "driver_costs",
    "driver_tasks",
    "overheads",
    "tasks",
)
_TASK = (
    "name",
    "description",
    "release",
    "period",
    "minimum_interrelease_time",
    "wcet",
    "deadline",
    "priority",
    "release_jitter",
    "phase",
    "blocking",
    "limits",
    "sections",
    "operations",
)
_SECTION = ("resource", "duration", "start")
_LIMIT = ("share", "window")
_PRIORITY_LIMIT = 10**6


@dataclass(frozen=True)
class TaskFile:
    """A task set with its name, the unit of its times and the costs of the run-time."""

    path: Path
    name: str
    unit: str
    priorities: str
    task_set: TaskSet
    overheads: Overheads


@dataclass(frozen=True)
class _Table:
    """One table of the file; errors name file, line and field."""

    document: LocatedToml
    path: KeyPath
    values: dict[str, Any]

    def error(self, name: str, problem: str) -> ProjectFileError:
        return self.document.error((*self.path, name), problem)

    def only(self, known: Iterable[str]) -> None:
        """Refuse fields that do not exist."""
        names = list(known)
        for name in self.values:
            if name not in names:
                close = difflib.get_close_matches(name, names, 1)
                advice = f"did you mean '{close[0]}'?" if close else f"known: {', '.join(names)}"
                raise self.error(name, f"unknown field; {advice}")

    def required(self, name: str) -> Any:
        if name not in self.values:
            raise self.error(name, "is missing; add it")
        return self.values[name]

    def text(self, name: str, default: str | None = None) -> str:
        value = self.required(name) if default is None else self.values.get(name, default)
        if not isinstance(value, str) or not (value or default == ""):
            raise self.error(name, f"is {value!r}; expected a text in quotes")
        return value

    def choice(self, name: str, allowed: Iterable[str], default: str) -> str:
        value = self.text(name, default)
        if value not in allowed:
            raise self.error(name, f"is '{value}'; expected one of {', '.join(allowed)}")
        return value

    def time(self, name: str, default: Time | None = None) -> Time:
        value = self.required(name) if default is None else self.values.get(name, default)
        try:
            return exact(value)
        except ValueError as error:
            advice = "expected a number, or a text such as '1/3'"
            raise self.error(name, f"{error}; {advice}") from None

    def whole(self, name: str, limit: int) -> int:
        value = self.required(name)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= limit:
            raise self.error(name, f"is {value!r}; expected a whole number from 0 to {limit}")
        return value

    def table(self, name: str) -> _Table:
        value = self.values.get(name, {})
        if not isinstance(value, dict):
            raise self.error(name, "expected a table")
        return _Table(self.document, (*self.path, name), value)

    def tables(self, name: str) -> list[_Table]:
        value = self.values.get(name, [])
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            raise self.error(name, "expected a list of tables")
        return [
            _Table(self.document, (*self.path, name, index), item)
            for index, item in enumerate(value)
        ]


def _section(table: _Table) -> CriticalSection:
    table.only(_SECTION)
    return CriticalSection(table.text("resource"), table.time("duration"), table.time("start", 0))


def _limit(table: _Table) -> tuple[Time, Time]:
    table.only(_LIMIT)
    return table.time("share"), table.time("window")


def _task(table: _Table, declared: bool) -> Task:
    table.only(_TASK)
    name = table.text("name")
    release = table.choice("release", RELEASES, "cyclic")
    expected = "period" if release == "cyclic" else "minimum_interrelease_time"
    other = "minimum_interrelease_time" if release == "cyclic" else "period"
    if other in table.values:
        raise table.error(other, f"a task released as '{release}' has a '{expected}' instead")
    period = table.time(expected)
    sections = tuple(_section(part) for part in table.tables("sections"))
    if declared and "priority" not in table.values:
        raise table.error("priority", "is missing; add it, or 'priorities' at the head of the file")
    priority = table.whole("priority", _PRIORITY_LIMIT) if declared else 0
    times: dict[str, Any] = {}
    for key in ("deadline", "phase"):
        if key in table.values:
            times[key] = table.time(key)
    for key in ("release_jitter", "blocking"):
        times[key] = table.time(key, 0)
    if "deadline" in times and times["deadline"] <= 0:
        raise table.error("deadline", f"is {times['deadline']}; expected more than 0")
    try:
        return Task(
            name,
            period,
            table.time("wcet"),
            priority,
            release=release,  # type: ignore[arg-type]
            sections=sections,
            limits=tuple(_limit(part) for part in table.tables("limits")),
            **times,
        )
    except TaskSetError as error:
        field = expected if error.field == "period" else error.field
        raise table.error(field, error.problem) from None


def _overheads(table: _Table) -> Overheads:
    known = [item.name for item in fields(Overheads)]
    table.only(known)
    times = {name: table.time(name) for name in known if name in table.values}
    try:
        return Overheads(**times)
    except TaskSetError as error:
        raise table.error(error.field, error.problem) from None


def _assigned(root: _Table, rule: str, task_set: TaskSet, overheads: Overheads) -> TaskSet:
    if rule == "declared":
        return task_set
    if rule == "audsley":
        found = audsley(task_set, overheads)
        if found is None:
            raise root.error(
                "priorities",
                "no assignment of priorities meets all deadlines; "
                "write 'deadline_monotonic' to see which are missed",
            )
        return found
    return (rate_monotonic if rule == "rate_monotonic" else deadline_monotonic)(task_set)


def _unique_names(tables: list[_Table]) -> None:
    seen: set[str] = set()
    for table in tables:
        name = table.text("name")
        if name in seen:
            raise table.error("name", f"the task '{name}' is defined twice; rename one")
        seen.add(name)


def _counts(table: _Table) -> dict[str, int]:
    """How often each job calls operations of the drivers."""
    counts = table.table("operations")
    return {name: counts.whole(name, _PRIORITY_LIMIT) for name in counts.values}


def _driver_costs(root: _Table, rule: str) -> DriverCosts:
    if rule != "declared":
        raise root.error(
            "driver_costs", "needs priorities that are declared; add them to the tasks"
        )
    file = root.document.path.parent / root.text("driver_costs")
    try:
        return read_driver_costs(file, root.text("unit", "ms"))
    except CostError as error:
        raise root.error("driver_costs", str(error)) from None


def _with_drivers(
    root: _Table, costs: DriverCosts, tasks: list[Task], overheads: Overheads
) -> tuple[list[Task], Overheads]:
    """The tasks with what their operations cost; drivers' tasks above them, interrupts on top."""
    names = root.values.get("driver_tasks", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise root.error("driver_tasks", f"is {names!r}; expected a list of names")
    top = max(task.priority for task in tasks)
    found: list[Task] = []
    used: set[str] = set()
    for table, task in zip(root.tables("tasks"), tasks, strict=True):
        counts = _counts(table)
        used |= set(counts)
        try:
            found += costs.charged(task, counts, top + len(names) + 1)
        except CostError as error:
            raise table.error("operations", str(error)) from None
    try:
        found += [costs.driver_task(n, top + len(names) - i) for i, n in enumerate(names)]
    except CostError as error:
        raise root.error("driver_tasks", str(error)) from None
    return found, costs.overheads(overheads, used)


def read_task_file(path: Path, priorities: Rule | None = None) -> TaskFile:
    """Read a task set from TOML, or from JSON when the name ends in `.json`; `priorities` is a rule
    in place of the file's.

    Raises `ProjectFileError`, which names file, line and field.
    """
    if path.suffix == ".json":
        document = read_json(path)
    else:
        document = read_toml(path, missing="name a task-set file")
    root = _Table(document, (), document.values)
    root.only(_ROOT)
    version = root.required("schema_version")
    if version != SCHEMA_VERSION or isinstance(version, bool):
        raise root.error("schema_version", f"is {version!r}; expected {SCHEMA_VERSION}")
    rule = priorities or root.choice("priorities", tuple(Rule), "declared")
    overheads = _overheads(root.table("overheads")) if "overheads" in root.values else NO_OVERHEADS
    tables = root.tables("tasks")
    if not tables:
        raise root.error("tasks", "there is no task; add one with [[tasks]]")
    _unique_names(tables)
    tasks = [_task(table, rule == "declared") for table in tables]
    if "driver_costs" in root.values:
        tasks, overheads = _with_drivers(root, _driver_costs(root, rule), tasks, overheads)
    elif "driver_tasks" in root.values or any("operations" in t.values for t in tables):
        raise root.error("driver_costs", "is missing; name the table of operation costs")
    task_set = TaskSet(tuple(tasks))
    return TaskFile(
        path,
        root.text("name", path.stem),
        root.text("unit", "ms"),
        rule,
        _assigned(root, rule, task_set, overheads),
        overheads,
    )
