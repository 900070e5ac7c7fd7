# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The linear system behind a program: affine forms run through its own statements."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ravenbrick.model import program as ir
from ravenbrick.model.diagram import Diagram, DiagramError
from ravenbrick.model.flattening import flattened, with_shifts
from ravenbrick.model.lazy import control
from ravenbrick.model.linear_system import LinearSystem
from ravenbrick.model.number_format import FixedFormat

__all__ = [
    "ErrorSource",
    "fraction_of",
    "linear_system",
    "linearise",
    "linearise_with_errors",
    "lsb_of",
]

_Vector = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ErrorSource:
    """Where a rounding error enters: `block`, and what is rounded there.

    `size` bounds the error in raw units of the rounded value; 0 for a state, whose update is
    exact and whose entry only tells what rounding it would cost. `active` is whether the rounded
    value is anything but 0 as long as no limit is reached: 0 is rounded without error. `lsb` is
    what one raw unit stands for.
    """

    block: str
    what: str
    lsb: float
    size: float
    active: bool


def linearise(diagram: Diagram | ir.Program) -> control.StateSpace:
    """The linear system that the diagram is as long as no limit is reached.

    States (a delay line's samples each, the newest first), inputs and outputs in the program's
    order; those of a fixed-point program in raw units,
    without rounding. Raises `DiagramError` for a product of two signals and for blocks that are
    not linear. Exact: affine forms run through the program's own statements.
    """
    return linear_system(diagram).for_control()


def linear_system(diagram: Diagram | ir.Program, *, constants: bool = False) -> LinearSystem:
    """The matrices of `linearise`; with `constants` one more input, always 1, adds offsets."""
    program = diagram.lower() if isinstance(diagram, Diagram) else diagram
    return _Linearisation(flattened(with_shifts(program)), 0).system(constants=constants)


def linearise_with_errors(
    program: ir.Program, *, constants: bool = False
) -> tuple[control.StateSpace, tuple[ErrorSource, ...]]:
    """The linear system of a fixed-point program with one more input per source of rounding.

    Inputs are the program's, then one per rounding in order of execution, then one per state, then
    with `constants` the 1 that adds offsets.
    """
    program = flattened(with_shifts(program))
    roundings = [
        (statement.block, _kind(statement), math.ldexp(1.0, -fraction_of(node)), node.rounding)
        for statement in ir.statements(program.statements)
        for node in _rescales(statement.expression)
    ]
    lines = _Linearisation(program, len(roundings) + len(program.states))
    system = lines.system(constants=constants)
    sources = [
        ErrorSource(block, what, lsb, rounding.largest_error, active)
        for (block, what, lsb, rounding), active in zip(roundings, lines.active, strict=True)
    ]
    sources += [ErrorSource(s.block, "state", lsb_of(s), 0.0, True) for s in program.states]
    return system.for_control(), tuple(sources)


def lsb_of(slot: ir.Slot) -> float:
    """What one raw unit of a fixed-point variable stands for."""
    assert isinstance(slot.data_type, FixedFormat)
    return slot.data_type.lsb


def fraction_of(expression: ir.Expression) -> int:
    """Fractional bits of a fixed-point expression."""
    match expression:
        case ir.Read(slot=ir.Slot(data_type=FixedFormat(fraction=fraction))):
            return fraction
        case ir.Literal(data_type=FixedFormat(fraction=fraction)):
            return fraction
        case ir.Binary(operator="*", left=left, right=right):
            return fraction_of(left) + fraction_of(right)
        case ir.Rescale(value=value, bits=bits):
            return fraction_of(value) - bits
        case ir.Select(chosen=chosen):
            return fraction_of(chosen)
        case _ if ir.children(expression):
            return fraction_of(ir.children(expression)[0])
    raise DiagramError("the expression is not in fixed point")


def _kind(statement: ir.Statement) -> str:
    return "update" if statement.target.kind is ir.Kind.STATE else statement.target.kind.value


def _rescales(expression: ir.Expression) -> list[ir.Rescale]:
    """In the order in which `_Linearisation` meets them."""
    inner = [node for child in ir.children(expression) for node in _rescales(child)]
    return [*inner, expression] if isinstance(expression, ir.Rescale) else inner


class _Linearisation:
    """One pass of affine forms: columns are states, inputs, error inputs and the constant 1."""

    def __init__(self, program: ir.Program, error_inputs: int) -> None:
        self._program = program
        self._variables = (*program.states, *program.inputs)
        self._first_error = len(self._variables)
        self._errors = error_inputs
        self._width = self._first_error + error_inputs + 1
        self._values: dict[tuple[ir.Kind, str], _Vector] = {}
        self.active: list[bool] = []

    def _unit(self, column: int) -> _Vector:
        vector = np.zeros(self._width)
        vector[column] = 1.0
        return vector

    def system(self, *, constants: bool = False) -> LinearSystem:
        """Run the statements and read the matrices off."""
        last = None if constants else -1
        program, values = self._program, self._values
        for column, slot in enumerate(self._variables):
            values[slot.kind, slot.name] = self._unit(column)
        for slot in program.parameters:
            values[slot.kind, slot.name] = slot.initial * self._unit(-1)
        for statement in ir.statements(program.statements):
            try:
                form = self._form(statement.expression)
            except DiagramError as error:
                raise DiagramError(f"block '{statement.block}': {error}") from error
            values[statement.target.kind, statement.target.name] = form
        if self._errors:
            self._mark_states()
        order = len(program.states)
        rows = [values[slot.kind, slot.name] for slot in program.states]
        states = np.array(rows).reshape(order, self._width)
        outputs = np.array([values[slot.kind, slot.name] for slot in program.outputs])
        return LinearSystem(
            states[:, :order],
            states[:, order:last],
            outputs[:, :order],
            outputs[:, order:last],
            program.sample_time,
        )

    def _mark_states(self) -> None:
        first = self._first_error + self._errors - len(self._program.states)
        for index, slot in enumerate(self._program.states):
            key = slot.kind, slot.name
            self._values[key] = self._values[key] + self._unit(first + index)

    def _form(self, expression: ir.Expression) -> _Vector:
        match expression:
            case ir.Read(slot=slot):
                return self._values[slot.kind, slot.name]
            case ir.Literal(value=value):
                return np.asarray(value * self._unit(-1))
            case ir.Binary(operator="*", left=left, right=right):
                return self._product(self._form(left), self._form(right))
            case ir.Binary(operator=operator, left=left, right=right):
                sign = 1.0 if operator == "+" else -1.0
                return self._form(left) + sign * self._form(right)
            case ir.Clamp(value=inner) | ir.Cast(value=inner) | ir.Bounded(value=inner):
                return self._form(inner)
            case ir.Rescale(value=inner, bits=bits):
                return self._rounded(self._form(inner) / 2.0**bits)
            case _:
                raise DiagramError(f"a {type(expression).__name__.lower()} is not linear")

    def _product(self, first: _Vector, second: _Vector) -> _Vector:
        if first[:-1].any() and second[:-1].any():
            raise DiagramError("a product of two signals is not linear")
        constant, other = (second, first) if first[:-1].any() else (first, second)
        return np.asarray(constant[-1] * other)

    def _rounded(self, form: _Vector) -> _Vector:
        if not self._errors:
            return form
        self.active.append(bool(form.any()))
        if not self.active[-1]:
            return form
        return form + self._unit(self._first_error + len(self.active) - 1)
