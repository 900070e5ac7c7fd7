# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a run counted about each fact, beside what the fact declares."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot
from ravenbrick.schedule.beginning import Request
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.facts.counted_facts import CountedFact
from ravenbrick.timing.facts.facts import Facts, InterruptLoad
from ravenbrick.timing.observation.job_facts import (
    FactCount,
    common_release,
    have_deadline,
    request_counts,
    rest_counts,
    together_counts,
)
from ravenbrick.trace.flow_counts import NO_THREAD, FlowCount
from ravenbrick.trace.interrupts import source_name
from ravenbrick.trace.recording import EventKind, Recording
from ravenbrick.trace.schedule import Job, cyclic_begin_cycles, jobs_of, releases_of

__all__ = ["check_facts_of_run", "fact_counts", "latest", "left_modes", "most_in_window"]

Cycles = NDArray[np.int64]
CLOCK_HZ = float(MASTER_CLOCK.hertz)
DELAYED = 2  # thread state (docs/reference/trace.md)


def most_in_window(at: Cycles, window_cycles: int) -> tuple[int, int]:
    """Most instants of a sorted column in any window of this length, and when the first of these
    windows begins."""
    if not at.size:
        return 0, 0
    counts = np.searchsorted(at, at + window_cycles) - np.arange(at.size)
    place = int(counts.argmax())
    return int(counts[place]), int(at[place])


def latest(at: Cycles, at_most: int, period_cycles: float) -> tuple[int, int]:
    """Longest lateness of a sorted column, in cycles, and when: how much sooner than after the
    whole number of periods between them one comes after another, every `at_most`-th counted."""
    longest = (0, 0)
    for first in range(min(at_most, at.size)):
        each = at[first::at_most]
        steps = each - period_cycles * np.arange(each.size)
        late = np.maximum.accumulate(steps) - steps
        place = int(late.argmax())
        longest = max(longest, (math.ceil(late[place]), int(each[place])))
    return longest


class _Run:
    """Who had the processor when, in words."""

    def __init__(self, robot: Robot, recording: Recording) -> None:
        self.since = cyclic_begin_cycles(robot, recording)
        self._robot, self.recording = robot, recording
        kinds = (EventKind.INTERRUPT_ENTERED, EventKind.INTERRUPT_LEFT)
        events = recording.of_kind(*kinds)
        self._at = events["at_cycles"].astype(np.int64)
        self._source = events["subject"].astype(np.int64)
        entered = events["kind"] == int(EventKind.INTERRUPT_ENTERED)
        self._depth = np.cumsum(np.where(entered, 1, -1))
        self._entered = entered

    def handler(self, at: int) -> str | None:
        """The source of the handler that runs at an instant; none between handlers."""
        place = int(np.searchsorted(self._at, at, side="right")) - 1
        if place < 0 or self._depth[place] <= 0:
            return None
        same = self._entered[: place + 1] & (self._depth[: place + 1] == self._depth[place])
        return source_name(int(self._source[np.flatnonzero(same)[-1]]))

    def job(self, thread: int, at: int) -> tuple[int, Job] | None:
        """The job of a thread at an instant with its number, from 1."""
        jobs = jobs_of(self.recording, thread)
        numbered = [(n, job) for n, job in enumerate(jobs, 1) if job.release_cycles <= at]
        if not numbered:
            return None
        number, job = numbered[-1]
        over = job.completion_cycles is not None and job.completion_cycles < at
        return None if over else (number, job)

    def is_cyclic(self, thread: int) -> bool:
        """Does the end of a delay release this thread's task?"""
        task = self._robot.task(self.recording.threads[thread].name)
        return task is not None and task.release == "cyclic"

    def in_jobs_with_deadline(self, arrivals: NDArray[np.void]) -> NDArray[np.bool_]:
        """Which arrivals are in a job with a deadline, not in a handler? Shape (n,)."""
        at, threads = arrivals["at_cycles"].astype(np.int64), arrivals["thread"]
        depth = np.append(0, self._depth)[np.searchsorted(self._at, at, side="right")]
        found = np.zeros(at.size, np.bool_)
        for thread in np.unique(threads[threads != NO_THREAD]):
            mine = threads == thread
            found[mine] = self._in_jobs_of(int(thread), at[mine])
        return found & (depth <= 0)

    def _in_jobs_of(self, thread: int, at: Cycles) -> NDArray[np.bool_]:
        """At which instants is this thread's task in a job with a deadline? Shape (n,)."""
        jobs = jobs_of(self.recording, thread)
        task = self._robot.task(self.recording.threads[thread].name)
        if task is None or task.release == "background" or not jobs:
            return np.zeros(at.size, np.bool_)
        never = np.iinfo(np.int64).max
        release = np.array([job.release_cycles for job in jobs], np.int64)
        ends = (job.completion_cycles for job in jobs)
        completion = np.array([never if end is None else end for end in ends], np.int64)
        number = np.searchsorted(release, at, side="right") - 1
        kept = have_deadline(task, release, {task.name})
        return np.asarray((number >= 0) & (completion[number] >= at) & kept[number])

    def words(self, thread: int | None, at: int) -> str:
        """Instant and job."""
        when = f"at {float(MASTER_CLOCK.seconds(at)):.6f} s"
        source = self.handler(at)
        if source is not None:
            return f"{when}, in the handler of {source}"
        if thread is None:
            return when
        name, found = self.recording.threads[thread].name, self.job(thread, at)
        return f"{when}, {name}" if found is None else f"{when}, job {found[0]} of {name}"


