# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The longest response times, hunted: the inputs of a scenario are moved in time, added and
changed, at random and from the best variant found so far."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.elf_image import ElfImage
from ravenbrick.target.protocol import Progress, no_progress
from ravenbrick.target.robot import Robot
from ravenbrick.target.scenario import Scenario
from ravenbrick.target.stimulus import TimedInput
from ravenbrick.target.virtual import VirtualTarget
from ravenbrick.timing.observed import Observed, observe
from ravenbrick.trace.recording import EventKind, decode_events

__all__ = ["Catch", "Hunt", "hunt", "largest"]

SHIFT_MS = 20
FRESH = 0.3
SIGNAL_PERIOD_US = 100_000


@dataclass(frozen=True)
class Catch:
    """The longest response of one task, and the inputs that led to it."""

    task: str
    response_cycles: int
    attempt: int
    inputs: tuple[TimedInput, ...]
    observed: Observed | None = None


@dataclass(frozen=True)
class Hunt:
    """All catches, and the longest responses of the scenario as it is, by the task's name."""

    attempts: int
    catches: Mapping[str, Catch]
    unvaried: Mapping[str, int]

    def plain(self) -> dict[str, Any]:
        """For JSON; cycles."""
        return {
            "attempts": self.attempts,
            "tasks": {
                name: {
                    "response_cycles": found.response_cycles,
                    "unvaried_cycles": self.unvaried.get(name),
                    "attempt": found.attempt,
                    "inputs": [[i.at_cycles, i.name, i.value] for i in found.inputs],
                }
                for name, found in self.catches.items()
            },
        }


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
        scaled = alone.value if alone.value in (0.0, 1.0) else alone.value * rng.uniform(-1.5, 1.5)
        moved = alone.at_cycles + rng.randrange(-10 * span, 10 * span)
        found[place] = replace(alone, at_cycles=moved, value=scaled)
    if names and rng.random() < 0.5:
        name = rng.choice(names)
        begin = rng.randrange(end)
        found.append(TimedInput(begin, name, 1.0))
        found.append(TimedInput(begin + rng.randrange(1, 5 * span), name, 0.0))
    kept = [replace(i, at_cycles=min(max(i.at_cycles, 1), end - 1)) for i in found]
    return tuple(sorted(kept, key=lambda timed: timed.at_cycles))


def _responses(robot: Robot, brick: Any) -> dict[str, int]:
    """Longest response of each task after its second release."""
    events = decode_events(brick.events())
    done = events[events["kind"] == int(EventKind.COMPLETION)]
    found = {}
    for index, thread in enumerate(brick.threads()):
        task = robot.task(thread.name)
        mine = done[done["subject"] == index]
        if task is None or mine.size < 3:
            continue
        spans = mine["at_cycles"].astype(np.int64) - mine["value"]
        found[task.name] = int(spans[2:].max())
    return found


def hunt(
    robot: Robot,
    scenario: Scenario,
    image: ElfImage,
    attempts: int,
    progress: Progress = no_progress,
    seed: int = 1,
) -> Hunt:
    """Play variants of a scenario and keep, for each task, the one with its longest response."""
    rng, target = random.Random(seed), VirtualTarget()
    end = MASTER_CLOCK.cycles_of_ms(scenario.duration_ms)
    original = scenario.timed_inputs()
    switches = sorted({i.name for i in original if i.value in (0.0, 1.0)})
    quiet = replace(scenario, inputs=(), signal_period_us=SIGNAL_PERIOD_US, pictures_ms=())
    catches: dict[str, Catch] = {}
    unvaried: dict[str, int] = {}
    for attempt in range(attempts):
        best = [catch.inputs for catch in catches.values()]
        base = original if not best or rng.random() < FRESH else rng.choice(best)
        inputs = original if attempt == 0 else _varied(base, end, switches, rng)
        brick = target.prepare(robot, replace(quiet, stimuli=inputs), image)
        brick.run_until(end)
        responses = _responses(robot, brick)
        unvaried = unvaried or responses
        for name, response in responses.items():
            known = catches.get(name)
            if known is None or known.response_cycles < response:
                catches[name] = Catch(name, response, attempt, inputs)
        progress((attempt + 1) / (attempts + len(robot.tasks)))
    for count, (name, catch) in enumerate(sorted(catches.items())):
        recording = target.run(robot, replace(quiet, stimuli=catch.inputs), image)
        catches[name] = replace(catch, observed=observe(robot, recording).get(name))
        progress((attempts + count + 1) / (attempts + len(robot.tasks)))
    return Hunt(attempts, catches, unvaried)


def largest(seen: Mapping[str, Observed], found: Hunt) -> dict[str, Observed]:
    """The larger of both, value by value; numbers of jobs and misses are added."""
    result = dict(seen)
    for name, catch in found.catches.items():
        more, known = catch.observed, seen.get(name)
        if more is None or known is None:
            continue
        both = {key: max(value, getattr(more, key)) for key, value in vars(known).items()}
        added = ("jobs", "deadline_misses")
        both |= {key: getattr(known, key) + getattr(more, key) for key in added}
        result[name] = Observed(**both)
    return result
