# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The longest response times, searched: the inputs of a scenario are moved in time, added and
changed, at random and from the best variant found so far. In every other variant the link to the
co-processor is disturbed too, so that jobs set it up again, often just when the longest undisturbed
job of a task is released. A monitor says more than it has to, as fast as the program takes it."""

from __future__ import annotations

import math
import random
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.brick.protocol import Progress, no_progress
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import MonitorWindow, Scenario
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.telemetry.frames import CHECK_BYTES, FRAME_END, LONGEST_CONTENT, frame, stuff
from ravenbrick.telemetry.messages import Ask, KeepAlive, SetParameter, encode
from ravenbrick.timing.observation.job_facts import have_deadline
from ravenbrick.timing.observation.long_run import cyclic_begin
from ravenbrick.timing.observation.observed import Observed, observe
from ravenbrick.trace.flow_counts import FlowCount, flow_counts
from ravenbrick.trace.recording import EventKind, Recording, decode_events

__all__ = ["WorstSample", "largest", "search_worst_case"]

# Longest response and release of that job, by the task's name.
Longest = Mapping[str, tuple[int, int]]

SHIFT_MS = 20
FRESH = 0.3
EXCEEDED = " exceeded"
SIGNAL_PERIOD_US = 100_000
SWITCHES = (
    *(f"button.{name}" for name in ("left", "right", "orange", "grey")),
    *(f"touch.{port}" for port in range(1, 5)),
)
# A battery that is nearly empty, which the link's task watches.
SUPPLY, LOW_SUPPLY_V = "battery.voltage", (6.3, 7.2)
WRONG_SUMS, STUCK = "fault.coprocessor_checksum", "fault.twi_stuck"
# More wrong sums than the link tolerates, and longer than its quiet time.
MOST_WRONG_SUMS, STUCK_AT_MOST_MS = 20, 60
AIMED = 0.6
# What a monitor says besides, by the value of this input: the longest frame that is none, requests
# that mean nothing, changes that are refused, and the question for all descriptions. The last word
# changes parameters to the least number, with which products take longest; modes may exclude it.
CHATTER = "monitor.chatter"
CHATTER_BYTES = 256
NOT_A_NUMBER = SetParameter(0, math.nan)
LEAST_NUMBER = 2.0**-149
SUBNORMAL = b"".join(frame(encode(SetParameter(index, LEAST_NUMBER))) for index in range(4))
WORDS = (
    stuff(bytes(range(1, 1 + LONGEST_CONTENT + CHECK_BYTES))) + FRAME_END,
    *(frame(encode(message)) for message in (KeepAlive(), NOT_A_NUMBER, Ask())),
    SUBNORMAL,
)
CHATTERS = 0.7
# From the loss of the link, which ends what the bus is held in, to the greeting and to the reset.
AFTER_LOSS_US = (22_000, 0)
# A transfer of the link's task runs for some 300 us from 1.9 ms before the next one is due.
LINK_PERIOD_US = 2_000
# A picture is sent for so long after the job that shows it.
PICTURE_US = 4_000
HELD_BEFORE_US, HELD_AFTER_US = (1_600, 1_950), 200


@dataclass(frozen=True)
class WorstSample:
    """The longest response of one task, the inputs that led to it, and the run with them."""

    task: str
    response_cycles: int
    variant: int
    inputs: tuple[TimedInput, ...]
    release_cycles: int = 0
    observed: Observed | None = None
    recording: Recording | None = None


@dataclass(frozen=True)
class WorstCaseSearch:
    """The worst samples, those of variants without disturbances, and the longest responses of the
    scenario as it is, by the task's name; samples in which a fact was exceeded."""

    variants: int
    worst: Mapping[str, WorstSample]
    undisturbed: Mapping[str, WorstSample]
    unvaried: Mapping[str, int]
    exceeded: Mapping[str, WorstSample]

    def plain(self) -> dict[str, Any]:
        """For JSON; cycles."""
        return {
            "variants": self.variants,
            "tasks": {
                name: {
                    "response_cycles": found.response_cycles,
                    "unvaried_cycles": self.unvaried.get(name),
                    "undisturbed_cycles": self._undisturbed(name),
                    "variant": found.variant,
                    "inputs": [[i.at_cycles, i.name, i.value] for i in found.inputs],
                }
                for name, found in self.worst.items()
            },
        }

    def _undisturbed(self, name: str) -> int | None:
        return self.undisturbed[name].response_cycles if name in self.undisturbed else None


