# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ceilings of protected objects and how long a job can be blocked by less urgent tasks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from ravenbrick.schedule.model import NO_OVERHEADS, CriticalSection, Overheads, Task, TaskSet
from ravenbrick.schedule.quantity import Time

__all__ = ["Blocking", "blocking_candidates", "ceilings"]

Cause = Literal["none", "section", "stated", "masked"]


@dataclass(frozen=True)
class Blocking:
    """A possible blocking: by a section of `task` on `resource`, by a stated bound, or masked.

    `inner` are the sections within it, itself included.
    """

    time: Time
    cause: Cause
    task: str = ""
    resource: str = ""
    inner: tuple[CriticalSection, ...] = ()

    def time_on(self, resource: str) -> Time:
        """How much of it is spent in sections on this object."""
        return time_on(self.inner, resource)


def time_on(sections: Iterable[CriticalSection], resource: str) -> Time:
    """Execution in sections on an object."""
    return sum(section.duration for section in sections if section.resource == resource)


NO_BLOCKING = Blocking(0, "none")


def ceilings(task_set: TaskSet) -> dict[str, int]:
    """Ceiling of each object: the highest priority among its users (RM D.3)."""
    found: dict[str, int] = {}
    for task in task_set:
        for section in task.sections:
            found[section.resource] = max(task.priority, found.get(section.resource, 0))
    return dict(sorted(found.items()))


def _within(task: Task, outer: CriticalSection) -> tuple[CriticalSection, ...]:
    """The sections of a task that lie within one of them, itself included."""
    return tuple(s for s in task.sections if outer.start <= s.start and s.end <= outer.end)


def blocking_candidates(
    task_set: TaskSet, task: Task, overheads: Overheads = NO_OVERHEADS
) -> tuple[Blocking, ...]:
    """All that may block a job of `task` once; only one of them does.

    Under the immediate ceiling protocol a job is blocked at most once, before it starts, by one
    section of a less urgent task whose object's ceiling is at least the job's priority
    (Baker 1991; Sha, Rajkumar, Lehoczky 1990). A masked section blocks in the same way.
    """
    ceiling_of = ceilings(task_set)
    found = [NO_BLOCKING]
    found += [
        Blocking(section.duration, "section", lower.name, section.resource, _within(lower, section))
        for lower in task_set.lower(task)
        for section in lower.sections
        if ceiling_of[section.resource] >= task.priority
    ]
    if task.blocking:
        found.append(Blocking(task.blocking, "stated"))
    if overheads.masked_section:
        found.append(Blocking(overheads.masked_section, "masked"))
    return tuple(found)
