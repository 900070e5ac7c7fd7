# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocking of interrupts by less urgent tasks and handlers.

Either a protected action disables its source, or interrupts are masked: in a service of the
run-time, in the entry and exit of an interrupt, in stretches of the alarm's handler. One masked
stretch may go on in another. A thread that gives the processor away with interrupts masked hands it
to one that goes on masked when this was interrupted just as it masked interrupts: the processor
takes an interrupt that is pending when the instruction that masks ends. So may a handler.

A protected action is not added to. Its thread is at least as urgent as the interrupt before the
source is disabled, so it is not preempted, and nobody can hand the processor to it. It ends with
interrupts masked only in an entry call that waits, and the bound of this service holds the action.

Handlers that were interrupted just as they masked exit one after the other, at
most one of each level below. Only the last may preempt a thread. An interrupt's entry and the
preemption, which are counted with its exit, are longer than three more exits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Task
from ravenbrick.timing.bounds import Bound
from ravenbrick.timing.initial_state import ALARM_SOURCE
from ravenbrick.timing.kernel import InterruptCost, Services, entry_exit_cycles
from ravenbrick.timing.task_set.events import EventCost

__all__ = ["InterruptBlocking", "interrupt_blocking"]

# Exits of interrupts, masked throughout, that are no longer than an entry and an exit.
EXITS = 4


@dataclass(frozen=True)
class InterruptBlocking:
    """Bounds of the blocking of interrupts, in cycles; `entry_exit` is an interrupt's entry
    and exit."""

    kernel: Services
    entry_exit: int
    handlers: tuple[InterruptCost, ...]
    events: tuple[EventCost, ...]

    def _handler(self, cost: InterruptCost) -> int:
        """Longest masked stretch of a handler."""
        if cost.handler.source != ALARM_SOURCE:
            return self.kernel.longest_masked(cost.body.reached)[0]
        # It unmasks between two releases: no stretch is longer than a call that releases one.
        expiries = (event.masked_cycles for event in self.events)
        inside = (self.kernel.longest_masked(event.body.reached)[0] for event in self.events)
        return max([cost.body.cycles, *expiries, *inside])

    def _sections(self, level: int, jobs: Sequence[tuple[Task, Bound]]) -> list[int]:
        """Protected actions with a ceiling of at least this priority."""
        bodies = [job for _, job in jobs]
        bodies += [cost.body for cost in self.handlers if cost.handler.priority < level]
        bodies += [event.body for event in self.events if event.handler.priority < level]
        return [body.longest_critical_section(2 * level) for body in bodies]

    def longest_cycles(self, level: int, jobs: Sequence[tuple[Task, Bound]]) -> int:
        """Longest blocking of an interrupt of this priority by tasks and handlers below it."""
        tasks = sum(self.kernel.resumed_masked_cycles(job.reached) for _, job in jobs)
        below = [cost for cost in self.handlers if cost.handler.priority < level]
        levels = len({cost.handler.priority for cost in below})
        entries_exits = self.entry_exit * (1 + max(0, levels - EXITS))
        stretch = entries_exits + max([tasks, *(self._handler(cost) for cost in below)])
        return max([stretch, *self._sections(level, jobs)])


def interrupt_blocking(
    image: ElfImage,
    costs: Sequence[InterruptCost],
    events: Sequence[EventCost],
    kernel: Services,
    annotations: Sequence[tuple[str, str]],
) -> InterruptBlocking:
    """From the handlers of a program, the alarm's first."""
    entry_exit = entry_exit_cycles(image, costs[0], annotations)
    return InterruptBlocking(kernel, entry_exit, tuple(costs), tuple(events))
