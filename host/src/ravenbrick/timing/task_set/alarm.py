# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Calls of the alarm: their costs, and the rate of calls that release no task.

While a wake-up time is far, the alarm counts in coarse stretches and calls once shortly before it.
Such a call is set when the alarm called last, or later, so it lies behind the release before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.schedule.model import Overheads
from ravenbrick.schedule.model import Task as ScheduledTask
from ravenbrick.schedule.quantity import exact
from ravenbrick.timing.bounds import Bound
from ravenbrick.timing.facts.facts import annotations_of
from ravenbrick.timing.kernel import INTERRUPT, InterruptCost, Services, interrupt_costs

__all__ = ["AlarmCosts", "alarm_costs", "coarse_alarm", "exact_cycles"]

# Where the exit of an interrupt goes when a more urgent thread has become ready.
PREEMPTION = "preempt"
COARSE_ALARM = "alarm, coarse stretch"
# A coarse stretch is set when at least 57 000 of the kernel's units of 1/21.024 us remain, for at
# least 125 and at most 65 000 counts of 448 units (runtime/at91sam7s/ravenbrick-alarm.adb).
COARSE_PERIOD_US = int(125 * 448 / 21.024)
LONGEST_STRETCH_US = int(65_000 * 448 / 21.024)


@dataclass(frozen=True)
class AlarmCosts:
    """Cycles of a call that releases one thread, of each further thread, and of a call that
    releases nobody."""

    first: int
    further: int
    early: int

    def overheads(self, kernel: Services) -> Overheads:
        """Overheads of releases, with the return of the task that was preempted."""
        return Overheads(
            switch_in=kernel.resume,
            alarm=self.first,
            alarm_further=self.further,
            alarm_early=self.early,
            alarm_early_period=exact_cycles(COARSE_PERIOD_US),
            clock_resolution=kernel.release_jitter,
        )


def exact_cycles(microseconds: int) -> Any:
    """Cycles of the master clock as an exact number."""
    return exact(microseconds * MASTER_CLOCK.hertz / 1_000_000)


def _without_release(image: ElfImage, body: Bound) -> str:
    """The loop of the alarm's handler releases nobody: one that first looks whether to is left at
    once, one that is entered for a release is not entered."""
    own = next(found for found in body.report["functions"] if found["symbol"] == body.symbol)
    loop = next(found for found in own["loops"] if found["index"] == 0)
    if loop["header_executions"] > 1:
        again = {"symbol": body.symbol, "index": 0, "iterations": 0}
        return annotations_of({"loop": [again]})
    offset = loop["at"]["address"] - (image.symbols[body.symbol].address & ~1)
    return annotations_of({"never": [{"symbol": body.symbol, "offset": offset}]})


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
    loop = {"symbol": symbol, "index": 0, "iterations": 2}
    twice = ("two releases", annotations_of({"loop": [loop]}))
    two = interrupt_costs(image, [alarm.handler], [twice, *annotations], alarm.timing)[0]
    if min(periods_us, default=COARSE_PERIOD_US) < COARSE_PERIOD_US:
        return AlarmCosts(alarm.cycles, two.cycles - alarm.cycles, 0)
    offset = image.symbols[PREEMPTION].address - image.symbols[INTERRUPT].address
    never = annotations_of({"never": [{"symbol": INTERRUPT, "offset": offset}]})
    none = [("nobody ready", never), ("no release", _without_release(image, alarm.body))]
    nobody = interrupt_costs(image, [alarm.handler], [*none, *annotations], alarm.timing)[0]
    return AlarmCosts(alarm.cycles, two.cycles - alarm.cycles, nobody.cycles)


def coarse_alarm(
    periods_us: Sequence[int], alarm_cycles: int, priority: int
) -> list[ScheduledTask]:
    """Calls that release nobody and come before none: where no task is released for longer than
    the longest stretch, given that tasks meet their deadlines."""
    if min(periods_us, default=LONGEST_STRETCH_US) < LONGEST_STRETCH_US:
        return []
    period = exact_cycles(COARSE_PERIOD_US)
    return [ScheduledTask(COARSE_ALARM, period, alarm_cycles, priority, release="interrupt")]
