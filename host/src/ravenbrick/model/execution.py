# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Executing a program bit for bit in its number formats."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ravenbrick.model import program as ir
from ravenbrick.model.diagram import Diagram

__all__ = ["Execution", "evaluate", "holds"]

_Key = tuple[ir.Kind, str]


def _key(slot: ir.Slot) -> _Key:
    return slot.kind, slot.name


class Execution:
    """One instance of a diagram: its parameters and states, in the diagram's number formats.

    Every operation is a numpy scalar operation, rounded as IEEE 754 says, so the results have the
    same bits as those of the generated C on a machine with IEEE arithmetic. A fixed-point program
    takes and gives raw integers; a value beyond the accumulator raises `OverflowError`, because its
    formats promise that there is none.
    """

    def __init__(self, diagram: Diagram | ir.Program) -> None:
        self.program = diagram.lower() if isinstance(diagram, Diagram) else diagram
        self._values: dict[_Key, Any] = {}
        self._newer: dict[_Key, deque[Any]] = {}
        for slot in self.program.parameters:
            self._values[_key(slot)] = slot.data_type.scalar(slot.initial)
        self.reset()

    def reset(self) -> None:
        """Give the states their initial values; parameters keep theirs."""
        for slot in self.program.states:
            self._fill(slot, slot.initial)

    def _fill(self, slot: ir.Slot, value: float) -> None:
        """Give a state a value, a delay line in all its samples."""
        self._values[_key(slot)] = slot.data_type.scalar(value)
        if isinstance(slot, ir.DelayLine):
            self._newer[_key(slot)] = deque([slot.data_type.scalar(value)] * (slot.length - 1))

    def set_parameter(self, name: str, value: float) -> None:
        """Change a parameter from the next step on; raises `KeyError` for an unknown name."""
        slot = next((slot for slot in self.program.parameters if slot.name == name), None)
        if slot is None:
            known = ", ".join(slot.name for slot in self.program.parameters)
            raise KeyError(f"no parameter '{name}'; there are: {known}")
        self._values[_key(slot)] = slot.data_type.scalar(value)

    def set_state(self, name: str, value: float) -> None:
        """Change a state before the next step; raises `KeyError` for an unknown name."""
        slot = next((slot for slot in self.program.states if slot.name == name), None)
        if slot is None:
            known = ", ".join(slot.name for slot in self.program.states)
            raise KeyError(f"no state '{name}'; there are: {known}")
        self._fill(slot, value)

    @property
    def states(self) -> dict[str, Any]:
        """Present values of the states by name; of a delay line the oldest sample."""
        return {slot.name: self._values[_key(slot)] for slot in self.program.states}

    def step(self, inputs: Mapping[str, float]) -> dict[str, Any]:
        """One sample: inputs by port name, outputs by port name."""
        values = self._values
        for slot in self.program.inputs:
            values[_key(slot)] = slot.data_type.scalar(inputs[slot.name])
        with np.errstate(all="ignore"):
            self._execute(self.program.statements)
        return {slot.name: values[_key(slot)] for slot in self.program.outputs}

    def _execute(self, instructions: Iterable[ir.Instruction]) -> None:
        values = self._values
        for one in instructions:
            match one:
                case ir.Statement(target=target, expression=expression):
                    value = evaluate(expression, values)
                    if isinstance(target, ir.DelayLine):
                        newer = self._newer[_key(target)]
                        newer.append(value)
                        value = newer.popleft()
                    values[_key(target)] = value
                case ir.If(conditions=conditions, body=body, otherwise=otherwise):
                    met = all(holds(condition, values) for condition in conditions)
                    self._execute(body if met else otherwise)
                case ir.Case(selector=selector, branches=branches):
                    self._execute(branches[values[_key(selector)]])
                case ir.Restart(states=states):
                    for slot in states:
                        self._fill(slot, slot.initial)


def evaluate(expression: ir.Expression, values: Mapping[_Key, Any]) -> Any:
    """The value of an expression; `values` are the variables by kind and name."""
    match expression:
        case ir.Read(slot=slot):
            return values[slot.kind, slot.name]
        case ir.Literal(value=value, data_type=data_type):
            return data_type.scalar(value)
        case ir.Binary(operator=operator, left=left, right=right):
            result = _operate(operator, evaluate(left, values), evaluate(right, values))
            if isinstance(result, int) and not -(2**31) <= result < 2**31:
                _check_size(expression, result)
            return result
        case ir.Select(condition=condition, chosen=chosen, otherwise=otherwise):
            return evaluate(chosen if holds(condition, values) else otherwise, values)
        case ir.Clamp(value=inner, limit=limit):
            number, bound = evaluate(inner, values), evaluate(limit, values)
            if number > bound:
                return bound
            return -bound if number < -bound else number
        case ir.Cast(value=inner, data_type=data_type):
            return data_type.scalar(evaluate(inner, values))
        case ir.Call(arguments=arguments, data_type=data_type, function=function):
            return data_type.scalar(function(*(evaluate(a, values) for a in arguments)))
        case ir.Rounded(value=inner):
            return _nearest(evaluate(inner, values))
        case ir.Table(value=inner):
            return _look_up(expression, evaluate(inner, values))
        case ir.Rescale(value=inner, bits=bits, rounding=rounding):
            return rounding.divide(evaluate(inner, values), bits)
        case ir.Bounded(value=inner, low=low, high=high):
            return min(max(evaluate(inner, values), low), high)


def _operate(operator: str, first: Any, second: Any) -> Any:
    if operator == "*":
        return first * second
    return first + second if operator == "+" else first - second


def _check_size(expression: ir.Binary, result: int) -> None:
    bits = 64 if ir.is_wide(expression) else 32
    if not -(2 ** (bits - 1)) <= result < 2 ** (bits - 1):
        raise OverflowError(f"{result} ({expression.operator}) does not fit into {bits} bits")


def holds(condition: ir.Comparison, values: Mapping[_Key, Any]) -> bool:
    """Whether a condition holds; `values` as in `evaluate`."""
    left, right = evaluate(condition.left, values), evaluate(condition.right, values)
    match condition.operator:
        case "<":
            return bool(left < right)
        case "<=":
            return bool(left <= right)
        case ">":
            return bool(left > right)
        case _:
            return bool(left >= right)


def _nearest(value: Any) -> Any:
    """Nearest whole number, halves away from zero; as the C does it, by a cut and a test."""
    kind = type(value)
    if not abs(value) < 2 ** (23 if kind is np.float32 else 52):
        return value
    whole = kind(int(value))
    rest = value - whole
    if rest >= kind(0.5):
        return whole + kind(1.0)
    return whole - kind(1.0) if rest <= kind(-0.5) else whole


def _look_up(table: ir.Table, value: Any) -> Any:
    data_type = ir.expression_type(table)
    index = 0
    while index + 1 < len(table.breakpoints) and value >= data_type.scalar(
        table.breakpoints[index + 1]
    ):
        index += 1
    slope = data_type.scalar(table.slopes[index])
    rise = slope * (value - data_type.scalar(table.breakpoints[index]))
    return data_type.scalar(table.values[index]) + rise
