# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Own times of calls and of interrupts in a run that was recorded step by step.

The net time of a call leaves out interrupts, other threads while the caller waits or is preempted,
and the way back from a preemption (`resume`), which is counted by itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from verification.benchmarks.runtime.steps import EXCEPTION_CYCLES, IRQ_VECTOR, VECTORS_SIZE, Steps

__all__ = ["RESUME", "CallTimes"]

MODE_MASK = 0x1F
SYSTEM_MODE = 0x1F
THUMB_BIT = 1
RESUME = "resume"
IDLE = "ravenbrick_idle"
NOBODY, INTERRUPT = -1, -2


@dataclass(frozen=True)
class CallTimes:
    """Times of everything that was called in a recording; cycles."""

    steps: Steps
    _visits: dict[int, np.ndarray] = field(default_factory=dict, repr=False)

    @cached_property
    def _durations(self) -> np.ndarray:
        return np.diff(self.steps.records["at"].astype(np.int64), append=np.int64(0))

    @cached_property
    def _exceptions(self) -> np.ndarray:
        """Steps that take an interrupt: their address is that of what comes after it."""
        address = self.steps.records["address"]
        taken = np.zeros(address.size, bool)
        taken[:-1] = address[1:] == IRQ_VECTOR
        if not (self._durations[taken] == EXCEPTION_CYCLES).all():
            raise ValueError("the recording has interrupts of an unknown length")
        return taken

    def _inside(self, symbol: str) -> np.ndarray:
        address, size = self.steps.brick.symbol(symbol)
        found = self.steps.records["address"]
        return (found >= address & ~THUMB_BIT) & (found < (address & ~THUMB_BIT) + max(size, 4))

    @cached_property
    def _owners(self) -> np.ndarray:
        """By step the address of the thread's stack, or `NOBODY`, or `INTERRUPT`."""
        records = self.steps.records
        bottoms = np.array(sorted(t.stack_base for t in self.steps.brick.threads()), np.int64)
        index = np.searchsorted(bottoms, records["stack"].astype(np.int64) - 1, side="right") - 1
        owners = np.where(index >= 0, bottoms[index], NOBODY)
        handler = (records["status"] & MODE_MASK) != SYSTEM_MODE
        handler |= (records["address"] < VECTORS_SIZE) | self._exceptions
        # The jump that ends a switch is still of the thread that gives the processor away.
        arrived = np.flatnonzero((owners[1:] != owners[:-1]) & ~handler[1:] & ~handler[:-1]) + 1
        before = owners[arrived - 1]
        owners[arrived] = before
        owners[handler] = INTERRUPT
        owners[self._inside(IDLE)] = NOBODY
        owners[self._inside(RESUME)] = NOBODY
        return owners

    def _entries(self, symbol: str) -> np.ndarray:
        entry = self.steps.brick.symbol(symbol)[0] & ~THUMB_BIT
        return np.flatnonzero((self.steps.records["address"] == entry) & ~self._exceptions)

    def of_calls(self, symbol: str) -> list[int]:
        """Own times of all calls that returned, the fetches after the return included.

        Of calls made by handlers, only those that no other handler interrupted.
        """
        owners = self._owners
        entries = self._entries(symbol)
        found = []
        for owner in np.unique(owners[entries]).tolist():
            own = np.concatenate(([0], np.cumsum(np.where(owners == owner, self._durations, 0))))
            for first in entries[owners[entries] == owner].tolist():
                last = self._return(first)
                if last is None or (owner == INTERRUPT and self._exceptions[first:last].any()):
                    continue
                found.append(int(own[last] - own[first]))
        return found

    def _return(self, first: int) -> int | None:
        """The step after the return of the call that begins at a step."""
        records = self.steps.records
        link = int(records["link"][first]) & ~THUMB_BIT
        if link not in self._visits:
            self._visits[link] = np.flatnonzero(records["address"] == link)
        visits = self._visits[link]
        for step in visits[np.searchsorted(visits, first, side="right") :].tolist():
            if records["stack"][step] == records["stack"][first]:
                return int(step)
        return None

    def of_resumptions(self) -> list[int]:
        """From the first instruction of `resume` until the preempted thread goes on."""
        address = self.steps.records["address"]
        inside = self._inside(RESUME)
        found = []
        for first in self._entries(RESUME):
            last = first + int(np.argmin(inside[first:]))
            if not inside[last] and address[last] != IRQ_VECTOR:
                found.append(int(self._durations[first:last].sum()))
        return found

    def of_interrupts(self, handlers: Iterable[str]) -> dict[str, list[int]]:
        """From an exception until a thread goes on, by the handler; without nested ones."""
        records = self.steps.records
        thread = (records["status"] & MODE_MASK) == SYSTEM_MODE
        thread &= (records["address"] >= VECTORS_SIZE) & ~self._exceptions
        entries = {self.steps.brick.symbol(name)[0] & ~THUMB_BIT: name for name in handlers}
        taken = np.flatnonzero(self._exceptions)
        found: dict[str, list[int]] = {name: [] for name in entries.values()}
        for position, first in enumerate(taken.tolist()):
            if (records["status"][first] & MODE_MASK) != SYSTEM_MODE:
                continue
            last = first + int(np.argmax(thread[first:]))
            nested = position + 1 < taken.size and taken[position + 1] < last
            if not thread[last] or nested:
                continue
            called = [entries[a] for a in records["address"][first:last].tolist() if a in entries]
            if called:
                cycles = int(records["at"][last]) - int(records["at"][first])
                found[called[0]].append(cycles)
        return found
