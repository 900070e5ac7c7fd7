# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames, servers and transactions of a task-set file, and the priorities of all its tasks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace

from ravenbrick.schedule.assignment import (
    Rule,
    audsley,
    deadline_monotonic,
    rate_monotonic,
)
from ravenbrick.schedule.file_table import FileTable
from ravenbrick.schedule.model import Frame, Overheads, Task, TaskSet, TaskSetError
from ravenbrick.schedule.quantity import Time
from ravenbrick.schedule.task_models.mixed_criticality import METHODS, meets_deadlines
from ravenbrick.schedule.task_models.servers import KINDS, Server
from ravenbrick.schedule.task_models.system import System
from ravenbrick.schedule.task_models.transactions import RULES, Transaction, assign_deadlines

__all__ = ["frames_of", "system_of"]

_SERVER = ("name", "description", "kind", "period", "capacity", "priority")
_TRANSACTION = ("name", "description", "tasks", "deadline")
_FRAME = ("wcet", "separation", "deadline")
_PRIORITY_LIMIT = 10**6


def frames_of(table: FileTable, period: Time, deadline: Time) -> tuple[Frame, ...]:
    """Frames as execution times, `[5, 1, 1]`, or as tables with separation and deadline."""
    values = table.values.get("frames", [])
    if not isinstance(values, list) or (not values and "frames" in table.values):
        raise table.error("frames", "expected a list of execution times or of tables")
    if all(isinstance(value, dict) for value in values):
        frames = []
        for part in table.tables("frames"):
            part.only(_FRAME)
            apart = part.time("separation", period)
            frames.append(Frame(part.time("wcet"), apart, part.time("deadline", deadline)))
        return tuple(frames)
    each = (FileTable(table.document, table.path, {"frames": value}) for value in values)
    return tuple(Frame(part.positive_time("frames"), period, deadline) for part in each)


@contextmanager
def _located(tables: Mapping[str, FileTable], root: FileTable) -> Iterator[None]:
    """Errors of the analysis name the place in the file."""
    try:
        yield
    except TaskSetError as error:
        table = tables.get(error.task, root)
        field = error.field
        if field == "period" and table.values.get("release", "cyclic") != "cyclic":
            field = "minimum_interrelease_time"
        problem = error.problem if error.task in tables else str(error)
        raise table.error(field or "name", problem) from None


def _server(table: FileTable, served: tuple[Task, ...], declared: bool) -> Server:
    table.only(_SERVER)
    if declared and "priority" not in table.values:
        raise table.error("priority", "is missing; add it, or 'priorities' at the head of the file")
    if not served:
        raise table.error("name", "no task names this server; give it to one as 'server'")
    return Server(
        table.text("name"),
        table.choice("kind", KINDS, "deferrable"),
        table.positive_time("period"),
        table.positive_time("capacity"),
        table.whole("priority", _PRIORITY_LIMIT) if declared else 0,
        served,
    )


def _by_server(tables: Mapping[str, FileTable], tasks: list[Task]) -> dict[str, list[Task]]:
    """The tasks of each server, those of none under an empty name."""
    found: dict[str, list[Task]] = {"": []}
    for task in tasks:
        server = ""
        if task.name in tables and "server" in tables[task.name].values:
            server = tables[task.name].text("server")
        found.setdefault(server, []).append(task)
    return found


def _ordered(tasks: list[Task], rule: Rule) -> tuple[Task, ...]:
    """Tasks of a server with priorities by the rule, among themselves."""
    if rule == Rule.DECLARED:
        return tuple(tasks)
    order = rate_monotonic if rule == Rule.RATE_MONOTONIC else deadline_monotonic
    return order(TaskSet(tuple(tasks))).tasks


def system_of(
    root: FileTable,
    tables: Mapping[str, FileTable],
    tasks: list[Task],
    overheads: Overheads,
    rule: Rule,
) -> System:
    """The system that the file describes; `tables` are those of the tasks by name.

    Raises `ProjectFileError`, which names file, line and field.
    """
    places = dict(tables)
    groups = _by_server(tables, tasks)
    alone = groups.pop("")
    known = [table.text("name") for table in root.tables("servers")]
    for name, lost in groups.items():
        if name not in known:
            names = ", ".join(known) or "none; add [[servers]]"
            problem = f"there is no server '{name}'; known: {names}"
            raise tables[lost[0].name].error("server", problem)
    servers = []
    with _located(places, root):
        for table in root.tables("servers"):
            name = table.text("name")
            if name in places:
                raise table.error("name", f"'{name}' is defined twice; rename one")
            places[name] = table
            served = _ordered(groups.pop(name), rule) if groups.get(name) else ()
            servers.append(_server(table, served, rule == Rule.DECLARED))
    transactions = tuple(_transaction(table, places) for table in root.tables("transactions"))
    with _located(places, root):
        task_set = TaskSet((*alone, *(server.task for server in servers)))
        for transaction in transactions:
            _check_members(transaction, task_set, places)
            transaction.check(task_set)
        method = root.choice("mixed_criticality", METHODS, "amc_max")
        system = System(task_set, overheads, tuple(servers), transactions, method)
        system = replace(system, task_set=_assigned(root, rule, system))
        system.solution.schedulable  # noqa: B018 (its errors name fields of this file)
    return system


def _transaction(table: FileTable, places: dict[str, FileTable]) -> Transaction:
    table.only(_TRANSACTION)
    name = table.text("name")
    if name in places:
        raise table.error("name", f"'{name}' is defined twice; rename one")
    places[name] = table
    return Transaction(name, table.names("tasks"), table.positive_time("deadline"))


def _check_members(
    transaction: Transaction, task_set: TaskSet, places: Mapping[str, FileTable]
) -> None:
    """Refuse a transaction with a task that is no task of the processor's own."""
    own = {task.name for task in task_set}
    for name in transaction.tasks:
        if name not in own or "kind" in places[name].values:
            problem = f"'{name}' is not a task outside of servers"
            raise TaskSetError(problem, task=transaction.name, field="tasks")


def _assigned(root: FileTable, rule: Rule, system: System) -> TaskSet:
    """The task set with the priorities of the rule."""
    task_set, overheads = system.task_set, system.overheads
    choice = root.choice("deadline_assignment", RULES, "proportional")
    if rule == Rule.DECLARED:
        return task_set
    if system.transactions and rule == Rule.DEADLINE_MONOTONIC:
        return assign_deadlines(task_set, system.transactions, choice, overheads).task_set
    if rule == Rule.AUDSLEY:
        if system.transactions:
            raise root.error(
                "priorities",
                "'audsley' does not know transactions; write 'deadline_monotonic' with "
                "'deadline_assignment'",
            )
        found = audsley(task_set, overheads, meets_deadlines(system.method))
        if found is None:
            raise root.error(
                "priorities",
                "no assignment of priorities meets all deadlines; "
                "write 'deadline_monotonic' to see which are missed",
            )
        return found
    return (rate_monotonic if rule == Rule.RATE_MONOTONIC else deadline_monotonic)(task_set)