def _instant(arrival: Any) -> int:
    return int(arrival["at_cycles"])


def _thread(arrival: Any) -> int | None:
    thread = int(arrival["thread"])
    return None if thread == NO_THREAD else thread


def _code_at(image: ElfImage, address: int) -> str:
    names = [name for name, symbol in image.symbols.items() if symbol.address & ~1 == address]
    return min(names, default=f"{address:#010x}")


def _unseen(found: FactCount, count: FlowCount) -> FactCount:
    """A fact that holds as far as arrivals are kept, where more of them came."""
    if not count.dropped:
        return found
    end = f"{float(count.arrivals['at_cycles'][-1]) / CLOCK_HZ:.6f} s"
    looked_at = f"the first {count.arrivals.size} times that {found.place} is executed"
    return replace(found, excess=f"only {looked_at}, until {end}, are looked at: run it shorter")


def _flow_count(run: _Run, image: ElfImage, fact: CountedFact, count: FlowCount) -> FactCount:
    """What the program executes of a fact; one of a mode holds wherever the code is executed."""
    arrivals = count.arrivals[count.arrivals["at_cycles"] >= run.since]
    in_jobs = fact.table == "avoided" and not fact.mode
    if in_jobs:
        arrivals = arrivals[run.in_jobs_with_deadline(arrivals)]
    text = fact.fact.replace("[[avoided]]", "[[outside]]" if in_jobs else "[[never]]")
    if fact.mode:
        text = text.replace("[[", "[[mode.")
    seen = count.most if fact.table in ("loop", "recursion", "flow") else 0
    found = FactCount(text, fact.place, fact.declared, min(seen, fact.declared), mode=fact.mode)
    if not arrivals.size:
        return _unseen(found, count)
    worst = arrivals[arrivals["count"].argmax()]
    where = f"{run.words(_thread(worst), _instant(worst))}, {fact.place}"
    if fact.table == "call":
        target = _code_at(image, int(worst["target"]))
        return replace(found, declared=0, seen=1, excess=f"seen the target {target} {where}")
    seen = arrivals.size if fact.table in ("never", "avoided") else int(worst["count"])
    executions = " executions in a job" if in_jobs else " executions"
    units = {"never": executions, "avoided": executions, "recursion": " activations"}
    units["flow"] = " executions in one call"
    numbers = f"declared {fact.declared}, seen {seen}{units.get(fact.table, '')}"
    return replace(found, seen=seen, excess=f"{numbers} {where}")


