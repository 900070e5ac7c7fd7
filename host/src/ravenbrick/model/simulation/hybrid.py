# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagram with continuous states over time: a variable step between the instants of samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.implicit import ImplicitSignal
from ravenbrick.model.blocks.time_functions import TICK, TIME, TimeFunction
from ravenbrick.model.diagram import Diagram
from ravenbrick.model.flattening import flattened, with_shifts
from ravenbrick.model.simulation.decided_text import Decisions
from ravenbrick.model.simulation.implicit import Implicit
from ravenbrick.model.simulation.python_text import PythonText

__all__ = ["Event", "Hybrid", "Response", "Solver"]

Floats = NDArray[np.float64]
Given = float | Callable[[float], float]
_POINTS = 1000
_MOST_INSTANTS = 2_000_000
_QUICK_CHANGES = 4
_DWELL = 0.25
_MOST_EVALUATIONS = 500_000
_CLOSEST = 1e-13  # of an event's instant, relative to the time
_HALVINGS = 60


@dataclass(frozen=True)
class Solver:
    """How differential equations are solved: a method of `scipy.integrate` and its tolerances.

    `method` is LSODA, RK45, RK23, DOP853, Radau or BDF; `longest_step` in s.
    """

    method: str = "LSODA"
    relative: float = 1e-9
    absolute: float = 1e-12
    longest_step: float = math.inf

    def __post_init__(self) -> None:
        known = ("LSODA", "RK45", "RK23", "DOP853", "Radau", "BDF")
        if self.method not in known:
            raise DesignError(f"no solver '{self.method}'; there are: {', '.join(known)}")


@dataclass(frozen=True)
class Event:
    """A switch, limit, edge or change of friction at `time` (s) in the block of this name."""

    time: float
    block: str


@dataclass(frozen=True)
class Response:
    """Signals by name at the instants `times` (s); at a sample or a jump before and after it."""

    times: Floats
    signals: Mapping[str, Floats]
    events: tuple[Event, ...] = ()


