# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Executing a program: bit for bit in its number formats, or with affine forms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import control
import numpy as np
import numpy.typing as npt

from ravenbrick.model.diagram import Diagram, DiagramError
from ravenbrick.model.program import (
    Binary,
    Cast,
    Clamp,
    Expression,
    Kind,
    Literal,
    Program,
    Read,
    Slot,
)

__all__ = ["Execution", "linearise"]

_Key = tuple[Kind, str]


def _key(slot: Slot) -> _Key:
    return slot.kind, slot.name


class Execution:
    """One instance of a diagram: its parameters and states, in the diagram's number formats.

    Every operation is a numpy scalar operation, rounded as IEEE 754 says, so the results have the
    same bits as those of the generated C on a machine with IEEE arithmetic.
    """

    def __init__(self, diagram: Diagram | Program) -> None:
        self.program = diagram.lower() if isinstance(diagram, Diagram) else diagram
        self._values: dict[_Key, Any] = {}
        for slot in self.program.parameters:
            self._values[_key(slot)] = slot.data_type.scalar(slot.initial)
        self.reset()

    def reset(self) -> None:
        """Give the states their initial values; parameters keep theirs."""
        for slot in self.program.states:
            self._values[_key(slot)] = slot.data_type.scalar(slot.initial)

    def set_parameter(self, name: str, value: float) -> None:
        """Change a parameter from the next step on; raises `KeyError` for an unknown name."""
        slot = next((slot for slot in self.program.parameters if slot.name == name), None)
        if slot is None:
            known = ", ".join(slot.name for slot in self.program.parameters)
            raise KeyError(f"no parameter '{name}'; there are: {known}")
        self._values[_key(slot)] = slot.data_type.scalar(value)

    @property
    def states(self) -> dict[str, Any]:
        """Present values of the states by name."""
        return {slot.name: self._values[_key(slot)] for slot in self.program.states}

    def step(self, inputs: Mapping[str, float]) -> dict[str, Any]:
        """One sample: inputs by port name, outputs by port name."""
        values = self._values
        for slot in self.program.inputs:
            values[_key(slot)] = slot.data_type.scalar(inputs[slot.name])
        with np.errstate(all="ignore"):
            for statement in self.program.statements:
                values[_key(statement.target)] = _evaluate(statement.expression, values)
        return {slot.name: values[_key(slot)] for slot in self.program.outputs}


def _evaluate(expression: Expression, values: Mapping[_Key, Any]) -> Any:
    match expression:
        case Read(slot=slot):
            return values[slot.kind, slot.name]
        case Literal(value=value, data_type=data_type):
            return data_type.scalar(value)
        case Binary(operator=operator, left=left, right=right):
            first, second = _evaluate(left, values), _evaluate(right, values)
            if operator == "+":
                return first + second
            return first - second if operator == "-" else first * second
        case Clamp(value=inner, limit=limit):
            number, bound = _evaluate(inner, values), _evaluate(limit, values)
            if number > bound:
                return bound
            return -bound if number < -bound else number
        case Cast(value=inner, data_type=data_type):
            return data_type.scalar(_evaluate(inner, values))


_Vector = npt.NDArray[np.float64]


def linearise(diagram: Diagram | Program) -> control.StateSpace:
    """The linear system that the diagram is as long as no limit is reached.

    States, inputs and outputs in the program's order. Raises `DiagramError` for a product of two
    signals. Exact: affine forms run through the program's own statements.
    """
    program = diagram.lower() if isinstance(diagram, Diagram) else diagram
    variables = (*program.states, *program.inputs)
    width = len(variables) + 1
    values: dict[_Key, _Vector] = {}
    for index, slot in enumerate(variables):
        values[_key(slot)] = np.eye(width)[index]
    for slot in program.parameters:
        values[_key(slot)] = slot.initial * np.eye(width)[-1]
    for statement in program.statements:
        values[_key(statement.target)] = _affine(statement.expression, values, width)
    order = len(program.states)
    states = np.array([values[_key(slot)] for slot in program.states]).reshape(order, width)
    outputs = np.array([values[_key(slot)] for slot in program.outputs])
    return control.ss(
        states[:, :order],
        states[:, order:-1],
        outputs[:, :order],
        outputs[:, order:-1],
        program.sample_time,
    )


def _affine(expression: Expression, values: Mapping[_Key, _Vector], width: int) -> _Vector:
    match expression:
        case Read(slot=slot):
            return values[slot.kind, slot.name]
        case Literal(value=value):
            return np.asarray(value * np.eye(width)[-1])
        case Binary(operator="*", left=left, right=right):
            first, second = _affine(left, values, width), _affine(right, values, width)
            if first[:-1].any() and second[:-1].any():
                raise DiagramError("a product of two signals is not linear")
            constant, other = (second, first) if first[:-1].any() else (first, second)
            return np.asarray(constant[-1] * other)
        case Binary(operator=operator, left=left, right=right):
            sign = 1.0 if operator == "+" else -1.0
            return _affine(left, values, width) + sign * _affine(right, values, width)
        case Clamp(value=inner) | Cast(value=inner):
            return _affine(inner, values, width)
