# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How long an interrupt may be kept waiting by what is less urgent.

Either a protected action disables its source, or interrupts are masked: in a service of the
run-time, in the way in and out of an interrupt, in stretches of the alarm's handler. One masked
stretch may go on in another. A thread that gives the processor away with interrupts masked hands it
to one that goes on masked when this was interrupted just as it masked interrupts: the processor
takes an interrupt that is pending when the instruction that masks ends. So may a handler.

A protected action is not added to. Its thread is at least as urgent as the interrupt before the
source is disabled, so it is not preempted, and nobody can hand the processor to it. It ends with
interrupts masked only in an entry call that waits, and the bound of this service holds the action.

Handlers that were interrupted just as they masked make their ways out one after the other, at
most one of each level below. Only the last may preempt a thread. An interrupt's way in and the
preemption, which are counted with its way out, are longer than three more ways out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Task
from ravenbrick.timing.bounds import Bound
from ravenbrick.timing.events import EventCost
from ravenbrick.timing.kernel import InterruptCost, Services, passage_cycles
from ravenbrick.timing.started import ALARM_SOURCE

__all__ = ["Masking", "masking"]

# Ways out of interrupts, masked throughout, that are no longer than a way in and out.
WAYS_OUT = 4


@dataclass(frozen=True)
class Masking:
    """Bounds of what keeps interrupts waiting, in cycles; `passage` is an interrupt's way in and
    out."""

    kernel: Services
    passage: int
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
        return [body.longest_section(2 * level) for body in bodies]

    def waiting(self, level: int, jobs: Sequence[tuple[Task, Bound]]) -> int:
        """Longest that tasks and handlers below this priority keep an interrupt of it waiting."""
        tasks = sum(self.kernel.going_on_masked(job.reached) for _, job in jobs)
        below = [cost for cost in self.handlers if cost.handler.priority < level]
        levels = len({cost.handler.priority for cost in below})
        passages = self.passage * (1 + max(0, levels - WAYS_OUT))
        stretch = passages + max([tasks, *(self._handler(cost) for cost in below)])
        return max([stretch, *self._sections(level, jobs)])


def masking(
    image: ElfImage,
    costs: Sequence[InterruptCost],
    events: Sequence[EventCost],
    kernel: Services,
    annotations: Sequence[tuple[str, str]],
) -> Masking:
    """From the handlers of a program, the alarm's first."""
    passage = passage_cycles(image, costs[0], annotations)
    return Masking(kernel, passage, tuple(costs), tuple(events))