def _varied(
    inputs: Sequence[TimedInput], end: int, names: Sequence[str], rng: random.Random
) -> tuple[TimedInput, ...]:
    """All moved together, one moved alone, one value changed, or a press more."""
    span = MASTER_CLOCK.cycles_of_ms(SHIFT_MS)
    together = rng.randrange(-span, span)
    found = [replace(i, at_cycles=i.at_cycles + together) for i in inputs]
    if found:
        place = rng.randrange(len(found))
        alone = found[place]
        fixed = alone.value in (0.0, 1.0) or alone.name in (WRONG_SUMS, CHATTER)
        scaled = alone.value if fixed else alone.value * rng.uniform(-1.5, 1.5)
        moved = alone.at_cycles + rng.randrange(-10 * span, 10 * span)
        found[place] = replace(alone, at_cycles=moved, value=scaled)
    if names and rng.random() < 0.5:
        name = rng.choice(names)
        begin = rng.randrange(end)
        found.append(TimedInput(begin, name, 1.0))
        found.append(TimedInput(begin + rng.randrange(1, 5 * span), name, 0.0))
    kept = [replace(i, at_cycles=min(max(i.at_cycles, 1), end - 1)) for i in found]
    return tuple(sorted(kept, key=lambda timed: timed.at_cycles))


def _disturbed(
    inputs: Sequence[TimedInput], end: int, rng: random.Random
) -> tuple[TimedInput, ...]:
    """Some wrong checksums, or a bus that is held for a while; perhaps a battery nearly empty, with
    which the link may be lost too."""
    begin = rng.randrange(1, end)
    if rng.random() < 0.5:
        wrong = float(rng.randrange(1, MOST_WRONG_SUMS))
        found = [*inputs, TimedInput(begin, WRONG_SUMS, wrong)]
    else:
        length = rng.randrange(1, MASTER_CLOCK.cycles_of_ms(STUCK_AT_MOST_MS))
        back = min(begin + length, end)
        found = [*inputs, TimedInput(begin, STUCK, 1.0), TimedInput(back, STUCK, 0.0)]
    if rng.random() < 0.5:
        found.append(TimedInput(rng.randrange(1, end), SUPPLY, rng.uniform(*LOW_SUPPLY_V)))
    return tuple(sorted(found, key=lambda timed: timed.at_cycles))


