# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""From an edge at an input to its effect at an output, through tasks that pass data on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.facts.facts import SOURCE_NUMBERS, Chain
from ravenbrick.trace.recording import EventKind, Recording
from ravenbrick.trace.schedule import Job, jobs_of

__all__ = ["ChainDelay", "chain_delay"]


@dataclass(frozen=True)
class ChainDelay:
    """Delays in cycles: from a release of the first stage to the output, and from an edge that
    came just too late for the release before."""

    name: str
    stages: tuple[str, ...]
    edge_bound_cycles: int | None
    sample_bound_cycles: int | None
    sample_min_cycles: int | None
    sample_max_cycles: int | None
    edge_max_cycles: int | None
    count: int

    @property
    def jitter_cycles(self) -> int | None:
        """Largest less smallest observed delay."""
        if self.sample_max_cycles is None or self.sample_min_cycles is None:
            return None
        return self.sample_max_cycles - self.sample_min_cycles


def _bound(analysis: Analysis, chain: Chain) -> int | None:
    """From a sample. Each stage waits for its next release that takes the data, then responds; the
    first stage's wait is left out (Davare et al. 2007)."""
    total = MASTER_CLOCK.cycles_of_us(chain.transfer_us)
    for position, (name, every) in enumerate(chain.stages):
        found = analysis.bounds[name]
        if found.bound is None:
            return None
        waited = every * found.task.period if position else 0
        total += math.ceil(waited + found.bound)
    return total


def _edge_bound(analysis: Analysis, chain: Chain, sample: int | None) -> int | None:
    """From an edge: it is counted by its interrupt's handler, then waits for the next sample."""
    first, every = chain.stages[0]
    counted = analysis.bounds[chain.edge].bound if chain.edge in analysis.bounds else 0
    if sample is None or counted is None:
        return None
    return sample + math.ceil(counted + every * analysis.bounds[first].task.period)


def _jobs(recording: Recording, task: str) -> list[Job]:
    jobs = jobs_of(recording, recording.thread_index(task))[1:]
    return [job for job in jobs if job.completion_cycles]


def _observed(recording: Recording, chain: Chain) -> list[tuple[int, int, int]]:
    """For each change of an output: its instant, back through the stages the release that sampled,
    and the release before."""
    columns = []
    for name, _ in reversed(chain.stages):
        jobs = _jobs(recording, name)
        columns.append(
            (
                np.array([job.release_cycles for job in jobs], np.int64),
                np.array([job.completion_cycles for job in jobs], np.int64),
            )
        )
    found = []
    for at in recording.of_kind(EventKind.MOTOR_COMMAND)["at_cycles"].astype(np.int64).tolist():
        before = at
        for releases, completions in columns:
            index = int(np.searchsorted(completions, before, side="right")) - 1
            if index < 0:
                break
            before = int(releases[index])
        else:
            previous = int(columns[-1][0][index - 1]) if index > 0 else before
            found.append((at, before, previous))
    return found


def _edge_delays(
    recording: Recording, source: str, changes: list[tuple[int, int, int]]
) -> list[int]:
    """For each change, from the first edge since the release before the one that sampled."""
    entered = recording.of_kind(EventKind.INTERRUPT_ENTERED)
    chosen = entered["subject"] == SOURCE_NUMBERS[source]
    edges = entered["at_cycles"][chosen].astype(np.int64)
    found = []
    for at, sampled, previous in changes:
        index = int(np.searchsorted(edges, previous, side="right"))
        if index < edges.size and edges[index] <= sampled:
            found.append(at - int(edges[index]))
    return found


def chain_delay(analysis: Analysis, recording: Recording, chain: Chain) -> ChainDelay:
    """Bound and observation of a chain; an edge can come right after the first stage sampled."""
    changes = _observed(recording, chain)
    delays = [at - sampled for at, sampled, _ in changes]
    edges = _edge_delays(recording, chain.edge, changes) if chain.edge else []
    bound = _bound(analysis, chain)
    return ChainDelay(
        chain.name,
        tuple(name for name, _ in chain.stages),
        _edge_bound(analysis, chain, bound),
        bound,
        min(delays, default=None),
        max(delays, default=None),
        max(edges, default=None),
        len(delays),
    )
