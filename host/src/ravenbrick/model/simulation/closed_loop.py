# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sampled controllers and a continuous plant in one loop, with every signal kept by its path."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Inport
from ravenbrick.model.blocks.logic import ZeroOrderHold
from ravenbrick.model.blocks.time_functions import TICK
from ravenbrick.model.diagram import Diagram
from ravenbrick.model.number_format import FixedFormat
from ravenbrick.model.simulation.execution import Execution
from ravenbrick.model.simulation.fmu_plant import FmuPlant, FmuPlantRun
from ravenbrick.model.simulation.hybrid import Hybrid, Solver
from ravenbrick.model.simulation.plants import linear_plant
from ravenbrick.model.simulation.recording import Recording, Signal

__all__ = ["Simulation", "sampled_blocks"]

Input = float | Callable[[float], float] | tuple[Sequence[float], Sequence[float]]


class Simulation:
    """Controllers and a plant, joined by the names of their ports.

    A controller is a diagram or program without continuous blocks, such as one in fixed point; it
    runs bit for bit as the generated C, at its own sample time. The plant is a diagram with
    continuous blocks, a linear system such as python-control's, or an FMU. An outport feeds inports
    of the same name at others; `lines` adds {inport: outport} where names differ. What remains open
    is an input of the whole. Controllers run in the order given and see the plant just before
    they act; their outputs reach the plant `latency` (s) later and are held. Without a
    controller the plant runs alone.
    """

    def __init__(
        self, controller: Diagram | ir.Program | Sequence[Diagram | ir.Program] | None, plant: Any,
        *, lines: Mapping[str, str] | None = None, latency: float = 0.0,
        solver: Solver | None = None,
    ) -> None:  # fmt: skip
        given = [] if controller is None else controller
        several = list(given) if isinstance(given, Sequence) else [given]
        own = isinstance(plant, Diagram | FmuPlant)
        self._plant = plant if own else linear_plant("plant", plant)
        self._controllers = several
        self._lines = dict(lines or {})
        self._solver = solver
        self._latency = latency
        names = [one.name for one in (*several, self._plant)]
        if len(set(names)) < len(names):
            raise DesignError(f"two parts of the simulation have one name: {', '.join(names)}")
        shortest = min((one.sample_time for one in several), default=latency + 1.0)
        if not 0 <= latency < shortest:
            raise DesignError(f"the latency {latency:g} s must be less than a sample time")

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inports that nothing inside feeds."""
        return tuple(_Run(self._plant, self._controllers, self._lines, self._solver).open)

    def run(self, stop: float, inputs: Mapping[str, Input] | None = None) -> Recording:
        """From rest at 0 to `stop` (s); each run begins anew.

        `inputs` are numbers, functions of the time in s, or pairs (times, values) that are held
        between; what is not given is 0. Raises `DesignError` for unknown names.
        """
        if not stop > 0:
            raise DesignError(f"the simulated time must be > 0 s, not {stop}")
        run = _Run(self._plant, self._controllers, self._lines, self._solver)
        run.give(inputs or {})
        return run.until(stop, self._latency)


class _Part:
    """A controller with what it has shown so far."""

    def __init__(self, model: Diagram | ir.Program) -> None:
        self.execution = Execution(model)
        self.program = self.execution.program
        self._names = _Names(model)
        self.ticks = round(self.program.sample_time / TICK)
        self._times: list[float] = []
        self._rows: list[tuple[Any, ...]] = []

    def step(self, time: float, values: Mapping[str, float]) -> dict[str, float]:
        """Outputs by name, in units and not raw."""
        given = [_held(slot, values[slot.name]) for slot in self.program.inputs]
        found = self.execution.sample(given)
        self._times.append(time)
        self._rows.append((*given, *found))
        return {slot.name: _real(slot, value)
                for slot, value in zip(self.program.outputs, found, strict=False)}  # fmt: skip

    def signals(self) -> dict[str, Signal]:
        """All signals by path."""
        times, table = np.array(self._times), np.array(self._rows, dtype=float)
        found = {}
        for place, slot in enumerate((*self.program.inputs, *self.execution.shown)):
            form = slot.data_type
            values = table[:, place] * (form.lsb if isinstance(form, FixedFormat) else 1.0)
            path = self._names.path(slot)
            found[path] = Signal(path, times, values, self._names.unit(slot), held=True)
        return found


class _Run:
    """One run: who is fed by whom, and the state of all parts."""

    def __init__(
        self, plant: Diagram | FmuPlant, controllers: Sequence[Diagram | ir.Program],
        lines: Mapping[str, str], solver: Solver | None,
    ) -> None:  # fmt: skip
        self._parts = [_Part(model) for model in controllers]
        self._plant = (
            FmuPlantRun(plant) if isinstance(plant, FmuPlant) else _DiagramRun(plant, solver)
        )
        outputs = [slot.name for part in self._parts for slot in part.program.outputs]
        own = self._plant.outputs
        twice = {name for name in (*outputs, *own) if (*outputs, *own).count(name) > 1}
        if twice:
            raise DesignError(f"several parts have an outport '{min(twice)}'; rename one of them")
        self._feeds = {**{name: name for name in (*outputs, *own)}, **lines}
        driven = [name for name in self._plant.inputs if name in self._feeds]
        self._driven = {name: self._feeds[name] for name in driven}
        wrong = {source for source in lines.values() if source not in (*outputs, *own)}
        inports = set(self._plant.inputs)
        inports |= {slot.name for part in self._parts for slot in part.program.inputs}
        wrong |= lines.keys() - inports
        if wrong:
            raise DesignError(
                f"the lines name '{min(wrong)}'; inports are {', '.join(sorted(inports))}; "
                f"outports are {', '.join(sorted((*outputs, *own)))}"
            )
        self.open = sorted(inports - self._feeds.keys())
        self._given: dict[str, float | Callable[[float], float]] = dict.fromkeys(self.open, 0.0)

    def give(self, inputs: Mapping[str, Input]) -> None:
        """Values of the open inports."""
        for name, value in inputs.items():
            if name not in self._given:
                known = ", ".join(self.open) or "none"
                raise DesignError(f"the simulation has no input '{name}'; there are: {known}")
            self._given[name] = _recorded(*value) if isinstance(value, tuple) else value
        for name in self._plant.inputs:
            if name in self._given:
                self._plant.give(name, self._given[name])

    def until(self, stop: float, latency: float) -> Recording:
        """Run, and give what was recorded."""
        try:
            self._follow(stop, latency)
            found = self._plant.recording()
        finally:
            self._plant.close()
        signals = dict(found.signals)
        for part in self._parts:
            signals |= part.signals()
        return Recording(signals, found.events)

    def _follow(self, stop: float, latency: float) -> None:
        instants = self._instants(stop, latency)
        plant, values = self._plant, dict.fromkeys(self._feeds.values(), 0.0)
        late: dict[int, dict[str, float]] = {}
        lag = round(latency / TICK)
        own = round(plant.period / TICK) if plant.period else 0
        for begin, end in zip(instants, [*instants[1:], stop], strict=True):
            tick = round(begin / TICK)
            if own and tick % own == 0:
                plant.sample(begin)
            due = [part for part in self._parts if tick % part.ticks == 0]
            if due:
                values |= plant.values(begin)
            for part in due:
                found = part.step(begin, self._inputs_of(part, begin, values))
                values |= found
                late.setdefault(tick + lag, {}).update(found)
            applied = late.pop(tick, {})
            for name, source in self._driven.items():
                if source in applied:
                    plant.give(name, applied[source])
            plant.record(begin)
            plant.advance(begin, end)

    def _instants(self, stop: float, latency: float) -> list[float]:
        hits = [0.0]
        for part in self._parts:
            period = part.program.sample_time
            own = [k * period for k in range(int(stop / period + TICK) + 1)]
            hits += own
            hits += [hit + latency for hit in own if latency and hit + latency < stop]
        if self._plant.period:
            period = self._plant.period
            hits += [k * period for k in range(int(stop / period + TICK) + 1)]
        return self._plant.instants(stop, hits)

    def _inputs_of(self, part: _Part, time: float, values: Mapping[str, float]) -> dict[str, float]:
        found = {}
        for slot in part.program.inputs:
            if slot.name in self._feeds:
                found[slot.name] = values[self._feeds[slot.name]]
            else:
                given = self._given[slot.name]
                found[slot.name] = given(time) if callable(given) else given
        return found


class _DiagramRun(Hybrid):
    """A plant as a diagram: its ports, and its signals by path."""

    def __init__(self, diagram: Diagram, solver: Solver | None) -> None:
        sampled, has_samples = sampled_blocks(diagram.flat())
        super().__init__(diagram, sampled, solver, everything=True)
        self.inputs = tuple(slot.name for slot in self.program.inputs)
        self.outputs = tuple(slot.name for slot in self.program.outputs)
        self.period = diagram.sample_time if has_samples else None
        self._names = _Names(diagram)

    def recording(self) -> Recording:
        """All signals, and the events with the paths of their blocks."""
        response, names = self.response(), self._names
        signals = {}
        for slot in self.shown:
            path, values = names.path(slot), response.signals[slot.name]
            signals[path] = Signal(path, response.times, values, names.unit(slot), held=False)
        events = tuple((event.time, names.block(event.block)) for event in response.events)
        return Recording(signals, events)

    def close(self) -> None:
        """Nothing is open."""


class _Names:
    """Paths and units of a part's signals."""

    def __init__(self, model: Diagram | ir.Program) -> None:
        self._name = model.name
        self._paths = model.flat().paths if isinstance(model, Diagram) else {}
        self._units = model.units if isinstance(model, Diagram) else {}

    def block(self, name: str) -> str:
        return f"{self._name}/{self._paths.get(name, name)}"

    def path(self, slot: ir.Slot) -> str:
        return f"{self.block(slot.block)}{_ending(slot)}"

    def unit(self, slot: ir.Slot) -> str:
        """As stated, or as it follows from others."""
        if isinstance(slot.data_type, FixedFormat):
            return ""
        number = _ending(slot).removesuffix("_held").lstrip("_") or "1"
        output = int(number) - 1 if number.isdigit() else -1
        path = self._paths.get(slot.block, slot.block)
        return slot.unit or self._units.get(f"{path}:{output}", "")


