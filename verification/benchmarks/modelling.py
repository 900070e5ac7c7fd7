# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Processor time of large diagrams and of a design's pictures, beside what a user may wait for.

The diagrams are chains of a loop of nine blocks: a filter, a controller with its limit, an
integrator, a look-up table and a delay, with gains that differ from loop to loop.
`python -m verification.benchmarks.modelling` prints the figures.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator

import control
from ravenbrick.codegen import generate_c
from ravenbrick.model import (
    Block,
    Diagram,
    DiscreteIntegrator,
    Gain,
    Inport,
    LookupTable,
    Outport,
    Saturation,
    Simulation,
    Sum,
    UnitDelay,
    ZeroPoleGain,
    diagram_svg,
    transfer_function_block,
)

from verification.benchmarks.child_time import run_timed
from verification.benchmarks.figures import REPEATS, VEHICLE, Figure
from verification.benchmarks.start_up import SCRIPTS
from verification.commands import NoResultError

__all__ = ["chain", "figures"]

SAMPLE_TIME = 0.001
LOOP = 9
GOALS_S = {
    "diagram of 300 blocks with a plant, 1 s of it at 1 kHz": 1.0,
    "diagram of 1,000 blocks, lowered, 1 s of it at 1 kHz, C": 5.0,
    "picture of a subsystem of 50 blocks": 1.0,
    "design of the vehicle with plots": 10.0,
}


def chain(count: int, name: str = "chain") -> Diagram:
    """About `count` blocks with both ports: loops in a row, each fed by the one before."""
    d = Diagram(name, SAMPLE_TIME)
    last: Block = d.add(Inport("y"))
    for number in range((count - 2) // LOOP):
        total, back = d.add(Sum(f"S{number}", signs="+-")), d.add(UnitDelay(f"Z{number}"))
        lag = ZeroPoleGain((-40.0,), (-300.0 - number,), 7.0)
        row = [
            transfer_function_block(f"F{number}", lag, sample_time=SAMPLE_TIME),
            Gain(f"P{number}", gain=0.5 + 0.003 * number),
            Saturation(f"L{number}", limit=9.0),
            DiscreteIntegrator(f"I{number}", gain=0.011 + 0.0001 * number),
            LookupTable(f"T{number}", breakpoints=(-9.0, 0.0, 9.0), table=(-8.0, 0.0, 7.5)),
            Gain(f"K{number}", gain=0.9),
            Saturation(f"M{number}", limit=8.0),
        ]
        added = [d.add(block) for block in row]
        d.connect(last, total, 0)
        d.connect_chain(total, *added, back)
        d.connect(back, total, 1)
        last = added[-1]
    d.connect(last, d.add(Outport("u")))
    return d


def simulated() -> None:
    """With a plant in continuous time, every signal recorded."""
    plant = control.tf([30.0], [1.0, 12.0], inputs="u", outputs="y", name="plant")
    Simulation(chain(300), plant).run(1.0)


def generated() -> None:
    """From the diagram to its C, through the gate of numeric fidelity, and simulated alone."""
    diagram = chain(1000)
    generate_c(diagram)
    open_loop = control.tf([1.0], [1.0], inputs="u", outputs="out", name="plant")
    Simulation(diagram, open_loop).run(1.0, {"y": 1.0})


def drawn() -> None:
    """One level, laid out anew."""
    diagram_svg(chain(50))


def _spent(work: Callable[[], None]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def _designed() -> float:
    command = [SCRIPTS["ravenbrick"], "design", str(VEHICLE), "--plots"]
    seconds, code = run_timed(command, 600)
    if code:
        raise NoResultError(f"{' '.join(command)}: ended with {code}")
    return seconds


def figures() -> Iterator[Figure]:
    """Medians of processor time, user and system."""
    works = (*(lambda work=work: _spent(work) for work in (simulated, generated, drawn)), _designed)
    for (name, goal), work in zip(GOALS_S.items(), works, strict=True):
        seconds = statistics.median(work() for _ in range(REPEATS))
        yield Figure(name, seconds, "s of processor time", "the goal", goal)


if __name__ == "__main__":
    for one in figures():
        print(f"{one.figure:56} {one.value:6.2f} s of {one.peer_value:g} s")
