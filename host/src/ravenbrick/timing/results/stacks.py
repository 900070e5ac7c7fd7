# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""All stacks with their bounds and sizes, and what to do about one that may be too small."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.initial_state import ENVIRONMENT
from ravenbrick.timing.scheduled_tasks import deepest_stack

__all__ = ["stack_lines", "stacks_of", "stacks_suffice"]

HANDLERS = "interrupt handlers"
KEYS = ("name", "bound_bytes", "size_bytes", "lost_at")


def stacks_of(analysis: Analysis) -> list[dict[str, Any]]:
    """All stacks in bytes: of tasks, of background threads, and the one that handlers share. A
    bound is None where the analysis loses the depth, at the line `lost_at`."""
    threads = [(t.task, t.stack_bound_bytes, t.job.stack_lost) for t in analysis.tasks]
    threads += [(t, deepest_stack(j), j.stack_lost) for t, j in analysis.background.all_threads]
    found = [(task.name, bound, task.stack_bytes, lost) for task, bound, lost in threads]
    bodies = [cost.body for cost in analysis.interrupts]
    bodies += [event.body for event in analysis.events]
    lost = next((body.stack_lost for body in bodies if body.stack_bytes is None), None)
    found.append((HANDLERS, analysis.interrupt_stack_bytes, analysis.handlers_stack_bytes, lost))
    return [dict(zip(KEYS, stack, strict=True)) for stack in found]


def stacks_suffice(stacks: Sequence[dict[str, Any]]) -> bool | None:
    """Whether each stack has a bound that is not above its size; None if only that of the
    environment task has none, whose elaboration is not bounded."""
    unjudged = [s for s in stacks if s["name"] == ENVIRONMENT and s["bound_bytes"] is None]
    if stack_lines([stack for stack in stacks if stack not in unjudged]):
        return False
    return None if unjudged else True


def _without_bound(name: str, size_bytes: int, lost_at: str | None) -> str:
    head = f"no bound was found for the stack of {name} ({size_bytes} bytes)"
    if name == ENVIRONMENT:
        return f"{head}: it elaborates the program, too, and that is not bounded"
    if lost_at is None:
        return head
    return (
        f"{head}: at {lost_at} it gets an object whose size is known only when the program runs, "
        "such as a string chosen by an 'if' expression; choose by an 'if' statement, or give the "
        "object a constant size"
    )


def stack_lines(stacks: Sequence[dict[str, Any]]) -> list[str]:
    """A sentence for each stack that is not shown to suffice."""
    lines = []
    for name, bound, size, lost_at in ([stack[key] for key in KEYS] for stack in stacks):
        if bound is None:
            lines.append(_without_bound(name, size, lost_at))
        elif bound > size:
            symbol = "the linker's symbol ravenbrick_handler_stack_size"
            enlarge = f"enlarge {symbol if name == HANDLERS else 'its Storage_Size'}"
            lines.append(
                f"{name} may need {bound} bytes of stack, and there are {size}: {enlarge}, or "
                "shorten its deepest calls"
            )
    return lines
