# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What delays tasks without being one, for the response-time analysis: interrupts, timing events,
calls of the alarm, transfers of the data controller. Times are in cycles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from ravenbrick.image.elf import ElfImage
from ravenbrick.schedule.model import Task as ScheduledTask
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.facts.facts import EventLoad, Facts, InterruptLoad, TransferLoad
from ravenbrick.timing.initial_state import ALARM_SOURCE
from ravenbrick.timing.kernel import InterruptCost
from ravenbrick.timing.task_set.alarm import AlarmCosts, coarse_alarm, exact_cycles
from ravenbrick.timing.task_set.events import EventCost
from ravenbrick.timing.task_set.interrupt_blocking import InterruptBlocking
from ravenbrick.trace.interrupts import source_name

__all__ = [
    "STOLEN_CYCLES",
    "expiries",
    "interrupts_seen_by",
    "scheduled_interrupts",
    "transfer_tasks",
]

# By one transfer of the data controller, by timing profile (`pdc_steal_cycles`).
STOLEN_CYCLES = {"optimistic": 1, "nominal": 1, "pessimistic": 4}


def scheduled_interrupts(
    costs: Sequence[InterruptCost],
    facts: Facts,
    periods: Sequence[int],
    longest_blocking: Callable[[int], int],
) -> list[ScheduledTask]:
    found = []
    for cost in costs:
        source = cost.handler.source
        if source == ALARM_SOURCE:
            continue
        loads = facts.loads(source)
        if not loads:
            name = source_name(source)
            raise ExecutionTimeError(
                f"{cost.handler.symbol} handles {name}: say in {facts.name} how often it comes at "
                f'most: [[interrupt]] source = "{name}", at_most = ..., window_us = ..., '
                'reason = "..."'
            )
        found.append(_interrupt(cost, loads, longest_blocking(cost.handler.priority)))
    alarm = next(cost for cost in costs if cost.handler.source == ALARM_SOURCE)
    return [*found, *coarse_alarm(periods, alarm.cycles, alarm.handler.priority)]


def _interrupt(cost: InterruptCost, loads: Sequence[InterruptLoad], blocking: int) -> ScheduledTask:
    name, level = source_name(cost.handler.source), cost.handler.priority
    return _bursts(name, cost.cycles, level, loads, blocking)


def _bursts(
    name: str,
    cycles: int,
    priority: int,
    loads: Sequence[InterruptLoad] | Sequence[EventLoad] | Sequence[TransferLoad],
    blocking: int,
    release_jitter: int = 0,
) -> ScheduledTask:
    """Calls of a handler, or transfers, the longest window first."""
    load, *shorter = loads
    limits = [
        (Fraction(s.at_most, load.at_most), exact_cycles(s.window_us), exact_cycles(_late_us(s)))
        for s in shorter
    ]
    return ScheduledTask(
        name=name,
        period=exact_cycles(load.window_us),
        limits=tuple(limits),
        wcet=load.at_most * cycles,
        priority=priority,
        release="interrupt",
        blocking=blocking,
        release_jitter=release_jitter + exact_cycles(_late_us(load)),
    )


def _late_us(load: InterruptLoad | EventLoad | TransferLoad) -> int:
    return load.late_us if isinstance(load, InterruptLoad) else 0


def transfer_tasks(
    image: ElfImage, blocking: InterruptBlocking, facts: Facts
) -> list[ScheduledTask]:
    """Cycles that the data controller takes, whatever the processor executes, also while the alarm
    is late (the tasks' release jitter): data sheet 6175M, chapters PDC and memory controller."""
    first = 1 + max(cost.handler.priority for cost in blocking.handlers)
    late, cycles = blocking.kernel.release_jitter, STOLEN_CYCLES[blocking.kernel.timing]
    return [
        _bursts(f"{peripheral} transfers", cycles, first, loads, 0, late)
        for peripheral, loads in facts.transfer_loads(image).items()
    ]


def expiries(events: Sequence[EventCost], alarm: AlarmCosts, blocking: int) -> list[ScheduledTask]:
    """Timing events: each a call of the alarm, and an early one before."""
    return [
        _bursts(
            event.name,
            event.cycles + alarm.early,
            event.handler.priority,
            event.loads,
            blocking,
        )
        for event in events
    ]


def interrupts_seen_by(
    task: str,
    interrupts: Sequence[ScheduledTask],
    costs: Sequence[InterruptCost],
    facts: Facts,
) -> list[ScheduledTask] | None:
    """Interrupts as they come in windows from a task's releases on; None where nothing is said
    about these."""
    by_name = {source_name(cost.handler.source): cost for cost in costs}
    found, special = [], False
    for interrupt in interrupts:
        cost = by_name.get(interrupt.name)
        loads = () if cost is None else facts.loads(cost.handler.source, task)
        special |= bool(loads)
        found.append(_interrupt(cost, loads, 0) if cost and loads else interrupt)
    return found if special else None
