# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ceilings of protected objects and how long a job can be blocked by less urgent tasks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from ravenbrick.schedule.model import NO_OVERHEADS, CriticalSection, Overheads, Task, TaskSet
from ravenbrick.schedule.quantity import Time

__all__ = [
    "Blocking",
    "blocking_candidates",
    "ceilings",
    "inheritance_blocking",
    "longest_blocking",
]

Cause = Literal["none", "section", "stated", "masked"]


@dataclass(frozen=True)
class Blocking:
    """A possible blocking: by a section of `task` on `resource`, by a stated bound, or masked."""

    time: Time
    cause: Cause
    task: str = ""
    resource: str = ""


NO_BLOCKING = Blocking(0, "none")


def ceilings(task_set: TaskSet) -> dict[str, int]:
    """Ceiling of each object: the highest priority among its users (RM D.3)."""
    found: dict[str, int] = {}
    for task in task_set:
        for section in task.sections:
            found[section.resource] = max(task.priority, found.get(section.resource, 0))
    return dict(sorted(found.items()))


def _blocking_sections(task_set: TaskSet, task: Task) -> Iterator[tuple[Task, CriticalSection]]:
    ceiling_of = ceilings(task_set)
    for lower in task_set.lower(task):
        for section in lower.sections:
            if ceiling_of[section.resource] >= task.priority:
                yield lower, section


def blocking_candidates(
    task_set: TaskSet, task: Task, overheads: Overheads = NO_OVERHEADS
) -> tuple[Blocking, ...]:
    """All that may block a job of `task` once; only one of them does.

    Under the immediate ceiling protocol a job is blocked at most once, before it starts, by one
    section of a less urgent task whose object's ceiling is at least the job's priority
    (Baker 1991; Sha, Rajkumar, Lehoczky 1990). A masked section blocks in the same way.
    """
    found = [NO_BLOCKING]
    found += [
        Blocking(section.duration, "section", lower.name, section.resource)
        for lower, section in _blocking_sections(task_set, task)
    ]
    if task.blocking:
        found.append(Blocking(task.blocking, "stated"))
    if overheads.masked_section:
        found.append(Blocking(overheads.masked_section, "masked"))
    return tuple(found)


def longest_blocking(
    task_set: TaskSet, task: Task, overheads: Overheads = NO_OVERHEADS
) -> Blocking:
    """The longest of `blocking_candidates`; the first of equal ones."""
    return max(blocking_candidates(task_set, task, overheads), key=lambda blocking: blocking.time)


def inheritance_blocking(task_set: TaskSet, task: Task) -> Time:
    """Bound of blocking under basic priority inheritance, for comparison.

    Each less urgent task blocks by at most one section, and each object at most once: the smaller
    of both sums (Sha, Rajkumar, Lehoczky 1990, theorems on the basic protocol).
    """
    by_task: dict[str, Time] = {}
    by_resource: dict[str, Time] = {}
    for lower, section in _blocking_sections(task_set, task):
        by_task[lower.name] = max(by_task.get(lower.name, 0), section.duration)
        by_resource[section.resource] = max(by_resource.get(section.resource, 0), section.duration)
    return min(sum(by_task.values()), sum(by_resource.values()))
