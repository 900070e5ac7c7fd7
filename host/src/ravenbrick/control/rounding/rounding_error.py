# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What rounding can do to a fixed-point controller: in one step, and in the loop for all time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ravenbrick.control.rounding.ideal_error import (
    PhysicalForms,
    error_sizes,
    input_sizes,
)
from ravenbrick.control.rounding.peak_gain import peak_gain
from ravenbrick.errors import DesignError
from ravenbrick.model import LinearSystem
from ravenbrick.model import program as ir
from ravenbrick.model.fixed_point import FixedPoint
from ravenbrick.model.flattening import flattened
from ravenbrick.model.lazy import control
from ravenbrick.model.linearisation import (
    ErrorSource,
    fraction_of,
)
from ravenbrick.model.number_format import FixedFormat, Interval

__all__ = ["ClosedLoopBound", "PlantInLoop", "closed_loop_bound", "one_step_errors"]

_Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PlantInLoop:
    """A discrete plant around a diagram.

    `system` goes from the diagram's outports, in order, to `measured`, names of inports, at the
    diagram's sample time. The bound is for `observed_gain` times the first measured signal, in
    `unit`.
    """

    system: control.StateSpace
    measured: tuple[str, ...]
    observed_gain: float = 1.0
    unit: str = ""


@dataclass(frozen=True)
class ClosedLoopBound:
    """|error of the observed signal| <= `total` for all time, as long as no limit is reached.

    The error is the difference to the same loop as designed: in real numbers, with the gains
    wanted. Per source the peak gain from a rounding error (in the source's unit) to the observed
    signal, and its share; `coefficients` is the share of the gains as held, for inports in their
    declared ranges.
    """

    sources: tuple[ErrorSource, ...]
    peak_gains: tuple[float, ...]
    shares: tuple[float, ...]
    coefficients: float
    total: float
    unit: str

    @property
    def rounding(self) -> float:
        """The share of all roundings."""
        return sum(self.shares)

    def peak_gain(self, block: str, what: str) -> float:
        """The largest peak gain of the block's errors of this kind."""
        found = [
            gain
            for source, gain in zip(self.sources, self.peak_gains, strict=True)
            if (source.block, source.what) == (block, what)
        ]
        if not found:
            raise KeyError(f"block '{block}' has no rounding of kind '{what}'")
        return max(found)


def closed_loop_bound(fixed: FixedPoint, plant: PlantInLoop) -> ClosedLoopBound:
    """Worst-case peak gains of all rounding errors with the plant in the loop.

    The controller alone has none: its integrator is not stable. Hilaire and Lopez, Reliable
    implementation of linear filters with fixed-point arithmetic (SiPS 2013), use the same bound
    for filters.
    """
    deciding = sorted(_deciding_blocks(fixed.source))
    if deciding:
        raise DesignError(
            f"block '{deciding[0]}' decides or rounds: a rounding error before it may change what "
            "it does, so no bound in the loop is stated; leave out the plant"
        )
    _check_plant(fixed, plant)
    forms = PhysicalForms.of(fixed)
    names = [slot.name for slot in fixed.program.inputs]
    measured = [names.index(name) for name in plant.measured]
    held, ideal = (_closed(form, measured, plant) for form in (forms.held, forms.ideal))
    closed = replace(forms, held=held, ideal=ideal, held_start=_resting(forms.held_start, plant),
                     ideal_start=_resting(forms.ideal_start, plant))  # fmt: skip
    gains = peak_gain(closed.errors())[0]
    shares = gains * error_sizes(forms.sources)
    sizes = input_sizes(fixed)
    for index in measured:
        sizes[index] = 0.0
    moved = peak_gain(closed.difference())[0] @ np.array([*sizes, 1.0, 1.0])
    return ClosedLoopBound(
        forms.sources,
        tuple(map(float, gains)),
        tuple(map(float, shares)),
        float(moved),
        float(shares.sum() + moved),
        plant.unit,
    )


def _resting(start: _Array, plant: PlantInLoop) -> _Array:
    return np.concatenate([np.zeros(plant.system.nstates), start])


def _closed(controller: LinearSystem, measured: list[int], plant: PlantInLoop) -> LinearSystem:
    """The loop from all inputs of the controller to the observed signal, plant states first."""
    system = plant.system
    b_measured, d_measured = controller.B[:, measured], controller.D[:, measured]
    matrix = np.block(
        [
            [system.A + system.B @ d_measured @ system.C, system.B @ controller.C],
            [b_measured @ system.C, controller.A],
        ]
    )
    drive = np.vstack([system.B @ controller.D, controller.B])
    row = np.hstack([plant.observed_gain * system.C[:1], np.zeros((1, controller.nstates))])
    return LinearSystem(matrix, drive, row, np.zeros((1, drive.shape[1])), controller.dt)


