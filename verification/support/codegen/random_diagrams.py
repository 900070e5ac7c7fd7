# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Random diagrams: feedback, rates, parts that run on a condition; the same for a seed."""

from __future__ import annotations

import random
from collections.abc import Callable

from ravenbrick import model
from ravenbrick.errors import DesignError
from ravenbrick.model.program import Program

__all__ = ["fixed_form", "random_diagram"]

_PORTS = 2
_LIMIT = 8.0
_STATES = 12.0
Maker = Callable[[str, random.Random], model.Block]

_COMMON: tuple[Maker, ...] = (
    lambda n, r: model.Gain(n, gain=r.choice((-1.5, -0.5, 0.25, 0.75))),
    lambda n, r: model.Sum(n, signs=r.choice(("+-", "++", "+-+"))),
    lambda n, r: model.Saturation(n, limit=r.uniform(1, 4), lower=r.uniform(-3, 0)),
    lambda n, r: model.UnitDelay(n, initial=r.choice((0.0, 0.5))),
    lambda n, r: model.Delay(n, length=r.randint(2, 4)),
    lambda n, r: model.MovingAverage(n, length=r.randint(2, 4)),
    lambda n, r: model.DeadZone(n, start=-0.5, end=r.uniform(0, 1)),
    lambda n, r: model.RateLimit(n, rising=r.uniform(0.5, 2), falling=1.0),
    lambda n, r: model.Relay(n, on_above=0.5, off_below=-0.5),
    lambda n, r: model.Switch(n, threshold=r.uniform(-1, 1), criterion=r.choice((">=", ">"))),
    lambda n, r: model.LookupTable(n, breakpoints=(-2.0, 0.0, 3.0), table=(1.0, -1.0, 2.0)),
    lambda n, r: model.RelationalOperator(n, operator=r.choice(("<", ">=", "=="))),
    lambda n, r: model.LogicalOperator(n, operator=r.choice(("AND", "OR", "XOR"))),
    lambda n, r: model.MinMax(n, function=r.choice(("min", "max")), ports=r.randint(2, 3)),
    lambda n, r: model.Abs(n),
    lambda n, r: model.Sign(n),
    lambda n, r: model.RoundingFunction(n, function=r.choice(("floor", "ceil", "fix"))),
    lambda n, r: model.Merge(n),
    lambda n, r: model.ZeroOrderHold(n, sample_time=0.02),
)
_FLOATING: tuple[Maker, ...] = (
    lambda n, r: model.DiscreteIntegrator(
        n, gain=0.05, method=r.choice(tuple(model.IntegrationMethod))
    ),
    lambda n, r: model.DiscreteTransferFunction(
        n, numerator=(0.5, r.uniform(-0.5, 0.5)), denominator=(1.0, -0.75)
    ),
    lambda n, r: model.Product(n),
    lambda n, r: model.Trigonometry(n, function=r.choice(("sin", "cos"))),
    lambda n, r: model.Backlash(n, width=r.uniform(0.5, 2)),
)


def random_diagram(seed: int, count: int = 12, *, fixed: bool = False) -> model.Diagram:
    """`count` blocks behind two inports, one of them fed back, all joined into one outport.

    With `fixed` only blocks that have a fixed-point form.
    """
    r = random.Random(seed)
    diagram = model.Diagram(f"lot_{seed}", 0.01)
    signals: list[model.Block] = [diagram.add(model.Inport(f"In{port}")) for port in range(_PORTS)]
    back = diagram.add(model.UnitDelay("Back"))
    signals.append(back)
    makers = _COMMON if fixed else _COMMON + _FLOATING
    used: set[str] = set()
    for number in range(count):
        block = diagram.add(r.choice(makers)(f"B{number}", r))
        recent = {signal.name: signal for signal in [*signals[:_PORTS], *signals[-6:]]}
        for port, source in enumerate(r.sample(list(recent.values()), len(block.input_types))):
            used.add(source.name)
            diagram.connect(source, block, port)
        if block.states() and r.random() < 0.4:
            test = diagram.add(model.RelationalOperator(f"When{number}", operator=">"))
            for port in (0, 1):
                diagram.connect(signals[r.randrange(_PORTS)] if port else block, test, port)
            hold = diagram.add(model.UnitDelay(f"Last{number}"))
            diagram.connect(test, hold)
            diagram.enable(block, hold, reset=r.random() < 0.5)
        signals.append(block)
    _gather(diagram, [s for s in signals if s.name not in used or s is back], back)
    return diagram


def _gather(diagram: model.Diagram, rest: list[model.Block], back: model.Block) -> None:
    """All signals that nobody reads into one, limited, fed back and shown."""
    total = diagram.add(model.Sum("Total", signs="+" * max(len(rest), 2)))
    for port in range(max(len(rest), 2)):
        diagram.connect(rest[port % len(rest)], total, port)
    limit = diagram.add(model.Saturation("Limit", limit=_LIMIT))
    diagram.connect(total, limit)
    diagram.connect(limit, back)
    diagram.connect(limit, diagram.add(model.Outport("Out")))


def fixed_form(diagram: model.Diagram) -> Program | None:
    """The diagram in fixed point; None if its sums leave no accumulator of 32 bits."""
    ranges = {f"In{port}": 4.0 for port in range(_PORTS)}
    for block in diagram.blocks:
        if block.states() and not isinstance(block, model.Inport):
            ranges[block.name] = _LIMIT if block.name == "Back" else _STATES
    try:
        return model.to_fixed_point(diagram, model.FixedPointOptions(ranges)).program
    except DesignError:
        return None
