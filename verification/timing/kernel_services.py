# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of the run-time's services against the longest times that can be brought about.

`python -m verification.timing.kernel_services` writes docs/reference/kernel-services.md and prints
one JSON object. The benchmarks `worst_case_services` and `worst_case_events` run each service in
the situation in which it takes longest: other tasks ahead in every queue, a more urgent task to
switch to, and a wrap of the clock's count (every 24 minutes). Net times are taken step by step;
interrupts and other tasks are left out of them.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.timing.bounds import execution_times
from ravenbrick.timing.facts.facts import annotations_of
from ravenbrick.timing.initial_state import attached_handlers
from ravenbrick.timing.kernel import (
    DELAY_UNTIL,
    EVENT_RING,
    EXPIRE,
    RESUME,
    RINGS,
    SUSPEND,
    handler_facts,
    interrupt_costs,
    run_time_facts,
)

from verification.benchmarks.runtime.calls import CallTimes
from verification.benchmarks.runtime.measure import image_of
from verification.benchmarks.runtime.steps import steps_in
from verification.support.paths import ROOT

__all__ = ["service_times"]

TABLE = ROOT / "docs" / "reference" / "kernel-services.md"
LARGEST_RATIO = 1.10

# The clock counts ticks of 16 cycles in 32 bits; the scenes lie around each new beginning.
COUNT_CYCLES = 16 * 2**32
BEFORE_CYCLES = 3_000_000
AFTER_CYCLES = 250_000
ELABORATED_CYCLES = 3_000_000

SYNCHRONOUS = "ada__synchronous_task_control"


@dataclass(frozen=True)
class Scene:
    """A program that brings services into their worst situation, and facts about it."""

    program: str
    services: tuple[tuple[str, str], ...]
    facts: str
    wraps: int
    interrupts: tuple[tuple[str, str], ...] = ()
    expiring: tuple[str, ...] = ()


SERVICES = Scene(
    "worst_case_services",
    (
        ("protected procedure, then more urgent tasks go on", "worst_cases__touch_object"),
        ("the same with an interrupt's ceiling", "worst_cases__touch_masking"),
        ("switch at the end of a protected action", "system__tasking__protected_objects__dispatch"),
        ("entry call, barrier open, then more urgent tasks go on", "worst_cases__pass_always"),
        ("protected procedure that opens an entry and serves it", "worst_cases__open_gate"),
        ("Suspend_Until_True, own part", SUSPEND),
        ("Set_True", f"{SYNCHRONOUS}__set_true"),
        ("Set_False", f"{SYNCHRONOUS}__set_false"),
        ("delay until, own part", DELAY_UNTIL),
        ("Clock", "worst_cases__read_clock"),
        ("alarm's handler, one release", "ravenbrick__delays__ring"),
        ("return of a task that was preempted", RESUME),
    ),
    annotations_of(
        {"loop": [{"symbol": "worst_cases__source__cue_actorsP", "index": 0, "iterations": 4}]}
    ),
    wraps=4,
    interrupts=(
        (
            "interrupt that releases a task, until a more urgent one goes on",
            "worst_cases__late_source__cue_lastP",
        ),
        ("alarm's interrupt, one release, until a thread goes on", RINGS[0]),
    ),
)
EVENTS = Scene(
    "worst_case_events",
    (
        ("timing event: Set_Handler of one that is set", "event_worst_cases__move_last"),
        ("timing event: Cancel_Handler", "event_worst_cases__cancel_last"),
        ("timing event: expiry, its handler included", EXPIRE),
    ),
    "",
    wraps=2,
    interrupts=(("alarm's interrupt, expiry of one event, until a thread goes on", EVENT_RING),),
    expiring=("event_worst_cases__bell__ringP",),
)
AHEAD = 3

# Executed by handlers only.
IN_HANDLERS = (EXPIRE,)


@dataclass(frozen=True)
class ServiceTime:
    """One service: bound and longest observed time in cycles, and how often it was seen."""

    service: str
    symbol: str
    bound: int
    observed: int
    count: int

    @property
    def ratio(self) -> float:
        """Bound over observed."""
        return self.bound / self.observed if self.observed else 0.0

    @property
    def is_close(self) -> bool:
        """Is the bound not exceeded and at most a tenth above?"""
        return self.observed <= self.bound <= LARGEST_RATIO * self.observed


