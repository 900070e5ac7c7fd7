# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What may keep an interrupt blocking, services that mask interrupts, and windows of one task."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from ravenbrick.project.robot import Task, read_robot
from ravenbrick.timing.bounds import Bound
from ravenbrick.timing.facts.facts import SOURCE_NUMBERS, Facts, InterruptLoad
from ravenbrick.timing.initial_state import ALARM_SOURCE, Handler
from ravenbrick.timing.kernel import MASKING, InterruptCost, Services
from ravenbrick.timing.task_set.interrupt_blocking import InterruptBlocking
from ravenbrick.timing.task_set.scheduled_interrupts import (
    interrupts_seen_by,
    scheduled_interrupts,
)

ROOT = Path(__file__).resolve().parents[3]
SERVICES = Services(delay_until=0, resume=30, masking={"set_true": 100, "delay": 50})
ENTRY_EXIT = 180
LEVEL = 38

# Elsewhere than in services: before the tasks begin, behind their end, in handlers, inside of the
# services, or for fewer cycles than any wait for a release, which each task has.
NOT_SERVICES = {
    "s-memory.adb": "an addition",
    "s-tarest.adb": "activation and end of tasks",
    "ravenbrick-clock.adb": "reads the clock again",
    "ravenbrick-delays-events.adb": "the alarm's handler",
    "ravenbrick-execution_times.adb": "reads an account",
    "ravenbrick-supervision.adb": "ends the program",
    "ravenbrick-threads.adb": "end of tasks",
}
PACKAGES = {
    "a-dispat.adb": "ada__dispatching",
    "a-rttiev.adb": "ada__real_time__timing_events",
    "a-sytaco.adb": "ada__synchronous_task_control",
    "ravenbrick-delays.adb": "ada__real_time__delays",
    "s-taprob.adb": "system__tasking__protected_objects",
    "s-tposen.adb": "system__tasking__protected_objects__single_entry",
}
# Compiled into what calls them; the handler.
INSIDE = {"wait": "protected_single_entry_call", "ring": "delay_until"}


def job(*reached: str, section_cycles: int = 0) -> Bound:
    """A body of 70 cycles with a protected action of the highest ceiling."""
    sections = ((2 * LEVEL + 1, section_cycles),) if section_cycles else ()
    return Bound("job", 70, 0, sections, frozenset(reached), {})


def handler(level: int, body: Bound, source: int = 0) -> InterruptCost:
    return InterruptCost(Handler(source, level, "handle"), 500, body)


def blocking(bodies: list[Bound], *handlers: InterruptCost) -> int:
    """Of an interrupt at `LEVEL` above tasks with these jobs."""
    task: Task = read_robot(ROOT / "examples" / "vehicle").tasks[0]
    jobs = [(replace(task, name=f"t{n}"), body) for n, body in enumerate(bodies)]
    return InterruptBlocking(SERVICES, ENTRY_EXIT, handlers, ()).longest_cycles(LEVEL, jobs)


def test_masked_services_of_all_tasks_follow_a_way_out() -> None:
    """A task that masks nothing cannot go on masked."""
    jobs = [job("set_true"), job("delay"), job()]
    assert blocking(jobs) == ENTRY_EXIT + (100 + 30) + (50 + 30)


def test_a_protected_action_stands_without_the_masked_services() -> None:
    assert blocking([job("delay", section_cycles=200), job("delay")]) == ENTRY_EXIT + 2 * (50 + 30)
    assert blocking([job("delay", section_cycles=900), job("delay")]) == 900


def test_the_alarm_s_handler_masks_for_the_whole_of_a_release() -> None:
    assert blocking([job()], handler(31, job(), ALARM_SOURCE)) == ENTRY_EXIT + 70
    assert blocking([job()], handler(31, job("delay"))) == ENTRY_EXIT + 50


@pytest.mark.parametrize(("levels", "entries_exits"), [(1, 1), (4, 1), (5, 2), (7, 4)])
def test_ways_out_of_many_levels_are_counted_one_by_one(levels: int, entries_exits: int) -> None:
    below = [handler(LEVEL - 1 - level, job()) for level in range(levels)]
    assert blocking([job()], *below, handler(LEVEL, job("set_true"))) == entries_exits * ENTRY_EXIT


def test_interrupts_in_windows_of_a_task_stand_in_place_of_those_in_any_window() -> None:
    """The others stay: left out, they would make the bounds of this task too short."""
    spi, twi = SOURCE_NUMBERS["SPI"], SOURCE_NUMBERS["TWI"]
    costs = [handler(LEVEL, job(), source) for source in (ALARM_SOURCE, spi, twi)]
    any_window = (InterruptLoad(spi, 9, 1_000, ""), InterruptLoad(twi, 1, 500, ""))
    own = InterruptLoad(spi, 2, 1_000, "", task="control")
    facts = Facts(None, "", interrupts=(*any_window, own))
    found = scheduled_interrupts(costs, facts, [4_000], lambda _level: 0)
    assert [(each.name, each.wcet) for each in found] == [("SPI", 9 * 500), ("TWI", 500)]
    seen = interrupts_seen_by("Control", found, costs, facts)
    assert seen is not None and seen == [replace(found[0], wcet=2 * 500), found[1]]
    assert interrupts_seen_by("display", found, costs, facts) is None


def test_each_operation_of_the_run_time_that_masks_interrupts_is_a_known_service() -> None:
    """Read from the sources: one that is forgotten would make bounds too short."""
    found = set()
    begin = re.compile(r"^ *(?:procedure|function) (\w+)", re.MULTILINE)
    for folder in ("language", "kernel", "at91sam7s"):
        for file in sorted((ROOT / "runtime" / folder).glob("*.adb")):
            text = file.read_text()
            masks = [m.start() for m in re.finditer(r"Mask_(?:In_Thread|Interrupts)\b", text)]
            if file.name in NOT_SERVICES or not masks:
                continue
            for place in masks:
                name = begin.findall(text[:place])[-1].lower()
                found.add(f"{PACKAGES[file.name]}__{INSIDE.get(name, name)}")
    assert found == set(MASKING)
