# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Net execution times of jobs: without the entry and exit of the interrupts during them.

A trace notes an interrupt when the controller hands it over and when it is told the end. What the
processor does before and after for the interrupt lies in the segments of the interrupted task.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ravenbrick.trace.recording import EventKind, Recording
from ravenbrick.trace.schedule import stretches

__all__ = ["interruption_cycles", "stolen_cycles"]

# Least that lies outside of the noted interrupt (runtime/arm7tdmi/interrupt.S, from RAM at address
# 0 in every image): 19 cycles before it and 31 after it; a preemption in the exit and the later
# return to the task take 86 more.
ENTRY_EXIT_CYCLES = 50
PREEMPTION_CYCLES = 86
# Within this time of an interrupt's end, another task is selected by its exit only: a return to
# the task, which then gives the processor away, takes longer.
EXIT_CYCLES = 100
# A transfer is charged at the latest at the end of the instruction during which it happens.
CHARGED_LATER_CYCLES = 64


def interruption_cycles(
    recording: Recording, thread: int, release: NDArray[np.int64], end: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Cycles of interrupts in a thread's segments, at least, for each of its jobs in order; jobs
    begin at `release` and end at `end`, cycles."""
    kinds = (EventKind.INTERRUPT_ENTERED, EventKind.INTERRUPT_LEFT, EventKind.THREAD_RUNNING)
    events = recording.of_kind(*kinds)
    at, kind = events["at_cycles"].astype(np.int64), events["kind"]
    entered, left, selected = (kind == int(which) for which in kinds)
    depth = np.cumsum(entered.astype(np.int64) - left)
    places = np.where(selected, np.arange(at.size), -1)
    latest = np.maximum.accumulate(places)
    running = (latest >= 0) & (events["subject"][np.maximum(latest, 0)] == thread)
    outermost = entered & (depth == 1) & running
    soon = np.zeros(at.size, bool)
    soon[:-1] = selected[1:] & (np.diff(at) < EXIT_CYCLES)
    preempted = left & (depth == 0) & running & soon
    cycles = np.where(outermost, ENTRY_EXIT_CYCLES, 0) + np.where(preempted, PREEMPTION_CYCLES, 0)
    spent = np.concatenate(([0], np.cumsum(cycles)))
    found = spent[np.searchsorted(at, end)] - spent[np.searchsorted(at, release)]
    return np.asarray(found, np.int64)


def stolen_cycles(
    recording: Recording,
    thread: int,
    release: NDArray[np.int64],
    end: NDArray[np.int64],
    transfer_cycles: int,
) -> NDArray[np.int64]:
    """Cycles that the data controller took from a thread, at most, for each of its jobs as above;
    none where the run does not have the transfers."""
    if not recording.transfers:
        return np.zeros(release.size, np.int64)
    at = np.sort(np.concatenate(list(recording.transfers.values())))
    every = stretches(recording)
    mine = every.owner == thread
    first, last = every.begin[mine], every.end[mine]
    inside = np.searchsorted(at, last) - np.searchsorted(at, first - CHARGED_LATER_CYCLES)
    taken = np.concatenate(([0], np.cumsum(inside)))
    before = np.searchsorted(first, release, side="left")
    after = np.searchsorted(first, end, side="left")
    return np.asarray(transfer_cycles * (taken[after] - taken[before]), np.int64)