def _aimed(
    sample: WorstSample, after_us: int, end: int, rng: random.Random
) -> tuple[TimedInput, ...]:
    """The inputs of a sample, and the bus held so that the link is lost this long before its
    longest job, or before a later release of the link's task in it or while a picture is sent."""
    period = MASTER_CLOCK.cycles_of_us(LINK_PERIOD_US)
    busy = sample.response_cycles + MASTER_CLOCK.cycles_of_us(PICTURE_US)
    met = sample.release_cycles + period * rng.randrange(1 + busy // period)
    lost = met - MASTER_CLOCK.cycles_of_us(after_us)
    begin = lost - MASTER_CLOCK.cycles_of_us(rng.randrange(*HELD_BEFORE_US))
    back = lost + MASTER_CLOCK.cycles_of_us(rng.randrange(1, HELD_AFTER_US))
    held = (TimedInput(begin, STUCK, 1.0), TimedInput(back, STUCK, 0.0))
    kept = [replace(i, at_cycles=min(max(i.at_cycles, 1), end - 1)) for i in held]
    return tuple(sorted((*sample.inputs, *kept), key=lambda timed: timed.at_cycles))


def _saying(inputs: Sequence[TimedInput], word: int, at_cycles: int) -> tuple[TimedInput, ...]:
    """A monitor that also says this word."""
    more = TimedInput(at_cycles, CHATTER, float(word))
    return tuple(sorted((*inputs, more), key=lambda timed: timed.at_cycles))


def _talking(inputs: Sequence[TimedInput], window: MonitorWindow) -> MonitorWindow:
    """A monitor that says what the inputs tell, again and again for a while."""
    chatter = []
    for timed in inputs:
        if timed.name == CHATTER:
            word = WORDS[int(timed.value) % len(WORDS)]
            at_ms = int(1000 * MASTER_CLOCK.seconds(timed.at_cycles))
            chatter.append((at_ms, word * (1 + CHATTER_BYTES // len(word))))
    return replace(window, chatter=tuple(chatter))


def _taken(brick: Any, inputs: Sequence[TimedInput]) -> tuple[TimedInput, ...]:
    """Inputs that the brick has and whose values it can take."""
    found = []
    for timed in inputs:
        if timed.name == CHATTER:
            found.append(timed)
            continue
        try:
            brick.schedule_input(timed.at_cycles, timed.name, timed.value)
        except ValueError:
            continue
        found.append(timed)
    return tuple(found)


class _VariantRunner:
    """Plays variants of one scenario."""

    def __init__(
        self,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        target: VirtualTarget,
        outside: Collection[str],
    ) -> None:
        self._robot, self._image, self._target = robot, image, target
        self._outside = outside
        period_us = SIGNAL_PERIOD_US
        self._quiet = replace(scenario, inputs=(), signal_period_us=period_us, pictures_ms=())
        self.end = MASTER_CLOCK.cycles_of_ms(scenario.duration_ms)
        self._probe = self._target.prepare(robot, replace(self._quiet, stimuli=()), image)
        presses = _taken(self._probe, [TimedInput(1, name, 1.0) for name in SWITCHES])
        self.switches = [timed.name for timed in presses]

    def vary(
        self, base: Sequence[TimedInput], disturbed: bool, rng: random.Random
    ) -> tuple[TimedInput, ...]:
        """Inputs that differ a little from others."""
        inputs = _varied(base, self.end, self.switches, rng)
        if self._quiet.monitor is not None and rng.random() < CHATTERS:
            word = rng.randrange(len(WORDS) if disturbed else WORDS.index(SUBNORMAL))
            inputs = _saying(inputs, word, rng.randrange(self.end))
        return _taken(self._probe, _disturbed(inputs, self.end, rng) if disturbed else inputs)

    def disturb(
        self, sample: WorstSample, after_us: int, rng: random.Random
    ) -> tuple[TimedInput, ...]:
        """Inputs of a sample with the link lost so long before its longest job, which a monitor has
        perhaps made longer."""
        inputs = _aimed(sample, after_us, self.end, rng)
        if self._quiet.monitor is not None and rng.random() < CHATTERS:
            at_cycles = rng.randrange(max(1, sample.release_cycles))
            inputs = _saying(inputs, WORDS.index(SUBNORMAL), at_cycles)
        return _taken(self._probe, inputs)

    def recording(self, inputs: Sequence[TimedInput]) -> Recording:
        """The whole run; the scenario's peer or monitor, if any, runs beside."""
        plain = tuple(timed for timed in inputs if timed.name != CHATTER)
        scenario = replace(self._quiet, stimuli=plain)
        if scenario.monitor is not None:
            scenario = replace(scenario, monitor=_talking(inputs, scenario.monitor))
        return self._target.run(self._robot, scenario, self._image)

    def play(self, inputs: Sequence[TimedInput]) -> tuple[Longest, Sequence[FlowCount]]:
        """Longest response of each task after the start of all of them with the release of that
        job, and what was counted about facts."""
        if self._quiet.peer is not None or self._quiet.monitor is not None:
            found = self.recording(inputs)
            names = [thread.name for thread in found.threads]
            return self._longest(found.events, names), found.flow_counts
        scenario = replace(self._quiet, stimuli=tuple(inputs))
        brick = self._target.prepare(self._robot, scenario, self._image)
        brick.run_until(self.end)
        names = [thread.name for thread in brick.threads()]
        return self._longest(decode_events(brick.events()), names), flow_counts(brick)

    def _longest(self, events: NDArray[np.void], names: list[str]) -> Longest:
        since = cyclic_begin(events, names, self._robot)
        done = events[events["kind"] == int(EventKind.COMPLETION)]
        done = done[done["value"] >= since]
        found = {}
        for index, name in enumerate(names):
            task, mine = self._robot.task(name), done[done["subject"] == index]
            mine = mine[have_deadline(task, mine["value"].astype(np.int64), self._outside)]
            if task is not None and mine.size:
                spans = mine["at_cycles"].astype(np.int64) - mine["value"]
                place = int(spans.argmax())
                found[task.name] = int(spans[place]), int(mine["value"][place])
        return found


def _keep(worst: dict[str, WorstSample], found: Longest, variant: int, inputs: Any) -> None:
    for name, (response, release) in found.items():
        known = worst.get(name)
        if known is None or known.response_cycles < response:
            worst[name] = WorstSample(name, response, variant, inputs, release)


def _nearly_wrong(counts: Mapping[int, FlowCount]) -> Longest:
    """What a search for wrong facts raises: most executions, and then how often they are too
    many; by the number of the fact."""
    most = {f"fact {number}": (count.most, 0) for number, count in counts.items()}
    wrong = {
        f"fact {number}{EXCEEDED}": (count.arrivals.size, 0)
        for number, count in counts.items()
        if count.arrivals.size
    }
    return most | wrong


def search_worst_case(
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    variants: int,
    progress: Progress = no_progress,
    seed: int = 1,
    target: VirtualTarget | None = None,
    transfer_cycles: int = 1,
    outside: Collection[str] = (),
    facts_counted: Collection[int] | None = None,
) -> WorstCaseSearch:
    """Play variants of a scenario and keep, for each task, those with its longest responses, and
    for each fact that the target counts the one with the most. Tasks in `outside` have jobs
    without a deadline, which are left out; of what is counted only the facts with the numbers
    `facts_counted` hold in every variant (default: all)."""
    rng = random.Random(seed)
    runner = _VariantRunner(robot, scenario, image, target or VirtualTarget(), outside)
    original = scenario.timed_inputs()
    worst: dict[str, WorstSample] = {}
    undisturbed: dict[str, WorstSample] = {}
    facts: dict[str, WorstSample] = {}
    unvaried: dict[str, int] = {}
    rounds = variants + 2 * len(robot.tasks)
    targets = cycle(
        (task.name, after_us)
        for task in sorted(robot.tasks, key=lambda task: task.priority)
        for after_us in AFTER_LOSS_US
    )
    for variant in range(variants):
        disturbed = variant % 2 == 1
        best = [sample.inputs for sample in (worst if disturbed else undisturbed).values()]
        best += [one.inputs for one in facts.values() if disturbed or one.variant % 2 == 0]
        base = original if not best or rng.random() < FRESH else rng.choice(best)
        if disturbed and undisturbed and rng.random() < AIMED:
            # Each task in turn, the least urgent first, meets a greeting and a reset.
            name, after_us = next(one for one in targets if one[0] in undisturbed)
            inputs = runner.disturb(undisturbed[name], after_us, rng)
        else:
            inputs = runner.vary(base, disturbed, rng) if variant else original
        responses, counts = runner.play(inputs)
        unvaried = unvaried or {name: longest for name, (longest, _) in responses.items()}
        _keep(worst, responses, variant, inputs)
        held = {n: c for n, c in enumerate(counts) if facts_counted is None or n in facts_counted}
        _keep(facts, _nearly_wrong(held), variant, inputs)
        if not disturbed:
            _keep(undisturbed, responses, variant, inputs)
        progress((variant + 1) / rounds)
    seen: dict[int, tuple[Mapping[str, Observed], Recording]] = {}
    exceeded = {name: sample for name, sample in facts.items() if name.endswith(EXCEEDED)}
    samples = [(k, n) for k in (worst, undisturbed, exceeded) for n in sorted(k)]
    for count, (kept, name) in enumerate(samples):
        sample = kept[name]
        if sample.variant not in seen:
            recording = runner.recording(sample.inputs)
            seen[sample.variant] = observe(robot, recording, transfer_cycles, outside), recording
        values, recording = seen[sample.variant]
        kept[name] = replace(sample, observed=values.get(name), recording=recording)
        progress(min(1.0, (variants + count + 1) / rounds))
    return WorstCaseSearch(variants, worst, undisturbed, unvaried, exceeded)


def largest(seen: Mapping[str, Observed], worst: Mapping[str, WorstSample]) -> dict[str, Observed]:
    """The larger of both, value by value; numbers of jobs and misses are added."""
    result = dict(seen)
    for name, sample in worst.items():
        more, known = sample.observed, seen.get(name)
        if more is None or known is None:
            continue
        both = {key: max(value, getattr(more, key)) for key, value in vars(known).items()}
        both["without_transfers"] = known.without_transfers and more.without_transfers
        added = ("jobs", "deadline_misses")
        both |= {key: getattr(known, key) + getattr(more, key) for key in added}
        result[name] = Observed(**both)
    return result
