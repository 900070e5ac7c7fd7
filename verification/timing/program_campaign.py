# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Generated Ada programs on the virtual brick: no response time above its bound.

`python -m verification.timing.program_campaign [--programs 1000] [--seed 1]` prints one JSON
object. The programs share their code (`campaign/`); each has its own number of tasks, periods and
loads, which are written into the tables of the image. All tasks are released together once.
"""

from __future__ import annotations

import argparse
import io
import json
import random
import struct
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import virtual_brick
from elftools.elf.elffile import ELFFile
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.schedule.model import Overheads, TaskSet
from ravenbrick.schedule.model import Task as ScheduledTask
from ravenbrick.schedule.offsets import synchronous_bound
from ravenbrick.schedule.quantity import exact
from ravenbrick.schedule.response_time import response_time_bound
from ravenbrick.timing.bounds import Bound, execution_times
from ravenbrick.timing.facts.facts import annotations_of
from ravenbrick.timing.initial_state import Handler
from ravenbrick.timing.kernel import (
    ALARM_LATENESS_CYCLES,
    DELAY_UNTIL,
    DISPATCH,
    Services,
    interrupt_costs,
    run_time_facts,
    services,
)
from ravenbrick.timing.task_set.alarm import AlarmCosts, alarm_costs
from ravenbrick.trace.recording import EventKind, decode_events

from verification.support.timing import programs
from verification.timing.unreached_bounds import CLOSE, Outcome, explain

SLOTS = 8
FIRST_PRIORITY = 11
BODY = "workers__workerTB"
COMPUTE = "workers__compute"
RING = Handler(12, 31, "ravenbrick__delays__ring")
PERIODS_US = tuple(1000 * ms for ms in (10, 12, 15, 16, 20, 25, 30, 40, 50, 60, 80, 100))
RUN_MS = 140
EPOCH_MS = 20
CONFIGURATION = json.dumps(
    {
        "seed": 1,
        "battery": {"kind": "li_ion", "voltage": 8.0, "internal_resistance": 0.0},
        "body": {"kind": "bench"},
    }
)


@dataclass(frozen=True)
class Load:
    """A task: its slot (0 is the least urgent), period and rounds of its two loops."""

    slot: int
    period_us: int
    rounds: int
    locked_rounds: int
    phase_us: int = 0

    @property
    def name(self) -> str:
        """As the schedule calls it."""
        return f"slot {self.slot}"


@dataclass(frozen=True)
class Costs:
    """Bounds for one number of tasks; the job and its protected action grow with the rounds."""

    kernel: Services
    alarm: AlarmCosts
    job: tuple[int, int, int]
    dispatch: int
    section: tuple[int, int]

    def job_cycles(self, load: Load) -> int:
        """Of one job."""
        fixed, each, locked = self.job
        return fixed + each * load.rounds + locked * load.locked_rounds

    def overheads_together(self) -> Overheads:
        """Of releases at the same instants, after all tasks have waited for long.

        A job that ends its protected action lets others in, and a preempted one goes on, only after
        a call of the alarm, once for each.
        """
        each = self.alarm.first + self.kernel.resume + self.dispatch
        costs = self.alarm.overheads(self.kernel)
        late = ALARM_LATENESS_CYCLES["nominal"]
        return replace(costs, switch_in=0, alarm=each, clock_resolution=late)

    def section_cycles(self, load: Load) -> int:
        """Of its protected action."""
        return self.section[0] + self.section[1] * load.locked_rounds


@cache
def built() -> ElfImage:
    """The image that all programs share."""
    return programs.built("periodic", "periodic_load")


def _job(image: ElfImage, known: Sequence[tuple[str, str]], rounds: int, locked: int) -> Bound:
    loops = [
        {"symbol": COMPUTE, "index": 0, "header_executions": rounds},
        {"symbol": BODY, "index": 1, "header_executions": locked},
    ]
    annotations = [("rounds", annotations_of({"loop": loops})), *known]
    found = execution_times(
        image.content, jobs=[(BODY, (DELAY_UNTIL,), ())], annotations=annotations
    )
    return found.jobs[0]


@cache
def costs(task_count: int) -> Costs:
    """Bounds in programs of this many tasks."""
    image = built()
    _, known = run_time_facts(image, task_count + 1)
    kernel = services(image, known)
    alarm = alarm_costs(image, interrupt_costs(image, [RING], known)[0], known, PERIODS_US)
    one, more, locked = (_job(image, known, *counts) for counts in ((1, 1), (2, 1), (1, 2)))
    each, each_locked = more.cycles - one.cycles, locked.cycles - one.cycles
    section = one.longest_critical_section(2 * FIRST_PRIORITY)
    section_each = locked.longest_critical_section(2 * FIRST_PRIORITY) - section
    alone = ("nobody waits", annotations_of({"never": [{"symbol": DISPATCH}]}))
    return Costs(
        kernel,
        alarm,
        (one.cycles - each - each_locked, each, each_locked),
        one.cycles - _job(image, [alone, *known], 1, 1).cycles,
        (section - section_each, section_each),
    )


def random_loads(dice: random.Random) -> list[Load]:
    """Two to eight tasks, rate monotonic, with a utilisation of 0.3 to 0.85."""
    count = dice.randint(2, SLOTS)
    periods = sorted((dice.choice(PERIODS_US) for _ in range(count)), reverse=True)
    shares = [dice.expovariate(1) for _ in range(count)]
    total = dice.uniform(0.3, 0.85)
    price = costs(count)
    loads = []
    for slot, (period, share) in enumerate(zip(periods, shares, strict=True)):
        cycles = total * share / sum(shares) * float(period * MASTER_CLOCK.hertz / 1_000_000)
        rounds = max(1, int((cycles - price.job[0]) / price.job[1]))
        locked = dice.randint(1, max(1, min(rounds // 20, 200)))
        loads.append(Load(slot, period, max(1, rounds - locked), locked))
    return loads


def task_set(loads: list[Load]) -> TaskSet:
    """The program as the schedule sees it; cycles."""
    price = costs(len(loads))
    tasks = []
    for load in loads:
        lower = [price.section_cycles(other) for other in loads if other.slot < load.slot]
        masked = price.kernel.longest_masked([DELAY_UNTIL])[0] if lower else 0
        period = exact(Fraction(load.period_us) * MASTER_CLOCK.hertz / 1_000_000)
        tasks.append(
            ScheduledTask(
                load.name,
                period,
                price.job_cycles(load),
                FIRST_PRIORITY + load.slot,
                blocking=max([masked, *lower]),
            )
        )
    return TaskSet(tuple(tasks))


def response_bounds(loads: list[Load]) -> dict[int, int | None]:
    """Bound of each slot in cycles for any phases; None when there is none.

    The end of a protected action at which the processor is given away is charged to each job or to
    each release of a more urgent one, whichever is less.
    """
    price = costs(len(loads))
    overheads = price.alarm.overheads(price.kernel)
    whole, bounds = task_set(loads), dict[int, int | None]()
    for load in loads:
        paying = TaskSet(
            tuple(
                replace(task, wcet=task.wcet - price.dispatch) if task.name == load.name else task
                for task in whole
            )
        )
        found = [
            response_time_bound(tasks, tasks.task(load.name), overheads).bound
            for tasks in (whole, paying)
        ]
        bounds[load.slot] = min((int(each) for each in found if each is not None), default=None)
    return bounds


def synchronous_bounds(loads: list[Load]) -> dict[int, int]:
    """Bound of each slot's first job in cycles, when all tasks are released together."""
    price = costs(len(loads))
    tasks = (replace(task, phase=0, wcet=task.wcet - price.dispatch) for task in task_set(loads))
    together = TaskSet(tuple(tasks))
    found = {
        load.slot: synchronous_bound(
            together, together.task(load.name), price.overheads_together()
        ).bound
        for load in loads
    }
    return {slot: int(bound or 0) for slot, bound in found.items()}


