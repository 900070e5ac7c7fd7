# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Task sets from TOML or JSON files; the format is described in the schedulability guide."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from ravenbrick.schedule.assignment import Rule
from ravenbrick.schedule.driver_costs import CostError, DriverCosts, read_driver_costs
from ravenbrick.schedule.file_table import FileTable
from ravenbrick.schedule.model import (
    NO_OVERHEADS,
    RELEASES,
    CriticalSection,
    Frame,
    Overheads,
    Task,
    TaskSet,
    TaskSetError,
)
from ravenbrick.schedule.quantity import Time
from ravenbrick.schedule.task_models.file import frames_of, system_of
from ravenbrick.schedule.task_models.system import System
from ravenbrick.schemas.located_json import read_json
from ravenbrick.schemas.located_toml import read_toml

__all__ = ["TaskFile", "read_task_file"]

SCHEMA_VERSION = 1


_ROOT = (
    "schema_version",
    "name",
    "unit",
    "priorities",
    "driver_costs",
    "driver_tasks",
    "overheads",
    "mixed_criticality",
    "deadline_assignment",
    "tasks",
    "servers",
    "transactions",
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
    "frames",
    "bcet",
    "criticality",
    "wcet_high",
    "server",
)
_SECTION = ("resource", "duration", "start")
_LIMIT = ("share", "window", "late")
_PRIORITY_LIMIT = 10**6


@dataclass(frozen=True)
class TaskFile:
    """A task set with its name, the unit of its times and the costs of the run-time."""

    path: Path
    name: str
    unit: str
    priorities: str
    system: System

    @property
    def task_set(self) -> TaskSet:
        """The tasks that the processor serves by priority, servers included."""
        return self.system.task_set

    @property
    def overheads(self) -> Overheads:
        """The costs of the run-time."""
        return self.system.overheads


def _section(table: FileTable) -> CriticalSection:
    table.only(_SECTION)
    return CriticalSection(table.text("resource"), table.time("duration"), table.time("start", 0))


def _limit(table: FileTable) -> tuple[Time, Time, Time]:
    table.only(_LIMIT)
    return table.time("share"), table.time("window"), table.time("late", 0)


def _least_separation(table: FileTable) -> Time | None:
    """The period of a task whose frames all say their separation, None if it has to be given."""
    frames = table.values.get("frames")
    if not isinstance(frames, list) or not frames or not all(isinstance(f, dict) for f in frames):
        return None
    parts = table.tables("frames")
    if any("separation" not in part.values for part in parts):
        return None
    return min(part.time("separation") for part in parts)


def _execution(table: FileTable, period: Time, deadline: Time) -> tuple[Time, tuple[Frame, ...]]:
    """Longest execution time, and the frames if there are several."""
    if "frames" not in table.values:
        return table.time("wcet"), ()
    if "wcet" in table.values:
        raise table.error("wcet", "a task with 'frames' has its execution times there")
    frames = frames_of(table, period, deadline)
    return max(frame.wcet for frame in frames), frames


def _task(table: FileTable, declared: bool) -> Task:
    table.only(_TASK)
    name = table.text("name")
    release = table.choice("release", RELEASES, "cyclic")
    expected = "period" if release == "cyclic" else "minimum_interrelease_time"
    other = "minimum_interrelease_time" if release == "cyclic" else "period"
    if other in table.values:
        raise table.error(other, f"a task released as '{release}' has a '{expected}' instead")
    period = table.time(expected, _least_separation(table))
    sections = tuple(_section(part) for part in table.tables("sections"))
    if declared and "priority" not in table.values:
        raise table.error("priority", "is missing; add it, or 'priorities' at the head of the file")
    priority = table.whole("priority", _PRIORITY_LIMIT) if declared else 0
    times: dict[str, Any] = {}
    for key in ("deadline", "phase"):
        if key in table.values:
            times[key] = table.time(key)
    for key in ("release_jitter", "blocking", "bcet"):
        times[key] = table.time(key, 0)
    wcet, frames = _execution(table, period, times.get("deadline", period))
    high = table.choice("criticality", ("low", "high"), "low") == "high"
    if "wcet_high" in table.values and not high:
        raise table.error("wcet_high", 'needs criticality = "high"')
    if "deadline" in times and times["deadline"] <= 0:
        raise table.error("deadline", f"is {times['deadline']}; expected more than 0")
    try:
        return Task(
            name,
            period,
            wcet,
            priority,
            release=release,
            frames=frames,
            wcet_high=table.time("wcet_high", wcet) if high else None,
            sections=sections,
            limits=tuple(_limit(part) for part in table.tables("limits")),
            **times,
        )
    except TaskSetError as error:
        field = expected if error.field == "period" else error.field
        raise table.error(field, error.problem) from None


def _overheads(table: FileTable) -> Overheads:
    known = [item.name for item in fields(Overheads)]
    table.only(known)
    times = {name: table.time(name) for name in known if name in table.values}
    try:
        return Overheads(**times)
    except TaskSetError as error:
        raise table.error(error.field, error.problem) from None


def _unique_names(tables: list[FileTable]) -> None:
    seen: set[str] = set()
    for table in tables:
        name = table.text("name")
        if name in seen:
            raise table.error("name", f"the task '{name}' is defined twice; rename one")
        seen.add(name)


def _counts(table: FileTable) -> dict[str, int]:
    """How often each job calls operations of the drivers."""
    counts = table.table("operations")
    return {name: counts.whole(name, _PRIORITY_LIMIT) for name in counts.values}


def _driver_costs(root: FileTable, rule: str) -> DriverCosts:
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
    root: FileTable, costs: DriverCosts, tasks: list[Task], overheads: Overheads
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
        document = read_json(path, "a task set")
    else:
        document = read_toml(path, missing="name a task-set file")
    root = FileTable(document, (), document.values)
    root.only(_ROOT)
    version = root.required("schema_version")
    if version != SCHEMA_VERSION or isinstance(version, bool):
        raise root.error("schema_version", f"is {version!r}; expected {SCHEMA_VERSION}")
    rule = priorities or root.choice("priorities", tuple(Rule), Rule.DECLARED)
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
    places = {table.text("name"): table for table in tables}
    system = system_of(root, places, tasks, overheads, rule)
    return TaskFile(path, root.text("name", path.stem), root.text("unit", "ms"), rule, system)