def _recorded(elf: Path, wraps: int) -> list[CallTimes]:
    windows = [
        (wrap * COUNT_CYCLES - BEFORE_CYCLES, wrap * COUNT_CYCLES + AFTER_CYCLES)
        for wrap in range(1, wraps + 1)
    ]
    recorded = steps_in(elf, windows)
    recorded[0].brick.run_until(ELABORATED_CYCLES)
    return [CallTimes(steps) for steps in recorded]


def _annotations(image: ElfImage, scene: Scene) -> list[tuple[str, str]]:
    _, known = run_time_facts(image, AHEAD, scene.expiring)
    return [(scene.program, scene.facts), *known]


def _services(
    image: ElfImage,
    scene: Scene,
    annotations: Sequence[tuple[str, str]],
    times: Sequence[CallTimes],
) -> list[ServiceTime]:
    rows = []
    for service, symbol in scene.services:
        known = [handler_facts(), *annotations] if symbol in IN_HANDLERS else annotations
        found = execution_times(image.content, functions=[symbol], annotations=known)
        seen = [
            cycles
            for each in times
            for cycles in (each.of_resumptions() if symbol == RESUME else each.of_calls(symbol))
        ]
        cycles = found.functions[0].cycles + found.return_cycles
        rows.append(ServiceTime(service, symbol, cycles, max(seen, default=0), len(seen)))
    return rows


def _interrupts(
    image: ElfImage,
    scene: Scene,
    annotations: Sequence[tuple[str, str]],
    times: Sequence[CallTimes],
) -> list[ServiceTime]:
    attached = attached_handlers(times[0].steps.brick, image)
    titles = {symbol: title for title, symbol in scene.interrupts}
    handlers = [handler for handler in attached if handler.symbol in titles]
    rows = []
    for cost in interrupt_costs(image, handlers, annotations):
        symbol = cost.handler.symbol
        seen = [c for each in times for c in each.of_interrupts([symbol])[symbol]]
        rows.append(
            ServiceTime(titles[symbol], symbol, cost.cycles, max(seen, default=0), len(seen))
        )
    return rows


def service_times(code: str = "arm") -> list[ServiceTime]:
    """All services, programs and run-time in `code` ("arm" or "thumb").

    Raises:
        ExecutionTimeError: A service has no bound.
        subprocess.CalledProcessError: A program could not be built or recorded.
    """
    rows = []
    for scene in (SERVICES, EVENTS):
        elf = image_of(scene.program, "ram", code)
        image = read_image(elf)
        times = _recorded(elf, scene.wraps)
        annotations = _annotations(image, scene)
        rows += _services(image, scene, annotations, times)
        rows += _interrupts(image, scene, annotations, times)
    return rows


def _table(codes: dict[str, list[ServiceTime]]) -> str:
    ratios = [row.ratio for rows in codes.values() for row in rows]
    lines = [
        "<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->",
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        "# Run-time services: bounds and longest observed times",
        "",
        "Generated by `python -m verification.timing.kernel_services`. The figures are cycles,",
        f"for code in RAM and at most {AHEAD} other tasks ahead in a queue. The programs",
        "`worst_case_services` and `worst_case_events` (verification/benchmarks/runtime) execute",
        "each service in its worst",
        "situation. The times exclude interrupts and other tasks and include the application's",
        f"part. The ratio of bound to longest time is {min(ratios):.3f} to {max(ratios):.3f}.",
    ]
    for code, rows in codes.items():
        lines += ["", f"## {code} code", ""]
        lines += [
            "| service | function | bound | longest observed | ratio | count |",
            "| --- | --- | ---: | ---: | ---: | ---: |",
        ]
        lines += [
            f"| {r.service} | `{r.symbol}` | {r.bound} | {r.observed} | {r.ratio:.3f} | {r.count} |"
            for r in rows
        ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write and print; 1 when a time lies above its bound or too far below."""
    codes = {"ARM": service_times("arm"), "Thumb": service_times("thumb")}
    TABLE.write_text(_table(codes))
    answer = [
        {"code": code, **asdict(row), "ratio": row.ratio, "close": row.is_close}
        for code, rows in codes.items()
        for row in rows
    ]
    print(json.dumps(answer, indent=1))
    return int(not all(row["close"] for row in answer))


if __name__ == "__main__":
    sys.exit(main())