def _patched(image: ElfImage, loads: list[Load]) -> bytes:
    content = bytearray(image.content)
    sections = list(ELFFile(io.BytesIO(image.content)).iter_sections())
    rows = {load.slot: load for load in loads}
    for name, column in (
        ("campaign_period_us", "period_us"),
        ("campaign_phase_us", "phase_us"),
        ("campaign_rounds", "rounds"),
        ("campaign_locked_rounds", "locked_rounds"),
    ):
        address = image.symbols[name].address
        home = next(s for s in sections if s["sh_addr"] <= address < s["sh_addr"] + s["sh_size"])
        begin = home["sh_offset"] + address - home["sh_addr"]
        values = [getattr(rows[s], column) if s in rows else 0 for s in range(SLOTS)]
        content[begin : begin + 4 * SLOTS] = struct.pack(f"<{SLOTS}i", *values)
    return bytes(content)


class StoppedError(Exception):
    """A program stopped by itself; the text says why, and which it was."""


def observed(loads: list[Load]) -> tuple[dict[int, int], dict[int, int]]:
    """Longest response time of each slot, and that of its first job, in cycles.

    Raises `StoppedError`.
    """
    brick = virtual_brick.VirtualBrick(CONFIGURATION, _patched(built(), loads))
    stop = brick.run_until(MASTER_CLOCK.cycles_of_ms(RUN_MS))
    if stop.reason != "reached":
        raise StoppedError(f"the program stopped: {stop.message}; {loads}")
    slots = [thread.base_priority - FIRST_PRIORITY for thread in brick.threads()]
    longest: dict[int, int] = {}
    first: dict[int, int] = {}
    begin = MASTER_CLOCK.cycles_of_ms(EPOCH_MS)
    for at, kind, subject, nominal in decode_events(brick.events()).tolist():
        if kind != EventKind.COMPLETION or nominal < begin or not 0 <= slots[subject] < SLOTS:
            continue
        response = at - nominal
        longest[slots[subject]] = max(longest.get(slots[subject], 0), response)
        first.setdefault(slots[subject], response)
    return longest, first