def _check_plant(fixed: FixedPoint, plant: PlantInLoop) -> None:
    program, system = fixed.program, plant.system
    if system.dt != program.sample_time:
        raise DesignError(
            f"the plant has the sample time {system.dt}, the diagram {program.sample_time} s; "
            "discretise it with a zero-order hold"
        )
    if (system.ninputs, system.noutputs) != (len(program.outputs), len(plant.measured)):
        raise DesignError(
            f"the plant has {system.ninputs} inputs and {system.noutputs} outputs; the diagram has "
            f"{len(program.outputs)} outports and {len(plant.measured)} measured inports"
        )
    if np.any(system.D):
        raise DesignError("the plant passes its input on at once; the loop would be algebraic")
    known = [slot.name for slot in program.inputs]
    for name in plant.measured:
        if name not in known:
            raise DesignError(f"'{name}' is not an Inport; there are: {', '.join(known)}")


def one_step_errors(fixed: FixedPoint) -> dict[str, float]:
    """Bounds by outport of |fixed-point - real-number| output of one step from the same state.

    For inputs and states in their declared ranges; rounded gains included. Limits do not let an
    error grow. An outport that depends on a block that decides or rounds (a switch, a table) is
    left out: there an error before the block may change what it does.
    """
    return _ErrorPass(fixed).outputs()


def _deciding_blocks(source: ir.Program) -> set[str]:
    """Blocks whose output is not a linear function of what they read, limits aside."""
    found = set()
    for statement in ir.statements(flattened(source).statements):
        deciding = ir.Select | ir.Rounded | ir.Table
        if any(isinstance(node, deciding) for node in ir.nodes(statement.expression)):
            found.add(statement.block)
    return found


class _ErrorPass:
    """Intervals of the real values and bounds of the errors, statement by statement."""

    def __init__(self, fixed: FixedPoint) -> None:
        self._fixed = fixed
        self._block = ""
        self._errors: dict[tuple[ir.Kind, str], float] = {}
        self._deciding = _deciding_blocks(fixed.source)
        self._open: set[tuple[ir.Kind, str]] = set()
        real = {slot.name: slot.initial for slot in fixed.source.parameters}
        for slot in fixed.program.parameters:
            assert isinstance(slot.data_type, FixedFormat)
            error = abs(slot.data_type.real(int(slot.initial)) - real[slot.name])
            self._errors[slot.kind, slot.name] = error

    def outputs(self) -> dict[str, float]:
        """Bounds by outport."""
        for statement in ir.statements(flattened(self._fixed.program).statements):
            self._block, target = statement.block, statement.target
            if statement.block in self._deciding or self._depends(statement.expression):
                self._open.add((target.kind, target.name))
            elif target.kind is not ir.Kind.STATE:
                self._errors[target.kind, target.name] = self._bound(statement.expression)[1]
        return {
            slot.name: self._errors[slot.kind, slot.name]
            for slot in self._fixed.program.outputs
            if (slot.kind, slot.name) not in self._open
        }

    def _depends(self, expression: ir.Expression) -> bool:
        """Whether an expression reads what has no bound."""
        if isinstance(expression, ir.Read):
            return (expression.slot.kind, expression.slot.name) in self._open
        return any(self._depends(inner) for inner in ir.children(expression))

    def _bound(self, expression: ir.Expression) -> tuple[Interval, float]:
        match expression:
            case ir.Read(slot=slot):
                return self._variable(slot)
            case ir.Literal(value=value, data_type=form):
                assert isinstance(form, FixedFormat)
                own = form.real(int(value))
                real = self._fixed.constants.get((self._block, expression), own)
                return Interval(real, real), abs(own - real)
            case ir.Binary(operator="*", left=left, right=right):
                (first, e), (second, f) = self._bound(left), self._bound(right)
                return first * second, first.size * f + second.size * e + e * f
            case ir.Binary(operator=operator, left=left, right=right):
                (first, e), (second, f) = self._bound(left), self._bound(right)
                return (first + second if operator == "+" else first - second), e + f
            case ir.Rescale(value=inner, rounding=rounding):
                interval, error = self._bound(inner)
                return interval, error + rounding.largest_error * _lsb(expression)
            case ir.Clamp(value=inner, limit=limit):
                (interval, e), (bound, f) = self._bound(inner), self._bound(limit)
                return interval.limited(-bound.size, bound.size), max(e, f)
            case _:
                return self._bound(ir.children(expression)[0])

    def _variable(self, slot: ir.Slot) -> tuple[Interval, float]:
        key = slot.kind, slot.name
        return self._fixed.ranges[key], self._errors.get(key, 0.0)


def _lsb(expression: ir.Rescale) -> float:
    return float(2.0 ** -fraction_of(expression))
