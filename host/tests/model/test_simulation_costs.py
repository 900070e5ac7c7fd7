# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Effort of large diagrams, counted in calls of functions and not in seconds."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType

from ravenbrick.codegen import generate_c
from ravenbrick.model import (
    Block,
    CustomFunction,
    DataType,
    Diagram,
    Execution,
    Gain,
    Inport,
    Integrator,
    Outport,
    Saturation,
    Simulation,
    Sum,
    UnitDelay,
)


def chain(count: int) -> Diagram:
    """`count` loops of sum, gain, limit and delay in a row."""
    d = Diagram("large", 0.001)
    last: Block = d.add(Inport("u"))
    for number in range(count):
        total, gain = d.add(Sum(f"S{number}", signs="+-")), d.add(Gain(f"G{number}", gain=0.5))
        limit, delay = d.add(Saturation(f"L{number}", limit=9.0)), d.add(UnitDelay(f"Z{number}"))
        d.connect(last, total, 0)
        d.connect_chain(total, gain, limit, delay)
        d.connect(delay, total, 1)
        last = limit
    d.connect(last, d.add(Outport("y")))
    return d


def calls_of(work: Callable[[], object]) -> int:
    """Python functions entered meanwhile."""
    count = 0

    def note(frame: FrameType, event: str, argument: object) -> None:
        nonlocal count
        count += event == "call"

    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(None)
    return count


def test_a_step_calls_one_function_and_no_tree_is_walked() -> None:
    """75 loops, 302 blocks: the limits are calls, all else is arithmetic in one function."""
    run = Execution(chain(75))
    assert calls_of(lambda: run.step({"u": 1.0})) < 120


def test_effort_grows_with_the_number_of_blocks() -> None:
    """Lowering and generating 1,000 blocks takes at most 6 times the calls of 250."""
    small, large = chain(62), chain(250)
    for work in (lambda d: d.lower(), lambda d: generate_c(d, tolerance=None)):
        assert calls_of(lambda: work(large)) < 6 * calls_of(lambda: work(small))  # noqa: B023


def test_what_only_a_scope_shows_is_computed_where_it_is_recorded() -> None:
    """Neither for each derivative nor for the distance to the next limit."""
    times, real = [], DataType.REAL64

    def seen(value: float) -> float:
        times.append(value)
        return value

    plant = Diagram("plant", 0.001)
    total, state = plant.add(Sum("Total", real, signs="+-")), plant.add(Integrator("State"))
    limit = plant.add(Saturation("Limit", real, limit=0.5))
    shown = plant.add(CustomFunction("Seen", real, function=seen, c="return a;"))
    plant.connect_chain(plant.add(Inport("u", real)), total, limit, state)
    plant.connect(state, total, 1)
    plant.connect_chain(state, shown, plant.add(Outport("y", real)))
    found = Simulation(None, plant).run(4.0, {"u": 1.0})
    assert len(found.events) == 1
    assert len(times) <= len(found["plant/y"].values) + 8
