# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A fixed-point program against its ideal design, for all time: rounding and gains as held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ravenbrick.control.rounding.peak_gain import peak_gain
from ravenbrick.errors import DesignError
from ravenbrick.model import LinearSystem, linear_system
from ravenbrick.model import program as ir
from ravenbrick.model.fixed_point import FixedPoint
from ravenbrick.model.flattening import with_shifts
from ravenbrick.model.linearisation import ErrorSource, linearise_with_errors, lsb_of
from ravenbrick.model.number_format import FixedFormat

__all__ = ["IdealBound", "PhysicalForms", "error_sizes", "ideal_bounds", "input_sizes"]

_Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class IdealBound:
    """|fixed point - design| <= `rounding` + `coefficients` for all time.

    For inputs in their declared ranges that their formats hold, from the initial state, while no
    limit that the user set is reached.
    """

    rounding: float
    coefficients: float

    @property
    def total(self) -> float:
        """Both."""
        return self.rounding + self.coefficients


@dataclass(frozen=True, eq=False)
class PhysicalForms:
    """Both forms with the units of their ports: `held` has the inputs, then errors, then 1.

    States of `held` are raw integers, those of `ideal` real numbers. Errors have the unit of what
    is rounded; `sources` describe them.
    """

    held: LinearSystem
    ideal: LinearSystem
    sources: tuple[ErrorSource, ...]
    held_start: _Array
    ideal_start: _Array

    @classmethod
    def of(cls, fixed: FixedPoint) -> PhysicalForms:
        """Raises `DiagramError` for a program that is not linear."""
        program = fixed.program
        found, sources = linearise_with_errors(program, constants=True)
        raw = LinearSystem.of(found)
        lsbs = [lsb_of(slot) for slot in program.inputs] + [one.lsb for one in sources] + [1.0]
        leave = np.array([lsb_of(slot) for slot in program.outputs])[:, np.newaxis]
        entry = 1.0 / np.array(lsbs)
        held = LinearSystem(raw.A, raw.B * entry, leave * raw.C, leave * raw.D * entry, raw.dt)
        starts = (
            np.array([float(slot.initial) for slot in slots])
            for slots in (with_shifts(program).states, with_shifts(fixed.source).states)
        )
        return cls(held, linear_system(fixed.source, constants=True), sources, *starts)

    def difference(self) -> LinearSystem:
        """From inputs, 1 and the initial state to held minus ideal outputs."""
        ports = self.ideal.ninputs - 1
        held = _chosen(self.held, [*range(ports), self.held.ninputs - 1], self.held_start)
        return _difference(held, _chosen(self.ideal, [*range(ports + 1)], self.ideal_start))

    def errors(self) -> LinearSystem:
        """From the roundings to the held outputs."""
        ports = self.ideal.ninputs - 1
        return _chosen(self.held, [*range(ports, ports + len(self.sources))])


def _chosen(
    system: LinearSystem, inputs: Sequence[int], start: _Array | None = None
) -> LinearSystem:
    """Some of the inputs, and one more that sets the initial state a step before."""
    b, d = system.B[:, inputs], system.D[:, inputs]
    if start is not None:
        b, d = np.column_stack([b, start]), np.column_stack([d, np.zeros(len(d))])
    return LinearSystem(system.A, b, system.C, d, system.dt)


def _difference(first: LinearSystem, second: LinearSystem) -> LinearSystem:
    size, other = first.nstates, second.nstates
    matrix = np.zeros((size + other, size + other))
    matrix[:size, :size], matrix[size:, size:] = first.A, second.A
    return LinearSystem(
        matrix,
        np.vstack([first.B, second.B]),
        np.hstack([first.C, -second.C]),
        first.D - second.D,
        first.dt,
    )


def error_sizes(sources: Sequence[ErrorSource]) -> _Array:
    """The largest error of each source, in the unit of what is rounded."""
    return np.array([one.size * one.lsb if one.active else 0.0 for one in sources])


def input_sizes(fixed: FixedPoint) -> list[float]:
    """The largest values of the inports in their declared ranges."""
    return [fixed.ranges[slot.kind, slot.name].size for slot in fixed.source.inputs]


def ideal_bounds(fixed: FixedPoint) -> dict[str, IdealBound]:
    """Bounds by outport, by worst-case peak gains (as in `closed_loop_bound`).

    Raises `DesignError` for a program that is not linear, that is not stable by itself, or whose
    errors could drive a state to a limit that no value of the design reaches.
    """
    forms = PhysicalForms.of(fixed)
    _check_states(fixed, forms)
    sizes = np.array([*input_sizes(fixed), 1.0, 1.0])
    rounding = _peaks(forms.errors()) @ error_sizes(forms.sources)
    coefficients = _peaks(forms.difference()) @ sizes
    return {
        slot.name: IdealBound(float(rounding[index]), float(coefficients[index]))
        for index, slot in enumerate(fixed.program.outputs)
    }


def _peaks(system: LinearSystem) -> _Array:
    """Peak gains, shape (outputs, inputs)."""
    if not system.B.shape[1]:
        return np.zeros((len(system.C), 0))
    return np.asarray(peak_gain(system))


def _check_states(fixed: FixedPoint, forms: PhysicalForms) -> None:
    """Limits that only guard the proof must not be reached: they would be one more error."""
    units = np.array([lsb_of(slot) for slot in with_shifts(fixed.program).states])
    if not len(units):
        return
    held, ideal = forms.held, forms.ideal
    seen = PhysicalForms(
        LinearSystem(held.A, held.B, np.diag(units), np.zeros((len(units), held.ninputs)), held.dt),
        LinearSystem(ideal.A, ideal.B, np.eye(len(units)), 0 * ideal.B, ideal.dt),
        forms.sources, forms.held_start, forms.ideal_start,
    )  # fmt: skip
    errors = _peaks(seen.errors()) @ error_sizes(forms.sources)
    errors = errors + _peaks(seen.difference()) @ np.array([*input_sizes(fixed), 1.0, 1.0])
    limits = _limits(fixed.program)
    stated = fixed.options.ranges
    for slot, error in zip(with_shifts(fixed.source).states, errors, strict=True):
        if slot.block in stated or slot.name in stated or slot.name not in limits:
            continue
        range_, (low, high) = fixed.ranges[slot.kind, slot.name], limits[slot.name]
        if range_.low - error < low or range_.high + error > high:
            raise DesignError(
                f"state '{slot.name}' may be wrong by {error:.3g} and reach its limit {high:.6g}: "
                "no bound for all time is stated"
            )


def _limits(program: ir.Program) -> dict[str, tuple[float, float]]:
    found = {}
    for statement in ir.statements(program.statements):
        form, bounded = statement.target.data_type, statement.expression
        if statement.target.kind is ir.Kind.STATE and isinstance(bounded, ir.Bounded):
            assert isinstance(form, FixedFormat)
            found[statement.target.name] = form.real(bounded.low), form.real(bounded.high)
    return found