def _turn_count(
    run: _Run, robot: Robot, facts: Facts, fact: CountedFact, count: FlowCount
) -> FactCount:
    """How often jobs of a turn execute what they do not."""
    assert fact.turn is not None
    (turn, name), common = fact.turn, common_release(facts, run.recording)
    stated, task = facts.in_turn(name), robot.task(name)
    assert stated is not None and task is not None
    thread = run.recording.thread_index(name)
    at = count.arrivals["at_cycles"][count.arrivals["thread"] == thread].astype(np.int64)
    release = releases_of(run.recording, thread)
    latest = release[np.searchsorted(release, at, side="right") - 1]
    period = float(MASTER_CLOCK.hertz * (task.period_us or 0) / 1_000_000)
    number = np.round((latest - common) / period).astype(np.int64)
    wrong = at[(number % len(stated.never) == turn) & (at >= run.since)]
    found = FactCount(fact.fact, fact.place, 0, int(wrong.size))
    if not wrong.size:
        return _unseen(found, count)
    excess = f"a job of turn {turn + 1} executes {fact.place} {run.words(thread, int(wrong[0]))}"
    return replace(found, excess=excess)


def _rate(run: _Run, fact: str, place: str, limits: tuple[int, int], at: Cycles) -> FactCount:
    at_most, window_us = limits
    seen, begin = most_in_window(at[at >= run.since], MASTER_CLOCK.cycles_of_us(window_us))
    excess = ""
    if seen > at_most:
        excess = f"declared {at_most}, seen {seen} in {window_us} us at {begin / CLOCK_HZ:.6f} s"
    return FactCount(fact, place, at_most, seen, excess)


def _lateness(run: _Run, fact: str, load: InterruptLoad, at: Cycles) -> FactCount:
    """How late interrupts come that are said to be periodic with some lateness, in us."""
    period = float(MASTER_CLOCK.hertz * load.window_us / 1_000_000)
    late, when = latest(at[at >= run.since], load.at_most, period)
    late_us, excess = math.ceil(late * 1_000_000 / CLOCK_HZ), ""
    if late_us > load.late_us:
        what = f"{load.at_most} each {load.window_us} us"
        excess = (
            f"declared {what} late by {load.late_us} us, seen late by {late_us} us "
            f"at {when / CLOCK_HZ:.6f} s"
        )
    return FactCount(fact, source_name(load.source), load.late_us, late_us, excess)


def _interrupts(run: _Run, load: InterruptLoad, table: str, recording: Recording) -> FactCount:
    """Interrupts of one load."""
    entered = recording.of_kind(EventKind.INTERRUPT_ENTERED)
    at = entered["at_cycles"][entered["subject"] == load.source].astype(np.int64)
    name = source_name(load.source)
    fact = f'{load.file}: [[{table}]] source = "{name}"'
    if load.late_us:
        return _lateness(run, fact, load, at)
    if load.task is None:
        return _rate(run, fact, name, (load.at_most, load.window_us), at)
    return _after_releases(run, load, fact, at, recording)


def _rates(run: _Run, facts: Facts, image: ElfImage, recording: Recording) -> list[FactCount]:
    """Interrupts and transfers in any window, or in windows from the releases of a task."""
    found = [_interrupts(run, load, "interrupt", recording) for load in facts.interrupts]
    for mode in facts.modes:
        counts = (_interrupts(run, load, "mode.interrupt", recording) for load in mode.interrupts)
        found += [replace(count, mode=mode.name) for count in counts]
    loads = facts.transfer_loads(image) if recording.transfers is not None else {}
    for peripheral, at in (recording.transfers or {}).items():
        for stated in loads.get(peripheral, ()):
            fact = f'[[transfer]] peripheral = "{peripheral}"'
            found.append(_rate(run, fact, peripheral, (stated.at_most, stated.window_us), at))
        if peripheral not in loads and bool((at >= run.since).any()):
            first = int(at[at >= run.since][0])
            excess = f"declared 0, seen {at.size}, the first at {first / CLOCK_HZ:.6f} s"
            fact = f'no [[transfer]] peripheral = "{peripheral}"'
            found.append(FactCount(fact, peripheral, 0, int(at.size), excess))
    return found


