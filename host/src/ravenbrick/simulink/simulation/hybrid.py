# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagram with continuous states over time: a variable step between the instants of samples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram
from ravenbrick.model import program as ir
from ravenbrick.model.execution import evaluate
from ravenbrick.model.flattening import flattened, with_shifts
from ravenbrick.simulink.simulation.continuous import TICK, TIME, LinearSystem, TimeFunction
from ravenbrick.simulink.simulation.modes import Mode, Values

__all__ = ["Hybrid", "Response"]

Floats = NDArray[np.float64]
_RELATIVE, _ABSOLUTE = 1e-9, 1e-12
_POINTS = 1000
_MOST_INSTANTS = 2_000_000
_QUICK_CHANGES = 4
_DWELL = 0.25
_MOST_EVALUATIONS = 500_000


@dataclass(frozen=True)
class Response:
    """Signals by the name of the diagram's outputs, at the instants `times` (s).

    At a sample or a jump there are two values, before and after.
    """

    times: Floats
    signals: Mapping[str, Floats]


class Hybrid:
    """A diagram in double precision; `sampled` names the blocks that only change at samples.

    Between two instants the states of linear systems are integrated by LSODA with a relative
    tolerance of 1e-9, with the outputs of sampled blocks held. Where a switch or limit changes is
    found on the way, and the integration begins anew there. One that goes on changing, as in a
    sliding mode, is held for a 4000th of the whole time before it may change again.
    """

    def __init__(self, diagram: Diagram, sampled: set[str]) -> None:
        program = flattened(with_shifts(diagram.lower()))
        blocks = {block.name: block for block in diagram.blocks}
        self._program = program
        statements = list(ir.statements(program.statements))
        self._functions = [b for b in diagram.blocks if isinstance(b, TimeFunction)]
        continuous = {n for n, block in blocks.items() if isinstance(block, LinearSystem)}
        self._states = [slot for slot in program.states if slot.block in continuous]
        state = ir.Kind.STATE
        derivatives = {
            s.target.name: s.expression for s in statements
            if s.block in continuous and s.target.kind is state
        }  # fmt: skip
        self._derivatives = [derivatives[slot.name] for slot in self._states]
        self._at_samples = [
            s for s in statements if not (s.block in continuous and s.target.kind is state)
        ]
        self._always = [
            s for s in self._at_samples
            if s.target.kind is not state and s.block in blocks and s.block not in sampled
        ]  # fmt: skip
        self._values: Values = {}
        self._times: list[float] = []
        self._rows: list[list[float]] = []
        self._end = 0.0

    def run(self, stop: float, sample_time: float | None, inputs: Mapping[str, float]) -> Response:
        """From 0 to `stop` (s), with samples every `sample_time` (s) if anything is sampled."""
        values = self._values
        for slot in (*self._program.states, *self._program.parameters):
            values[slot.kind, slot.name] = slot.data_type.scalar(slot.initial)
        for slot in self._program.inputs:
            values[slot.kind, slot.name] = np.float64(inputs.get(slot.name, 0.0))
        x = np.array([slot.initial for slot in self._states])
        hits = self._hits(stop, sample_time)
        instants = self._instants(stop, hits)
        samples = {round(hit / TICK) for hit in hits}
        self._times, self._rows = [], []
        for begin, end in zip(instants, [*instants[1:], stop], strict=True):
            self._end = end
            self._set(begin, x)
            everything = not self._times or round(begin / TICK) in samples
            self._execute(self._at_samples if everything else self._always)
            self._record(begin)
            if end > begin:
                x = self._integrated(begin, end, stop, x)
        table = np.array(self._rows)
        names = [slot.name for slot in self._program.outputs]
        return Response(np.array(self._times), {name: table[:, i] for i, name in enumerate(names)})

    def _hits(self, stop: float, sample_time: float | None) -> list[float]:
        if sample_time is None:
            return [0.0]
        count = int(stop / sample_time + TICK) + 1
        if count > _MOST_INSTANTS:
            raise DesignError(
                f"{count} samples of {sample_time:g} s until {stop:g} s; give a shorter --stop"
            )
        return [number * sample_time for number in range(count)]

    def _instants(self, stop: float, hits: list[float]) -> list[float]:
        """Samples and jumps in order, each once."""
        breaks = [t for f in self._functions for t in f.breaks(stop) if 0 < t <= stop]
        found: dict[int, float] = {}
        for instant in (*hits, *breaks):
            found.setdefault(round(instant / TICK), instant)
        return [found[tick] for tick in sorted(found)]

    def _set(self, time: float, x: Floats) -> None:
        """Time and states."""
        self._values[ir.Kind.INPUT, TIME] = np.float64(time)
        for slot, value in zip(self._states, x, strict=True):
            self._values[slot.kind, slot.name] = np.float64(value)

    def _execute(self, statements: list[ir.Statement]) -> None:
        values = self._values
        with np.errstate(all="ignore"):
            for statement in statements:
                target = statement.target
                values[target.kind, target.name] = evaluate(statement.expression, values)

    def _record(self, time: float) -> None:
        self._times.append(time)
        self._rows.append([float(self._values[s.kind, s.name]) for s in self._program.outputs])

    def _at(self, mode: Mode, time: float, x: Floats) -> None:
        """Just before the end of a piece its jump has not come yet."""
        self._set(min(time, self._end - TICK), x)
        mode.execute()

    def _piece(
        self, mode: Mode, begin: float, x: Floats, points: Floats, *, located: bool = True
    ) -> tuple[float, Floats]:
        """Instant and states at which a decision changes, or at the last of the points.

        Unless `located`, decisions are held until then.
        """
        if not len(x):
            for point in points:
                self._set(min(float(point), self._end - TICK), x)
                self._execute(self._always)
                self._record(float(point))
            return float(points[-1]), x
        from scipy.integrate import solve_ivp  # slow to load

        evaluations = 0

        def slope(time: float, states: Floats) -> list[float]:
            nonlocal evaluations
            evaluations += 1
            if evaluations > _MOST_EVALUATIONS:
                raise DesignError(
                    f"the simulation does not advance beyond {time:.6g} s: signals jump there "
                    "without a sample time, such as those of a quantiser; give it one"
                )
            self._at(mode, time, states)
            return mode.slopes()

        def change(time: float, states: Floats) -> float:
            self._at(mode, time, states)
            return mode.distance()

        change.terminal, change.direction = True, -1  # type: ignore[attr-defined]
        solved = solve_ivp(
            slope, (begin, points[-1]), x, "LSODA", points,
            events=change if located else None, rtol=_RELATIVE, atol=_ABSOLUTE,
        )  # fmt: skip
        states_at = np.reshape(solved.y, (len(x), len(solved.t)))
        if solved.status < 0 or not np.all(np.isfinite(states_at)):
            raise DesignError(
                f"the simulation cannot go on after {begin:.6g} s: the model is unstable "
                f"({solved.message.rstrip('.')})"
            )
        for time, states in zip(solved.t, states_at.T, strict=True):
            self._at(mode, time, states)
            self._record(float(time))
        if solved.status == 1:
            return float(solved.t_events[0][-1]), solved.y_events[0][-1]
        return float(points[-1]), states_at[:, -1]

    def _integrated(self, begin: float, end: float, stop: float, x: Floats) -> Floats:
        """The states at the end of a time without jumps; what is between goes into the record."""
        count = max(round(_POINTS * (end - begin) / stop), 1)
        points = np.linspace(begin, end, count + 1)[1:]
        dwell, quick = stop / _POINTS * _DWELL, 0
        while points.size:
            self._set(min(begin, end - TICK), x)
            mode = Mode(self._always, self._derivatives, self._values)
            if quick < _QUICK_CHANGES:
                reached, x = self._piece(mode, begin, x, points)
                quick = quick + 1 if reached - begin < dwell else 0
            else:
                until = min(begin + dwell, float(points[-1]))
                near = np.append(points[points < until], until)
                reached, x = self._piece(mode, begin, x, near, located=False)
                quick -= 1
            points = points[points > reached]
            if points.size:
                self._record(reached)
            begin = reached
        return x
