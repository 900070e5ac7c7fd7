# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""All stacks with their bounds and sizes, and what to do about one that may be too small or of
which no bound was found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.facts.facts import TIMING_FILE
from ravenbrick.timing.observation.observed import refuse_exceeded
from ravenbrick.timing.task_set.scheduled_tasks import PREEMPTION_BYTES, deepest_stack
from ravenbrick.trace.recording import ENVIRONMENT

__all__ = [
    "MAY_OVERFLOW",
    "NO_BOUND",
    "SUFFICES",
    "check_stacks",
    "stack_lines",
    "stack_of",
    "stacks_of",
    "stacks_suffice",
]

HANDLERS = "interrupt handlers"
SUFFICES, MAY_OVERFLOW, NO_BOUND = "suffices", "may overflow", "no bound"
SIZES = {
    HANDLERS: "the linker's symbol ravenbrick_handler_stack_size",
    ENVIRONMENT: "the linker's symbol ravenbrick_environment_stack_size",
}


def stacks_of(analysis: Analysis, used: Mapping[str, int] | None = None) -> list[dict[str, Any]]:
    """All stacks in bytes: of tasks, of background threads, of the environment task, and the one
    that handlers share; `used` is what a run used of them.

    A bound is None where the analysis loses the depth, at the line `lost_at`, or cannot follow the
    code, for the reason `gap`. `words` say what to do about a stack that is not shown to suffice.
    """
    jobs = [(t.task, t.job) for t in analysis.tasks] + [*analysis.background.all_threads]
    found = [
        (task.name, deepest_stack(job), task.stack_bytes, job.stack_lost, job.stack_gap)
        for task, job in jobs
    ]
    start = analysis.environment
    if start.size_bytes and all(name != ENVIRONMENT for name, *_ in found):
        own = start.bound
        deepest = None if own.bytes is None else own.bytes + PREEMPTION_BYTES
        found.append((ENVIRONMENT, deepest, start.size_bytes, own.lost, own.gap))
    bodies = [cost.body for cost in analysis.interrupts]
    bodies += [event.body for event in analysis.events]
    lost = next((body.stack_lost for body in bodies if body.stack_bytes is None), None)
    found.append(
        (HANDLERS, analysis.interrupt_stack_bytes, analysis.handlers_stack_bytes, lost, None)
    )
    return [stack_of(*stack, (used or {}).get(stack[0].lower())) for stack in found]


def stack_of(
    name: str,
    bound: int | None,
    size: int,
    lost: str | None = None,
    gap: str | None = None,
    used: int | None = None,
) -> dict[str, Any]:
    """A stack with its verdict and, if it is not shown to suffice, with what to do."""
    if bound is None:
        verdict, words = NO_BOUND, _without_bound(name, size, lost, gap)
    elif bound > size:
        verdict, words = MAY_OVERFLOW, _too_small(name, bound, size)
    else:
        verdict, words = SUFFICES, None
    return {
        "name": name,
        "bound_bytes": bound,
        "size_bytes": size,
        "used_bytes": used,
        "lost_at": lost,
        "gap": gap,
        "verdict": verdict,
        "words": words,
    }


def _too_small(name: str, bound: int, size: int) -> str:
    return (
        f"{name} may need {bound} bytes of stack, and there are {size}: enlarge "
        f"{SIZES.get(name, 'its Storage_Size')}, or shorten its deepest calls"
    )


def _without_bound(name: str, size: int, lost: str | None, gap: str | None) -> str:
    head = f"no bound was found for the stack of {name} ({size} bytes)"
    if gap is not None:
        return f"{head}: {gap}"
    if lost is None:
        return (
            f"{head}: its depth is lost in code without source lines, or in a function that calls "
            f"itself; leave that call out, or state in {TIMING_FILE} that it is never executed: "
            '[[never]] symbol = "...", reason = "..."'
        )
    file, _, line = lost.rpartition(":")
    return (
        f"{head}: at {lost} it gets an object whose size is known only when the program runs, "
        "such as a string chosen by an 'if' expression; choose by an 'if' statement, or give the "
        f"object a constant size; if the line is never executed, state in {TIMING_FILE}: "
        f'[[never]] file = "{file.rpartition("/")[2]}", line = {line}, reason = "..."'
    )


def check_stacks(stacks: Sequence[dict[str, Any]]) -> None:
    """Raise `ExecutionTimeError` when a run used more of a stack than its bound, also of that of
    the environment task and of background tasks."""
    refuse_exceeded(
        [
            f"{name} showed a stack of {used}, above its bound of {bound}"
            for name, used, bound in (
                (s["name"], s["used_bytes"], s["bound_bytes"]) for s in stacks
            )
            if used is not None and bound is not None and used > bound
        ]
    )


def stacks_suffice(stacks: Sequence[dict[str, Any]]) -> bool | None:
    """Whether each stack is shown to suffice; None if only that of the environment task has no
    bound: it is used before any task runs."""
    if all(stack["verdict"] == SUFFICES for stack in stacks):
        return True
    judged = [s for s in stacks if (s["name"], s["verdict"]) != (ENVIRONMENT, NO_BOUND)]
    return None if all(stack["verdict"] == SUFFICES for stack in judged) else False


def stack_lines(stacks: Sequence[dict[str, Any]]) -> list[str]:
    """A sentence for each stack that is not shown to suffice, those that may overflow first."""
    order = (MAY_OVERFLOW, NO_BOUND)
    return [s["words"] for verdict in order for s in stacks if s["verdict"] == verdict]
