# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a run shows about facts on jobs: which have a deadline, common releases, and interrupts that
jobs request."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.project.robot import Robot, Task
from ravenbrick.schedule.beginning import Request
from ravenbrick.timing.facts.facts import SOURCE_NUMBERS, Facts
from ravenbrick.timing.observation.net_execution_time import interruption_cycles, stolen_cycles
from ravenbrick.trace.recording import ENVIRONMENT, EventKind, Recording
from ravenbrick.trace.schedule import all_jobs, jobs_of, releases_of, stretches

__all__ = [
    "TOLERANCE_CYCLES",
    "FactCount",
    "common_release",
    "have_deadline",
    "request_counts",
    "rest_counts",
    "together_counts",
]

Cycles = NDArray[np.int64]
CLOCK_HZ = float(MASTER_CLOCK.hertz)
TOLERANCE_CYCLES = 48


@dataclass(frozen=True)
class FactCount:
    """A fact, what it declares, what was seen, and where that was too much, in words; the mode in
    which it holds, empty for always."""

    fact: str
    place: str
    declared: int
    seen: int
    excess: str = ""
    mode: str = ""

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {**vars(self), "holds": not self.excess}


def have_deadline(
    task: Task | None, release: Cycles, outside: Collection[str]
) -> NDArray[np.bool_]:
    """Which jobs of a task have one, by their releases. A cyclic task in `outside` is released anew
    after a job without one, so the next release is not a period later; of the last job it is not
    known."""
    if task is None or task.release != "cyclic" or task.name not in outside:
        return np.ones(release.size, np.bool_)
    away = np.diff(release) - MASTER_CLOCK.cycles_of_us(task.period_us or 0)
    return np.append(np.abs(away) <= TOLERANCE_CYCLES, False)[: release.size]


def _releases(recording: Recording, task: str) -> Cycles:
    """Nominal releases of a cyclic task, without the one of its start."""
    return releases_of(recording, recording.thread_index(task))[1:]


def common_release(facts: Facts, recording: Recording) -> int:
    """The last of the first releases of the tasks with a common release."""
    releases = [_releases(recording, name) for name in facts.together]
    return max((int(at[0]) for at in releases if at.size), default=0)


def together_counts(robot: Robot, facts: Facts, recording: Recording) -> list[FactCount]:
    """How far releases of the tasks with a common release are from whole periods after the last of
    their first ones, or from so long behind these: then of jobs, after which a task keeps its
    period."""
    releases = {name: _releases(recording, name) for name in sorted(facts.together)}
    common = common_release(facts, recording)
    for name in sorted(facts.in_jobs):
        at = _releases(recording, name)
        releases[name] = at[have_deadline(robot.task(name), at, {name})]
    found = []
    for name, at in releases.items():
        task = robot.task(name)
        period = float(MASTER_CLOCK.hertz * ((task and task.period_us) or 0) / 1_000_000)
        behind = float(MASTER_CLOCK.hertz * facts.in_jobs.get(name, 0) / 1_000_000)
        later = at[at >= common]
        periods = (later - common - behind) / period
        away = np.ceil(np.abs(periods - np.round(periods)) * period)
        worst = int(away.argmax()) if away.size else 0
        seen = int(away[worst]) if away.size else 0
        excess = ""
        if seen > TOLERANCE_CYCLES:
            when = f"at {later[worst] / CLOCK_HZ:.6f} s"
            excess = f"{name} is released {seen} cycles away from whole periods after it {when}"
        fact = f"{facts.name}: [[common_release]]"
        found.append(FactCount(fact, name, TOLERANCE_CYCLES, seen, excess))
    return found


def _spans(recording: Recording, task: str) -> list[tuple[int, int]]:
    """Release and completion of each job of a task; a job under way lasts beyond the run."""
    if task not in (thread.name for thread in recording.threads):
        return []
    later = recording.stop.at_cycles + 1
    return [
        (job.release_cycles, later if job.completion_cycles is None else job.completion_cycles)
        for job in jobs_of(recording, recording.thread_index(task))
    ]


