# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Calls of the alarm: what they cost, and how often one comes that releases nobody.

While a wake-up time is far, the alarm counts in coarse stretches and calls once shortly before it.
Such a call is set when the alarm called last, or later, so it lies behind the release before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ravenbrick.schedule.model import Overheads
from ravenbrick.schedule.model import Task as ScheduledTask
from ravenbrick.schedule.quantity import exact
from ravenbrick.target.clock import MASTER_CLOCK
from ravenbrick.target.elf_image import ElfImage
from ravenbrick.timing.bounds import Bound, execution_times
from ravenbrick.timing.facts import annotations_of
from ravenbrick.timing.ipet import longest_path
from ravenbrick.timing.kernel import INTERRUPT, InterruptCost, Services, interrupt_costs

__all__ = ["COARSE_ALARM", "AlarmCosts", "alarm_costs", "coarse_alarm"]

# Where the way out of an interrupt goes when a more urgent thread has become ready.
PREEMPTION = "preempt"
COARSE_ALARM = "alarm, coarse stretch"
# A coarse stretch is set for at least 57 000 of the kernel's units of 1/21.024 us, three of its
# counts of 448 units shorter than the time that remains, and for at most 65 000 counts.
COARSE_PERIOD_US = int((57_000 - 3 * 448) / 21.024)
LONGEST_STRETCH_US = int(65_000 * 448 / 21.024)


@dataclass(frozen=True)
class AlarmCosts:
    """Cycles of a call that releases one thread, of each further thread, and of a call that
    releases nobody."""

    first: int
    further: int
    early: int

    def overheads(self, kernel: Services) -> Overheads:
        """What releases cost besides, with the return of the task that was preempted."""
        return Overheads(
            switch_in=kernel.resume,
            alarm=self.first,
            alarm_further=self.further,
            alarm_early=self.early,
            alarm_early_period=_cycles(COARSE_PERIOD_US),
            clock_resolution=kernel.release_jitter,
        )


def _cycles(microseconds: int) -> Any:
    return exact(microseconds * MASTER_CLOCK.hertz / 1_000_000)


def _without_release(body: Bound) -> int:
    """Longest way through the alarm's handler that does not enter its loop."""
    graph = body.graph or {"blocks": [], "loops": []}
    header = min((found["header"] for found in graph["loops"]), default=None)
    blocks = [
        {**block, "ways": [way for way in block["ways"] if way["to"] != header or header is None]}
        for block in graph["blocks"]
    ]
    return min(body.cycles, longest_path({**graph, "blocks": blocks}))


def alarm_costs(
    image: ElfImage,
    alarm: InterruptCost,
    annotations: Sequence[tuple[str, str]],
    periods_us: Sequence[int],
) -> AlarmCosts:
    """From a handler whose loop is annotated for one release; `periods_us` are those of the cyclic
    tasks. Where one is shorter than a coarse stretch, no call comes early, given that this task
    meets its deadline."""
    symbol = alarm.handler.symbol
    loop = {"symbol": symbol, "index": 0, "header_executions": 2}
    twice = ("two releases", annotations_of({"loop": [loop]}))
    two = interrupt_costs(image, [alarm.handler], [twice, *annotations])[0]
    body = execution_times(
        image.content, functions=[symbol], annotations=annotations, graphs=True
    ).functions[0]
    offset = image.symbols[PREEMPTION].address - image.symbols[INTERRUPT].address
    never = {"symbol": INTERRUPT, "offset": offset}
    none_ready = ("no release", annotations_of({"never": [never]}))
    back = interrupt_costs(image, [alarm.handler], [none_ready, *annotations])[0]
    early = back.cycles - body.cycles + _without_release(body)
    if min(periods_us, default=COARSE_PERIOD_US) < COARSE_PERIOD_US:
        early = 0
    return AlarmCosts(alarm.cycles, two.cycles - alarm.cycles, early)


def coarse_alarm(
    periods_us: Sequence[int], alarm_cycles: int, priority: int
) -> list[ScheduledTask]:
    """Calls that release nobody and come before none: where no task is released for longer than
    the longest stretch, given that tasks meet their deadlines."""
    if min(periods_us, default=LONGEST_STRETCH_US) < LONGEST_STRETCH_US:
        return []
    period = _cycles(COARSE_PERIOD_US)
    return [ScheduledTask(COARSE_ALARM, period, alarm_cycles, priority, release="interrupt")]