def _judged(loads: list[Load], bounds: dict[int, int | None]) -> tuple[list[str], int, float]:
    """What lies above its bound, tasks compared, and the ratio of the least urgent one."""
    longest, first = observed(loads)
    together = synchronous_bounds(loads)
    above = [
        f"{loads[slot]}: {seen} > {bound} in {loads}"
        for found, limits in ((longest, bounds), (first, together))
        for slot, seen in found.items()
        if seen > (bound := limits[slot] or 0)
    ]
    return above, len(longest), together[0] / first[0] if 0 in first else 0.0


def _explained(loads: list[Load], bound: int) -> Outcome:
    def together(tried: list[Load]) -> tuple[int, int]:
        return synchronous_bounds(tried)[0], observed(tried)[1].get(0, 0)

    return explain(loads, bound, lambda tried: observed(tried)[0].get(0, 0), together)


def campaign(count: int, seed: int) -> dict[str, Any]:
    """Run the programs; only those whose bounds meet all deadlines are counted."""
    dice = random.Random(seed)
    above: list[str] = []
    stopped: list[str] = []
    ratios: list[float] = []
    far: list[dict[str, Any]] = []
    programs = jobs = 0
    while programs < count:
        loads = random_loads(dice)
        bounds = response_bounds(loads)
        if any(b is None or b > MASTER_CLOCK.cycles_of_us(loads[s].period_us)
               for s, b in bounds.items()):  # fmt: skip
            continue
        programs += 1
        if programs % 50 == 0:
            print(f"{programs} of {count} programs", file=sys.stderr, flush=True)
        try:
            higher, compared, ratio = _judged(loads, bounds)
        except StoppedError as error:
            stopped.append(str(error))
            continue
        above += higher
        jobs += compared
        if ratio:
            ratios.append(ratio)
        if ratio > CLOSE:
            found = _explained(loads, bounds[0] or 0)
            far.append({"program": programs, "ratio_together": ratio, **vars(found)})
    ratios.sort()
    return {
        "programs": programs,
        "tasks": jobs,
        "above_bound": above,
        "stopped": stopped,
        "lowest_task_ratio_mean": sum(ratios) / len(ratios),
        "lowest_task_ratio_max": ratios[-1],
        "lowest_task_within_5_percent": sum(ratio <= CLOSE for ratio in ratios),
        "lowest_task_compared": len(ratios),
        "lowest_task_beyond": far,
    }


def main() -> int:
    """Print the result; 1 when a response time exceeds its bound."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    result = campaign(options.programs, options.seed)
    print(json.dumps(result, indent=1))
    return 1 if result["above_bound"] or result["stopped"] else 0


if __name__ == "__main__":
    sys.exit(main())