def request_counts(
    requests: Sequence[Request], facts: Facts, recording: Recording, since: int
) -> list[FactCount]:
    """How long after jobs that request them interrupts come, or after the elaboration: until all
    tasks have started, it requests them as a job would."""
    entered = recording.of_kind(EventKind.INTERRUPT_ENTERED)
    started = max((jobs[0].release_cycles for jobs in all_jobs(recording) if jobs), default=0)
    elaboration = [span for span in _spans(recording, ENVIRONMENT) if span[0] < started]
    found = []
    for request in requests:
        source = SOURCE_NUMBERS.get(request.source)
        stated = next((fact for fact in facts.requests if fact.source == source), None)
        if stated is None:
            continue
        at = entered["at_cycles"][entered["subject"] == source].astype(np.int64)
        at = at[at >= since]
        jobs = [*elaboration]
        for task in request.tasks:
            jobs += _spans(recording, task)
        begins, ends = np.array(sorted(jobs), np.int64).reshape(-1, 2).T
        before = np.searchsorted(begins, at, side="right") - 1
        over = np.append(np.maximum.accumulate(ends), 0)[before]
        late = at - over
        worst = int(late.argmax()) if late.size else 0
        seen = max(0, math.ceil(late[worst] * 1_000_000 / CLOCK_HZ)) if late.size else 0
        excess = ""
        if seen > stated.lasts_us:
            names, when = ", ".join(request.tasks), f"at {at[worst] / CLOCK_HZ:.6f} s"
            excess = f"declared {stated.lasts_us} us, seen {seen} us after a job of {names} {when}"
        fact = f'{stated.file}: [[request]] source = "{request.source}"'
        found.append(FactCount(fact, request.source, stated.lasts_us, seen, excess))
    return found


def _executed(recording: Recording, thread: int, at: Cycles) -> Cycles:
    """How long a thread has had the processor, at these instants."""
    every = stretches(recording)
    mine = every.owner == thread
    begin, length = every.begin[mine], (every.end - every.begin)[mine]
    before = np.concatenate(([0], np.cumsum(length)))
    place = np.searchsorted(begin, at, side="right")
    latest = np.maximum(place - 1, 0)
    into = np.where(place > 0, np.minimum(at - begin[latest], length[latest]), 0)
    return np.asarray(before[latest] + into, np.int64)


def rest_counts(
    requests: Sequence[Request], facts: Facts, recording: Recording, since: int
) -> list[FactCount]:
    """What jobs execute at most from the first interrupt that they requested to their end, beside
    the bound of that. Jobs so soon after the one before that it may have requested it are left out;
    so are the transfers of the data controller, by one cycle each."""
    entered = recording.of_kind(EventKind.INTERRUPT_ENTERED)
    found = []
    for request in requests:
        source = SOURCE_NUMBERS.get(request.source)
        stated = next((fact for fact in facts.requests if fact.source == source), None)
        at = entered["at_cycles"][entered["subject"] == source].astype(np.int64)
        if stated is None or not at.size:
            continue
        for task, most in request.rest:
            release, end = np.array(_spans(recording, task), np.int64).reshape(-1, 2).T
            over = np.concatenate(([0], end[:-1])) + int(request.lasts)
            first = at[np.minimum(np.searchsorted(at, release), at.size - 1)]
            chosen = (release >= max(since, 1)) & (over < release)
            chosen &= (release <= first) & (first < end) & (end <= recording.stop.at_cycles)
            thread = recording.thread_index(task)
            begin, end = first[chosen], end[chosen]
            own = _executed(recording, thread, end) - _executed(recording, thread, begin)
            own -= interruption_cycles(recording, thread, begin, end)
            own -= stolen_cycles(recording, thread, begin, end, 1)
            seen, excess = int(own.max(initial=0)), ""
            if seen > most:
                when = f"at {begin[int(own.argmax())] / CLOCK_HZ:.6f} s"
                excess = f"{task} executes {seen} cycles after it, not {most} at most, {when}"
            fact = f'{stated.file}: [[request]] source = "{request.source}"'
            found.append(FactCount(fact, task, int(most), seen, excess))
    return found
