# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The stack on which a program starts: of the start-up, the elaboration and the main procedure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ravenbrick.image.elf import ElfImage
from ravenbrick.timing.bounds import Bound, StackBound, deepest_of, stack_bounds
from ravenbrick.trace.recording import ENVIRONMENT

__all__ = ["NO_ENVIRONMENT", "EnvironmentStack", "environment_stack"]

# What the start-up (runtime/arm7tdmi/start.S) calls one after the other; `main` is the binder's
# procedure, which elaborates the library units and calls the main procedure.
CALLED_AT_START = (
    "ravenbrick_start_board",
    "ravenbrick_initialize_interrupts",
    "ravenbrick_initialize_threads",
    "ravenbrick_start_clock",
    "ravenbrick_start_alarm",
    "main",
    "ravenbrick_terminate",
)


@dataclass(frozen=True)
class EnvironmentStack:
    """What is called on this stack, without what a preemption saves, and how large it is."""

    bound: StackBound
    size_bytes: int

    def of_job(self, name: str, job: Bound) -> Bound:
        """A thread's job; that of the environment task with its whole stack."""
        if name != ENVIRONMENT:
            return job
        found = self.bound
        return replace(job, stack_bytes=found.bytes, stack_lost=found.lost, stack_gap=found.gap)


NO_ENVIRONMENT = EnvironmentStack(StackBound(0), 0)


def environment_stack(
    image: ElfImage, brick: Any, annotations: Sequence[tuple[str, str]]
) -> EnvironmentStack:
    """The stack of the environment task; loops and protected actions of the elaboration need no
    bound. `brick` has elaborated the program."""
    thread = next(found for found in brick.threads() if found.name == ENVIRONMENT)
    found = stack_bounds(image.content, CALLED_AT_START, annotations)
    return EnvironmentStack(deepest_of(found), thread.stack_size)