def _after_releases(
    run: _Run, load: InterruptLoad, fact: str, at: Cycles, recording: Recording
) -> FactCount:
    """Windows from the releases of one task on, as far as its jobs last."""
    window = MASTER_CLOCK.cycles_of_us(load.window_us)
    thread, most, excess = recording.thread_index(str(load.task)), 0, ""
    for number, job in enumerate(jobs_of(recording, thread), 1):
        if number == 1 or job.completion_cycles is None or job.release_cycles < run.since:
            continue
        end = min(job.release_cycles + window, job.completion_cycles)
        seen = int(np.searchsorted(at, end) - np.searchsorted(at, job.release_cycles))
        if seen > max(most, load.at_most):
            when = f"at {float(MASTER_CLOCK.seconds(job.release_cycles)):.6f} s"
            excess = f"declared {load.at_most}, seen {seen} {when}, job {number} of {load.task}"
        most = max(most, seen)
    name = source_name(load.source)
    return FactCount(f'{fact}, task = "{load.task}"', name, load.at_most, most, excess)


def _suspensions(run: _Run, facts: Facts, recording: Recording) -> list[FactCount]:
    """Times for which jobs wait for something else than their release.

    A recording has a job for each part between two waits. A cyclic task is released by the end of
    a delay, any other one by something else.
    """
    found = []
    states = recording.of_kind(EventKind.THREAD_STATE)
    for fact in facts.suspensions:
        thread = recording.thread_index(fact.task)
        mine = states[states["subject"] == thread]
        state = dict(zip(mine["at_cycles"].tolist(), mine["value"].tolist(), strict=True))
        waited, longest, where = 0, 0, ""
        for part, later in pairwise(jobs_of(recording, thread)):
            end = part.completion_cycles
            if end is None or end < run.since:
                continue
            if (state.get(end) == DELAYED) == run.is_cyclic(thread):
                waited = 0
                continue
            waited += later.release_cycles - end
            if waited > longest:
                longest, where = waited, run.words(thread, end)
        seen_us = round(longest * 1_000_000 / CLOCK_HZ)
        excess = ""
        if longest > MASTER_CLOCK.cycles_of_us(fact.longest_us):
            excess = f"declared {fact.longest_us} us, seen {seen_us} us {where}"
        text = f'{facts.name}: [[suspension]] task = "{fact.task}"'
        found.append(FactCount(text, fact.task, fact.longest_us, seen_us, excess))
    return found


def fact_counts(
    robot: Robot,
    facts: Facts,
    image: ElfImage,
    counted: Sequence[CountedFact],
    recording: Recording,
    requests: Sequence[Request] = (),
) -> list[FactCount]:
    """Each fact with what the run counted, after the start of all tasks; `requests` are those
    that the analysis uses."""
    run = _Run(robot, recording)
    flow = [
        _flow_count(run, image, fact, count)
        if fact.turn is None
        else _turn_count(run, robot, facts, fact, count)
        for fact, count in zip(counted, recording.flow_counts, strict=True)
    ]
    return [
        *flow,
        *_rates(run, facts, image, recording),
        *together_counts(robot, facts, recording),
        *request_counts(requests, facts, recording, run.since),
        *rest_counts(requests, facts, recording, run.since),
        *_suspensions(run, facts, recording),
    ]


def left_modes(counts: Sequence[FactCount], what: str) -> dict[str, str]:
    """Modes that a run, `what` in words, leaves, and by which fact."""
    wrong = [count for count in counts if count.mode and count.excess]
    return {
        count.mode: f"{what} is not in it: {count.fact}: {count.excess}"
        for count in reversed(wrong)
    }


def check_facts_of_run(counts: Sequence[FactCount], what: str) -> None:
    """Raise `ExecutionTimeError` for facts that a run, `what` in words, contradicts. One that holds
    in a mode tells that the run leaves it (`left_modes`)."""
    always = [count for count in counts if not count.mode]
    wrong = [f"{count.fact}: {count.excess}" for count in always if count.excess]
    if wrong:
        raise ExecutionTimeError(
            f"{wrong[0]}; in {what} the program does more than this fact says: correct the fact",
            detail="\n".join(wrong),
        )