def _ending(slot: ir.Slot) -> str:
    return slot.name[len(slot.block) :] if slot.name.startswith(slot.block) else ""


def _held(slot: ir.Slot, value: float) -> float:
    """A value as the port holds it: of a fixed-point port the raw one, at most its limits."""
    form = slot.data_type
    if not isinstance(form, FixedFormat):
        return value
    low, high = form.limits
    return min(max(round(value / form.lsb), low), high)


def _real(slot: ir.Slot, value: Any) -> float:
    form = slot.data_type
    return form.real(value) if isinstance(form, FixedFormat) else float(value)


def _recorded(times: Sequence[float], values: Sequence[float]) -> Callable[[float], float]:
    known, found = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if known.shape != found.shape or known.ndim != 1 or not len(known):
        raise DesignError(f"{known.size} times for {found.size} values of an input")
    return lambda t: float(found[max(int(np.searchsorted(known, t + TICK / 2, "right")) - 1, 0)])


def sampled_blocks(flat: Diagram) -> tuple[set[str], bool]:
    """Names of blocks that change at samples only, and whether any of them has a memory.

    Inports may change at any time, and so does what follows from them without a memory.
    """
    memory = {
        b.name for b in flat.blocks
        if not b.is_continuous and (b.states() or isinstance(b, ZeroOrderHold))
    }  # fmt: skip
    flowing: set[str] = set()
    for block in flat.order():
        sources = [flat.source(block, port) for port in range(len(block.input_types))]
        if (
            block.is_continuous
            or isinstance(block, Inport)
            or (block.name not in memory and any(source.name in flowing for source in sources))
        ):
            flowing.add(block.name)
    return {b.name for b in flat.blocks} - flowing, bool(memory)
