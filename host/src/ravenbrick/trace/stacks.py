# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Stacks of the tasks, as a run used them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ravenbrick.image.memory import MemoryReport, TaskStack
from ravenbrick.trace.recording import Thread

__all__ = ["with_stacks"]


def with_stacks(report: MemoryReport, threads: Sequence[Thread]) -> MemoryReport:
    """The report with each task's Storage_Size and high-water mark as a run found them."""
    known = {task.name.lower(): task for task in report.tasks}
    nothing = TaskStack("", None, None, None, None)
    seen = [
        TaskStack(
            thread.name,
            before.declared_bytes,
            before.object_bytes,
            thread.stack_bytes,
            max(thread.stack_used_bytes, before.used_bytes or 0),
        )
        for thread in threads
        for before in [known.get(thread.name.lower(), nothing)]
    ]
    names = {thread.name.lower() for thread in threads}
    unseen = [task for task in report.tasks if task.name.lower() not in names]
    return replace(report, tasks=(*seen, *unseen))
