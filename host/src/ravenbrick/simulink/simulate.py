# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A model over time: its signals, and what a step in it does."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import DesignError
from ravenbrick.model import ZeroOrderHold
from ravenbrick.model.blocks.continuous import ContinuousStateSpace
from ravenbrick.model.blocks.implicit import LateSignal, LoopSignal
from ravenbrick.model.blocks.time_functions import TimeFunction
from ravenbrick.model.diagram import AlgebraicLoopError, Diagram
from ravenbrick.model.simulation.hybrid import Hybrid
from ravenbrick.simulink.builder import ContinuousForm
from ravenbrick.simulink.importer import ModelSource
from ravenbrick.simulink.network import Network
from ravenbrick.simulink.numbers import value_of
from ravenbrick.simulink.rates import base_rate, own_rate
from ravenbrick.simulink.signals import Node, Ref
from ravenbrick.simulink.translation import Refusal, Translation

__all__ = ["Signal", "Simulation", "StepFigures", "simulate"]

Floats = NDArray[np.float64]
BAND = 0.02
_MOST_LOOPS = 200
_DEFAULT_STOP = 10.0
_AT_REST = 0.05  # share of the time at the end in which a settled signal stays within the band

_SMALL_CHANGE = 0.05  # share of all that a signal moves, below which it is no response to a step


@dataclass(frozen=True)
class StepFigures:
    """Of a signal after the first jump of a source.

    `settling_time` and `rise_time` (10 to 90 %) in s after the jump, `overshoot` as a share of the
    change from `initial` to `final`. A signal that has not settled has no settling time.
    """

    initial: float
    final: float
    peak: float
    overshoot: float
    rise_time: float | None
    settling_time: float | None


@dataclass(frozen=True)
class Signal:
    """An output of the model, or what a scope shows; `path` is that of the outport or scope."""

    name: str
    path: str
    values: Floats
    figures: StepFigures | None


@dataclass(frozen=True)
class Simulation:
    """Signals at the instants `times` (s); `sample_time` (s) is the shortest of sampled blocks.

    `algebraic_loops` were closed at every instant.
    """

    times: Floats
    signals: tuple[Signal, ...]
    sample_time: float | None
    continuous_states: int
    stop: float
    algebraic_loops: int = 0


def simulate(
    source: ModelSource, stop: float | None = None, inputs: Mapping[str, float] | None = None
) -> Simulation:
    """Run the model from 0 to `stop` (s), by default the stop time in its file.

    Continuous blocks are integrated with a variable step, sampled blocks run at their rates.
    `source.sample_time` is that of sampled blocks which state none, or 0. Root inports are
    constants: `inputs` by name, else 0. Raises `DesignError` with the blocks that cannot be
    simulated, or with an algebraic loop that has no solution.
    """
    network = source.network()
    stop = _stop_time(source, network) if stop is None else stop
    base = base_rate(network, source.sample_time)
    try:
        translation, hybrid = _prepared(source, network, base or stop, exact_rates=True)
    except AlgebraicLoopError:
        # Filters in place of exact derivatives may open the loop; the simulation closes others.
        translation, hybrid = _prepared(source, network, base or stop, exact_rates=False)
    given = dict(inputs or {})
    known = {slot.name for slot in hybrid.program.inputs}
    if given.keys() - known:
        raise DesignError(
            f"{source.path}: there is no inport '{min(given.keys() - known)}'; "
            f"there are: {', '.join(sorted(known)) or 'none'}"
        )
    rates = base if _is_sampled(translation) else None
    try:
        response = hybrid.run(stop, rates, given)
    except ValueError as error:
        raise DesignError(
            f"{source.path}: the simulation cannot go on: a sine or cosine of an infinite number; "
            "look for a quotient by 0 before it"
        ) from error
    begin = _first_jump(translation)
    signals = tuple(
        Signal(label, path, response.signals[name],
               _figures(response.times, response.signals[name], begin))
        for name, label, path in _labels(translation)
    )  # fmt: skip
    count = sum(len(n.block.states()) for n in translation.nodes
                if isinstance(n.block, ContinuousStateSpace))  # fmt: skip
    loops = sum(isinstance(node.block, LoopSignal) for node in translation.nodes)
    return Simulation(response.times, signals, rates, count, stop, loops)


def _prepared(
    source: ModelSource, network: Network, base: float, *, exact_rates: bool
) -> tuple[Translation, Hybrid]:
    translation = Translation(network, base, ContinuousForm.SOLVED, exact_rates=exact_rates)
    sampled = _sampled_nodes(translation, source.sample_time > 0)
    source.require_whole(translation, "simulated")
    if translation.outports:
        translation.show_sinks()
    diagram = source.assembled(translation)
    if not exact_rates:
        diagram = _without_loops(source, translation, sampled, diagram)
    return translation, Hybrid(diagram, sampled)


def _without_loops(
    source: ModelSource, translation: Translation, sampled: set[str], diagram: Diagram
) -> Diagram:
    """The diagram with a signal in each algebraic loop that the simulation has to find."""
    for _ in range(_MOST_LOOPS):
        try:
            diagram.order()
        except AlgebraicLoopError as error:
            nodes = {node.block.name: node for node in (*translation.nodes, *translation.outports)}
            loop = [nodes[name] for name in error.loop]
            translation.open_loop(loop[0], loop[1], sampled)
            diagram = source.assembled(translation)
        else:
            return diagram
    raise DesignError(
        f"{source.path}: more than {_MOST_LOOPS} algebraic loops; put delays into them"
    )


