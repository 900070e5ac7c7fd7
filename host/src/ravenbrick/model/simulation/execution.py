# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Executing a program bit for bit in its number formats."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np

from ravenbrick.model import program as ir
from ravenbrick.model.diagram import Diagram
from ravenbrick.model.simulation.python_text import Memory, PythonText

__all__ = ["Execution"]


class Execution:
    """One instance of a diagram: its parameters and states, in the diagram's number formats.

    Every operation is a numpy scalar operation, rounded as IEEE 754 says, so the results have the
    same bits as those of the generated C on a machine with IEEE arithmetic. A fixed-point program
    takes and gives raw integers; a value beyond the accumulator raises `OverflowError`, because its
    formats promise that there is none.
    """

    def __init__(self, diagram: Diagram | ir.Program) -> None:
        self.program = diagram.lower() if isinstance(diagram, Diagram) else diagram
        program = self.program
        kept = (*program.states, *program.parameters, *_conditional(program))
        text = PythonText(kept, np.float64)
        text.instructions(program.statements)
        computed = {one.target for one in ir.statements(program.statements)}
        self._shown = (*program.outputs, *(one for one in program.signals if one in computed))
        shown = [text.name(slot) for slot in self._shown]
        self._run = text.function(program.inputs, shown, repeats=True)
        self._places = {(slot.kind, slot.name): place for place, slot in enumerate(kept)}
        self._memory: Memory = [slot.data_type.scalar(slot.initial) for slot in kept]
        self._newer: dict[int, deque[Any]] = {}
        self.reset()

    def reset(self) -> None:
        """Give the states their initial values; parameters keep theirs."""
        for slot in self.program.states:
            self._fill(slot, slot.initial)

    def _fill(self, slot: ir.Slot, value: float) -> None:
        """Give a state a value, a delay line in all its samples."""
        place = self._places[slot.kind, slot.name]
        self._memory[place] = slot.data_type.scalar(value)
        if isinstance(slot, ir.DelayLine):
            self._newer[place] = deque([slot.data_type.scalar(value)] * (slot.length - 1))

    def set_parameter(self, name: str, value: float) -> None:
        """Change a parameter from the next step on; raises `KeyError` for an unknown name."""
        self._fill(_named(self.program.parameters, "parameter", name), value)

    def set_state(self, name: str, value: float) -> None:
        """Change a state before the next step; raises `KeyError` for an unknown name."""
        self._fill(_named(self.program.states, "state", name), value)

    @property
    def states(self) -> dict[str, Any]:
        """Present values of the states by name; of a delay line the oldest sample."""
        places = ((slot.name, self._places[slot.kind, slot.name]) for slot in self.program.states)
        return {name: self._memory[place] for name, place in places}

    def step(self, inputs: Mapping[str, float]) -> dict[str, Any]:
        """One sample: inputs by port name, outputs by port name."""
        found = self.sample([inputs[slot.name] for slot in self.program.inputs])
        return {slot.name: value for slot, value in zip(self.program.outputs, found, strict=False)}

    @property
    def shown(self) -> tuple[ir.Slot, ...]:
        """The variables of which `sample` gives the values: the outputs, then all signals."""
        return self._shown

    def sample(self, inputs: list[float]) -> tuple[Any, ...]:
        """One sample: inputs in the program's order, the values of `shown`.

        A signal that is not computed in this step keeps its value.
        """
        return self.samples(inputs, 1)[0]

    def samples(self, inputs: list[float], steps: int) -> list[tuple[Any, ...]]:
        """What `sample` gives in each of several steps, in which the inputs stay."""
        slots = self.program.inputs
        given = [s.data_type.scalar(value) for s, value in zip(slots, inputs, strict=True)]
        with np.errstate(all="ignore"):
            found: list[tuple[Any, ...]] = self._run(self._memory, given, self._newer, steps)
        return found


def _conditional(program: ir.Program) -> list[ir.Slot]:
    """Signals and outputs that not every step assigns, each once."""
    branches = (one for one in program.statements if isinstance(one, ir.If | ir.Case))
    found = (statement.target for statement in ir.statements(branches))
    return list(dict.fromkeys(slot for slot in found if slot.kind is not ir.Kind.STATE))


def _named(slots: tuple[ir.Slot, ...], kind: str, name: str) -> ir.Slot:
    for slot in slots:
        if slot.name == name:
            return slot
    known = ", ".join(slot.name for slot in slots)
    raise KeyError(f"no {kind} '{name}'; there are: {known}")