class Hybrid:
    """A diagram in double precision; `sampled` names the blocks that only change at samples.

    Between two instants the continuous states are integrated by `solver`, with the outputs of
    sampled blocks held. Where a switch or limit changes is found on the way, and the integration
    begins anew there. One that goes on changing, as in a sliding mode, is held for a 4000th of the
    whole time before it may change again.
    """

    def __init__(
        self, diagram: Diagram, sampled: set[str], solver: Solver | None = None,
        *, everything: bool = False,
    ) -> None:  # fmt: skip
        program = flattened(with_shifts(diagram.lower(continuous=True)))
        blocks = {block.name: block for block in diagram.flat().blocks}
        self.program = program
        self._solver = solver or Solver()
        self._functions = [b for b in blocks.values() if isinstance(b, TimeFunction)]
        implicit = {name for name, block in blocks.items() if isinstance(block, ImplicitSignal)}
        continuous = {name for name, block in blocks.items() if block.is_continuous} - implicit
        everything_said = list(ir.statements(program.statements))
        found = [s for s in everything_said
                 if s.block in implicit and s.target.kind is ir.Kind.STATE]  # fmt: skip
        statements = [s for s in everything_said if s not in found]
        own = [s for s in statements if s.block in continuous and s.target.kind is ir.Kind.STATE]
        at_samples = [s for s in statements if s not in own]
        always = [
            s for s in at_samples
            if s.target.kind is not ir.Kind.STATE and s.block in blocks and s.block not in sampled
        ]  # fmt: skip
        flowing = {(s.target.kind, s.target.name) for s in always}
        held = [slot for slot in (*program.signals, *program.outputs)
                if (slot.kind, slot.name) not in flowing]  # fmt: skip
        order = {slot.name: place for place, slot in enumerate(program.states)}
        own.sort(key=lambda s: order[s.target.name])
        self._states = [s.target for s in own]
        kept = (*self._states, *(s for s in program.states if s not in self._states),
                *program.parameters, *held)  # fmt: skip
        self.shown = (*program.outputs, *(program.signals if everything else ()))
        self._inputs = (*program.inputs, TIME)
        self._memory: list[Any] = [float(slot.initial) for slot in kept]
        text = PythonText(kept, float)
        text.instructions(at_samples)
        self._sample = text.function(self._inputs, [])
        self._decisions = Decisions(kept, self._inputs, always, own, self.shown)
        self._implicit = Implicit(kept, self._inputs, always, at_samples, found, blocks, sampled)
        self._given: list[Given] = [0.0] * len(program.inputs)
        self.x = np.array([slot.initial for slot in self._states])
        self._times: list[float] = []
        self._rows: list[tuple[float, ...]] = []
        self._events: list[Event] = []
        self._end = self._stop = 0.0

    def run(self, stop: float, sample_time: float | None, inputs: Mapping[str, Given]) -> Response:
        """From 0 to `stop` (s), with samples every `sample_time` (s) if anything is sampled."""
        for name, value in inputs.items():
            self.give(name, value)
        hits = self._hits(stop, sample_time)
        samples = {round(hit / TICK) for hit in hits}
        instants = self.instants(stop, hits)
        for begin, end in zip(instants, [*instants[1:], stop], strict=True):
            if not self._times or round(begin / TICK) in samples:
                self.sample(begin)
            self.record(begin)
            self.advance(begin, end)
        return self.response()

    def give(self, name: str, value: Given) -> None:
        """A new value at an input, or a function of the time in s."""
        names = [slot.name for slot in self.program.inputs]
        self._given[names.index(name)] = value

    def response(self) -> Response:
        """All that was recorded."""
        table = np.array(self._rows, dtype=float).reshape(len(self._times), len(self.shown))
        signals = {slot.name: table[:, place] for place, slot in enumerate(self.shown)}
        return Response(np.array(self._times), signals, tuple(self._events))

    def _hits(self, stop: float, sample_time: float | None) -> list[float]:
        if sample_time is None:
            return [0.0]
        count = int(stop / sample_time + TICK) + 1
        if count > _MOST_INSTANTS:
            raise DesignError(
                f"{count} samples of {sample_time:g} s until {stop:g} s; give a shorter --stop"
            )
        return [number * sample_time for number in range(count)]

    def instants(self, stop: float, hits: Sequence[float]) -> list[float]:
        """Samples and jumps in order, each once; `stop` ends the run (s)."""
        self._stop = stop
        breaks = [t for f in self._functions for t in f.breaks(stop) if 0 < t <= stop]
        found: dict[int, float] = {}
        for instant in (*hits, *breaks, *self._implicit.echoes([*hits, *breaks], stop)):
            found.setdefault(round(instant / TICK), instant)
        return [found[tick] for tick in sorted(found)]

    def _at(self, time: float) -> list[float]:
        """The values of the inputs; just before the end of a piece its jump has not come yet."""
        return [*(value(time) if callable(value) else value for value in self._given), time]

    def _put(self, states: Floats, time: float, *, at_sample: bool = False) -> list[float]:
        """States and implicit signals into the memory; the values of the inputs."""
        given = self._at(time)
        self._memory[: len(states)] = states.tolist()
        if self._implicit:
            self._implicit.put(self._memory, given, at_sample=at_sample)
        return given

    def sample(self, time: float) -> None:
        """Sampled blocks take their inputs."""
        given = self._put(self.x, time, at_sample=True)
        with np.errstate(all="ignore"):
            self._sample(self._memory, given, None)

    def values(self, time: float) -> dict[str, float]:
        """The outputs at an instant."""
        found = self._decisions.find(self._memory, self._put(self.x, time))
        return {slot.name: found[place] for place, slot in enumerate(self.program.outputs)}

    def record(self, time: float, *, before_jump: bool = False) -> None:
        """Note what is shown, at an instant after its jumps unless `before_jump`."""
        given = self._put(self.x, time - TICK if before_jump else time)
        self._times.append(time)
        self._rows.append(self._decisions.find(self._memory, given))
        self._implicit.note(self._memory, given)

    def advance(self, begin: float, end: float) -> None:
        """Integrate over a time without jumps and note points, a thousand in the whole run."""
        if end <= begin:
            return
        self._end = end
        count = max(round(_POINTS * (end - begin) / self._stop), 1)
        points = np.linspace(begin, end, count + 1)[1:]
        dwell, quick = self._stop / _POINTS * _DWELL, 0
        while points.size:
            given = self._put(self.x, min(begin, end - TICK))
            self._decisions.find(self._memory, given)
            if quick < _QUICK_CHANGES:
                reached = self._piece(begin, points)
                quick = quick + 1 if reached - begin < dwell else 0
            else:
                until = min(begin + dwell, float(points[-1]))
                near = np.append(points[points < until], until)
                reached = self._piece(begin, near, located=False)
                quick -= 1
            points = points[points > reached]
            if points.size:
                self._note(reached, self.x)
            begin = reached

    def _note(self, time: float, x: Floats) -> None:
        """Record with the decisions as they are."""
        given = self._put(x, min(time, self._end - TICK))
        self._times.append(time)
        self._rows.append(self._decisions.values(self._memory, given))

    def _piece(self, begin: float, points: Floats, *, located: bool = True) -> float:
        """Go to the instant at which a decision changes, or to the last of the points.

        Unless `located`, decisions are held until then.
        """
        memory, decisions = self._memory, self._decisions
        last = self._end - TICK
        evaluations = 0

        def slope(time: float, states: Floats) -> tuple[Any, ...]:
            nonlocal evaluations
            evaluations += 1
            if evaluations > _MOST_EVALUATIONS:
                raise DesignError(
                    f"the simulation does not advance beyond {time:.6g} s: signals jump there "
                    "without a sample time, such as those of a quantiser; give it one"
                )
            return decisions.slopes(memory, self._put(states, min(time, last)))

        def distance(time: float, states: Floats) -> float:
            return decisions.distance(memory, self._put(states, min(time, last)))

        located = located and decisions.any
        solver: Any = _Still(begin, points)
        if len(self.x):
            solver = self._started(slope, begin, float(points[-1]))
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed" or not np.all(np.isfinite(solver.y)):
                raise DesignError(
                    f"the simulation cannot go on after {begin:.6g} s: the model is unstable "
                    f"({(message or 'a state is not finite').rstrip('.')})"
                )
            reached, states, changes = solver.t, solver.y, False
            if located and distance(reached, states) < 0:
                reached, states = self._instant(solver, distance)
                changes = True
            self._record_until(solver, points, reached)
            self._note_late(solver, reached, last)
            if changes:
                distance(reached, states)
                self._events.append(Event(float(reached), decisions.nearest))
                self.x = np.array(states)
                return float(reached)
        self.x = np.array(solver.y)
        return float(points[-1])

    def _started(self, slope: Callable[..., Any], begin: float, end: float) -> Any:
        from scipy import integrate  # slow to load

        own = self._solver
        longest = min(own.longest_step, self._implicit.longest_step or math.inf)
        more = {} if math.isinf(longest) else {"max_step": longest}
        method = getattr(integrate, own.method)
        return method(slope, begin, self.x, end, rtol=own.relative, atol=own.absolute, **more)

    def _instant(
        self, solver: Any, distance: Callable[[float, Floats], float]
    ) -> tuple[float, Floats]:
        """The first moment after a decision changes within the solver's last step, by halving."""
        before, after = solver.t_old, solver.t
        between = solver.dense_output()
        for _ in range(_HALVINGS):
            middle = (before + after) / 2
            if after - before <= _CLOSEST * max(abs(after), 1e-3) or middle in (before, after):
                break
            if distance(middle, between(middle)) < 0:
                after = middle
            else:
                before = middle
        return after, between(after)

    def _note_late(self, solver: Any, reached: float, last: float) -> None:
        """The inputs of late signals in the solver's last step."""
        shares = self._implicit.shares()
        between = solver.dense_output() if shares else None
        for share in shares:
            time = solver.t_old + share * (reached - solver.t_old)
            states = np.array(between(time)) if between else self.x
            self._implicit.note(self._memory, self._put(states, min(time, last)))

    def _record_until(self, solver: Any, points: Floats, reached: float) -> None:
        own = points[(points > solver.t_old) & (points <= reached)]
        if own.size:
            between = solver.dense_output()
            for point in own:
                self._note(float(point), np.array(between(point)))


class _Still:
    """A solver for a diagram without continuous states: it steps from point to point."""

    def __init__(self, begin: float, points: Floats) -> None:
        self._points = iter(points)
        self._last = float(points[-1])
        self.t, self.t_old, self.y, self.status = begin, begin, np.zeros(0), "running"

    def step(self) -> str | None:
        """To the next point."""
        self.t_old, self.t = self.t, float(next(self._points))
        self.status = "finished" if self.t >= self._last else "running"
        return None

    def dense_output(self) -> Callable[[float], Floats]:
        """No states."""
        return lambda _: self.y
