# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The values of timing parameters with which the virtual brick gives the rows of a record.

Nothing is derived by hand: the same image runs with other values until its rows fit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from ravenbrick.self_test.parameters import PARAMETERS, Parameter, Value
from ravenbrick.self_test.record import Row
from ravenbrick.self_test.tolerances import tolerance_of

__all__ = ["Estimate", "Rows", "fit"]

Rows = Mapping[str, Row]
Run = Callable[[Mapping[str, Value]], Rows | None]
"""The rows with these parameters, the others nominal; None when the program then fails."""

PASSES = 3
PROBE_STEPS = 2
UNUSABLE = 1e9


@dataclass(frozen=True)
class Estimate:
    """The values of a parameter that fit the record best; several cannot be told apart.

    `value` is the one nearest to the nominal value, with which later parameters are estimated.
    `fits`: with it the parameter's rows agree with the record.
    """

    parameter: Parameter
    value: Value
    values: tuple[Value, ...]
    fits: bool

    @property
    def moved(self) -> bool:
        """The rows refute the nominal value."""
        nominal = self.parameter.nominal
        if self.parameter.step_cycles:
            return abs(int(self.value) - int(nominal)) > self.parameter.step_cycles
        return nominal not in self.values


class _Fit:
    def __init__(self, measured: Rows, run: Run) -> None:
        self._measured = measured
        self._run = run
        self._known: dict[tuple[tuple[str, Value], ...], Rows | None] = {}
        self.values: dict[str, Value] = {p.name: p.nominal for p in PARAMETERS}
        self.estimates: dict[str, Estimate] = {}

    def rows(self, **changes: Value) -> Rows | None:
        """The rows with the values so far and these."""
        values = {**self.values, **changes}
        key = tuple(sorted(values.items()))
        if key not in self._known:
            self._known[key] = self._run(values)
        return self._known[key]

    def _distance(self, parameter: Parameter, value: Value) -> float:
        """How many tolerances the parameter's rows are away."""
        rows = self.rows(**{parameter.name: value})
        if rows is None:
            return UNUSABLE
        total = 0.0
        for name in parameter.rows:
            tolerance = tolerance_of(name)
            assert tolerance is not None, name
            if name not in rows:
                return UNUSABLE
            difference = abs(self._measured[name].value - rows[name].value)
            total += max(0.0, difference - tolerance.of(rows[name].value))
        return total

    def settled(self, parameter: Parameter) -> bool:
        """An earlier pass found the only value, and its rows still fit with what came after."""
        found = self.estimates.get(parameter.name)
        value = self.values[parameter.name]
        return (
            found is not None and found.values == (value,) and self._distance(parameter, value) == 0
        )

    def choose(self, parameter: Parameter) -> None:
        """The best of the listed values: from the present one on as long as it gets better."""
        values = parameter.values
        index = values.index(self.values[parameter.name])
        distances = {index: self._distance(parameter, values[index])}
        pending = [index - 1, index + 1]
        while pending:
            place = pending.pop()
            if place in distances or not 0 <= place < len(values):
                continue
            distances[place] = self._distance(parameter, values[place])
            if distances[place] <= min(distances.values()):
                pending += [place - 1, place + 1]
        best = min(distances.values())
        fitting = tuple(values[place] for place in sorted(distances) if distances[place] == best)
        nominal = values.index(parameter.nominal)
        chosen = min(fitting, key=lambda value: abs(values.index(value) - nominal))
        self.values[parameter.name] = chosen
        self.estimates[parameter.name] = Estimate(parameter, chosen, fitting, best == 0)

    def final(self, parameter: Parameter) -> Estimate:
        """The estimate, judged with the final values of all parameters."""
        fits = self._distance(parameter, self.values[parameter.name]) == 0
        return replace(self.estimates[parameter.name], fits=fits)

    def compute(self, parameter: Parameter) -> None:
        """The value by the slope of the rows, which depend on it in proportion."""
        now = int(self.values[parameter.name])
        probe = now + PROBE_STEPS * parameter.step_cycles
        here, there = self.rows(), self.rows(**{parameter.name: probe})
        if here is not None and there is not None:
            slopes = [(there[n].value - here[n].value) / (probe - now) for n in parameter.rows]
            gaps = [self._measured[n].value - here[n].value for n in parameter.rows]
            square = sum(slope * slope for slope in slopes)
            if square:
                change = sum(s * g for s, g in zip(slopes, gaps, strict=True)) / square
                now = max(0, now + round(change))
        self.values[parameter.name] = now
        fits = self._distance(parameter, now) == 0
        self.estimates[parameter.name] = Estimate(parameter, now, (now,), fits)


def fit(measured: Rows, run: Run, progress: Callable[[float], None]) -> list[Estimate]:
    """An estimate for each parameter whose rows the record has, in the order of `PARAMETERS`."""
    search = _Fit(measured, run)
    seen = [p for p in PARAMETERS if all(name in measured for name in p.rows)]
    for number in range(PASSES):
        before = dict(search.values)
        for place, parameter in enumerate(seen):
            progress((number * len(seen) + place) / (PASSES * len(seen)))
            if search.settled(parameter):
                continue
            if parameter.step_cycles:
                search.compute(parameter)
            else:
                search.choose(parameter)
        if search.values == before and number:
            break
    progress(1.0)
    return [search.final(parameter) for parameter in seen]