def _stop_time(source: ModelSource, network: Network) -> float:
    text = network.settings.get("StopTime", "")
    try:
        found = float(value_of(text, network.variables)[0, 0]) if text else _DEFAULT_STOP
    except ValueError as error:
        raise DesignError(f"{source.path}: its stop time '{text}': {error}; give --stop") from error
    if not 0 < found < math.inf:
        raise DesignError(f"{source.path}: its stop time is {found:g} s; give --stop")
    return found


def _is_sampled(translation: Translation) -> bool:
    """Whether any block states a sample time or has to take the one that is given."""
    stated = any(own_rate(s) for s in translation.network.sites.values() if not s.commented)
    return stated or any(
        node.path and not _is_continuous(node)
        and (node.block.states() or isinstance(node.block, ZeroOrderHold))
        for node in translation.nodes
    )  # fmt: skip


def _is_continuous(node: Node) -> bool:
    return isinstance(node.block, ContinuousStateSpace | LateSignal | LoopSignal)


def _sampled_nodes(translation: Translation, inherit: bool) -> set[str]:
    """Blocks of the diagram that change at samples only; refuses those without a sample time.

    With `inherit` discrete blocks behind continuous signals take the sample time given.
    """
    network = translation.network
    discrete, seeds = set(), set()
    for node in translation.nodes:
        if not node.path:
            continue
        if _is_continuous(node) or isinstance(node.block, TimeFunction):
            seeds.add(node.path)
        elif node.block.states():
            discrete.add(node.path)
    continuous = {path for path in seeds if own_rate(network.sites[path]) is None}
    changed = True
    while changed:
        changed = False
        for path, site in network.sites.items():
            if path in continuous or path in discrete or own_rate(site) is not None:
                continue
            ends = (network.source(path, port) for port in range(1, network.inputs(path) + 1))
            if any(end is not None and end[0] in continuous for end in ends):
                continuous.add(path)
                changed = True
    if not inherit:
        _refuse_unsampled(translation, discrete - seeds, continuous)
    for path in sorted(seeds):
        if next(network.guards(network.sites[path].system), None) is not None:
            reason = "a continuous block in a conditional subsystem"
            translation.refusals.append(Refusal(path, network.sites[path].kind, reason))
    return {node.block.name for node in translation.nodes
            if node.path and node.path not in continuous}  # fmt: skip


def _refuse_unsampled(translation: Translation, discrete: set[str], continuous: set[str]) -> None:
    network = translation.network
    for path in sorted(discrete):
        site = network.sites[path]
        ends = (network.source(path, port) for port in range(1, network.inputs(path) + 1))
        if own_rate(site) is None and any(end is not None and end[0] in continuous for end in ends):
            reason = (
                "a discrete block whose sample time is inherited from a continuous signal; give it "
                "one in its dialog, or --sample-time"
            )
            translation.refusals.append(Refusal(path, site.kind, reason))


def _first_jump(translation: Translation) -> float:
    jumps = [
        instant for node in translation.nodes if isinstance(node.block, TimeFunction)
        for instant in node.block.breaks(0.0)
    ]  # fmt: skip
    return max(min(jumps, default=0.0), 0.0)


def _labels(translation: Translation) -> list[tuple[str, str, str]]:
    """Name in the diagram, name for people, path of each output; a signal is shown once."""
    network = translation.network
    found: list[tuple[str, str, str]] = []
    shown: set[tuple[str, int, int]] = set()
    for node in translation.outports:
        site, wire = network.sites[node.path], node.inputs[0]
        label = site.block.name
        if isinstance(wire, Ref):
            end = (wire.path, wire.port, wire.element)
            if end in shown:
                continue
            shown.add(end)
            if site.kind != "Outport":
                label = network.sites[wire.path].block.name
            label += f" ({wire.element + 1})" if wire.element else ""
        taken = {name for _, name, _ in found}
        found.append((node.block.name, f"{label} in {node.path}" if label in taken else label,
                      node.path))  # fmt: skip
    return found


def _figures(times: Floats, values: Floats, begin: float) -> StepFigures | None:
    """None for a signal that does not change, only jumps, or comes back to where it was."""
    after = times >= begin
    time, value = times[after] - begin, values[after]
    initial, final = float(value[0]), float(value[-1])
    if begin > 0 and np.any(~after):
        initial = float(values[~after][-1])
    change = final - initial
    if len(np.unique(values)) <= 2 or abs(change) <= _SMALL_CHANGE * float(np.ptp(value)):
        return None
    share = (value - initial) / change
    outside = np.flatnonzero(np.abs(share - 1) > BAND)
    last = int(outside[-1]) if outside.size else -1
    rest = time[-1] * (1 - _AT_REST)
    settled = last + 1 < len(time) and (last < 0 or time[last] < rest)
    settling = None
    if settled:
        settling = 0.0 if last < 0 else _crossing(time, np.abs(share - 1), last, BAND)
    begins, ends = (np.flatnonzero(share >= level) for level in (0.1, 0.9))
    rise = float(time[ends[0]] - time[begins[0]]) if begins.size and ends.size else None
    peak = float(value[np.argmax(share)])
    return StepFigures(initial, final, peak, max(float(np.max(share)) - 1, 0.0), rise, settling)


def _crossing(time: Floats, distance: Floats, last: int, level: float) -> float:
    """Where a straight line between two points meets a level."""
    high, low = distance[last], distance[last + 1]
    part = (high - level) / (high - low) if high != low else 1.0
    return float(time[last] + part * (time[last + 1] - time[last]))
