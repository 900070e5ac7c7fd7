# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""State machine, hold at a slower rate, and functions written by the user."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass, field

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Block, Inputs, Value

__all__ = ["CustomFunction", "MachineState", "StateMachine", "Transition", "ZeroOrderHold"]

_LONGEST_WAIT = 1 << 22
_OPERATORS = ("<", "<=", ">", ">=")
_PARAMETER = re.compile(r"[a-z][a-z0-9_]*[a-z0-9]\Z|[a-z]\Z")


@dataclass(frozen=True)
class ZeroOrderHold(Block):
    """The input as it was at the last sample of the block's own, slower rate."""

    def output(self, inputs: Inputs) -> ir.Expression:
        """The input; the diagram holds it."""
        return inputs[0]


@dataclass(frozen=True)
class CustomFunction(Block):
    """A function of the inputs, given three times: in Python, in C and, if wanted, in Ada.

    `function` takes as many numbers as the block has inputs, of the block's numpy type, and gives
    one; its parameters' names are those of the C. `c` and `ada` are the bodies of the same
    function, such as `return a * b;`. Nothing checks them against each other but the comparison of
    simulation and code (`random_vectors`, `check_program`). State belongs into delays around it.
    """

    function: Callable[..., float] = field(default=float, repr=False, compare=False)
    c: str = ""
    ada: str = ""

    def __post_init__(self) -> None:
        if not self.c.strip():
            raise ValueError(f"block '{self.name}': give its function's body in C as `c`")
        for name in self.parameters:
            if not _PARAMETER.match(name):
                raise ValueError(
                    f"block '{self.name}': parameter '{name}' must be lower-case letters and digits"
                )

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the function's parameters, one per input port."""
        return tuple(inspect.signature(self.function).parameters)

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """One port per parameter."""
        return (self.data_type,) * len(self.parameters)

    def output(self, inputs: Inputs) -> ir.Expression:
        """One call."""
        return ir.Call(
            f"{self.name}_twin",
            self.parameters,
            tuple(inputs),
            self.data_type,
            self.c,
            self.ada,
            self.function,
        )


@dataclass(frozen=True)
class MachineState:
    """A state of a state machine with the output in it."""

    name: str
    output: Value = 0.0


@dataclass(frozen=True)
class Transition:
    """From `source` to `target` when input `port` `operator` `threshold` holds.

    Not before `after` steps in the source; with `port` None as soon as they have passed.
    """

    source: str
    target: str
    port: int | None = 0
    operator: str = ">="
    threshold: Value = 0.5
    after: int = 0


@dataclass(frozen=True)
class StateMachine(Block):
    """One transition per step at most: the first that holds, in the given order.

    The output is that of the state after the transition. `machine_states` begin with the initial
    one; `ports` is the number of inputs.
    """

    machine_states: tuple[MachineState, ...] = ()
    transitions: tuple[Transition, ...] = ()
    ports: int = 1

    def __post_init__(self) -> None:
        names = [state.name for state in self.machine_states]
        if len(names) < 2 or len(set(names)) != len(names):
            raise ValueError(
                f"block '{self.name}': a state machine has at least two states with different "
                f"names, not {names}"
            )
        for move in self.transitions:
            self._check(move, names)

    def _check(self, move: Transition, names: list[str]) -> None:
        for end in (move.source, move.target):
            if end not in names:
                raise ValueError(
                    f"block '{self.name}': a transition names the state '{end}'; "
                    f"there are: {', '.join(names)}"
                )
        if move.operator not in _OPERATORS:
            raise ValueError(
                f"block '{self.name}': operator '{move.operator}' must be one of "
                f"{' '.join(_OPERATORS)}"
            )
        if move.port is not None and not 0 <= move.port < self.ports:
            raise ValueError(f"block '{self.name}': there is no input {move.port}")
        if not 0 <= move.after <= _LONGEST_WAIT:
            raise ValueError(
                f"block '{self.name}': `after` must lie between 0 and {_LONGEST_WAIT} steps"
            )
        if move.port is None and move.after == 0:
            raise ValueError(
                f"block '{self.name}': the transition to '{move.target}' has neither a condition "
                "nor a time"
            )

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """As many ports as the transitions look at."""
        return (self.data_type,) * self.ports

    def values(self) -> tuple[Value, ...]:
        """Outputs and thresholds."""
        return (
            *(state.output for state in self.machine_states),
            *(move.threshold for move in self.transitions),
        )

    def states(self) -> tuple[ir.Slot, ...]:
        """Number of the state, steps spent in it."""
        return self._state("DSTATE", 0.0), self._state("SINCE", 0.0)

    def intermediates(self, inputs: Inputs) -> Assignments:
        """For each state where it leads to, then the next state."""
        found: list[tuple[ir.Slot, ir.Expression]] = []
        for index, state in enumerate(self.machine_states):
            follow: ir.Expression = self._literal(float(index))
            moves = [move for move in self.transitions if move.source == state.name]
            for move in reversed(moves):
                kept = self._local(f"from{index}_{len(found)}")
                found.append((kept, follow))
                follow = self._move(move, inputs, ir.Read(kept))
            found.append((self._local(f"from{index}"), follow))
        last = len(self.machine_states) - 1
        chosen: ir.Expression = ir.Read(self._local(f"from{last}"))
        for index in range(last - 1, -1, -1):
            chosen = self._by_number(index, ir.Read(self._local(f"from{index}")), chosen)
        found.append((self._local("next"), chosen))
        return tuple(found)

    def _by_number(self, index: int, own: ir.Expression, others: ir.Expression) -> ir.Select:
        """`own` in the states up to `index`, counted by the stored number."""
        below = ir.Comparison("<", ir.Read(self.states()[0]), self._literal(index + 0.5))
        return ir.Select(below, own, others)

    def _move(self, move: Transition, inputs: Inputs, otherwise: ir.Expression) -> ir.Expression:
        names = [state.name for state in self.machine_states]
        target: ir.Expression = self._literal(float(names.index(move.target)))
        if move.port is not None:
            wanted = ir.Comparison(move.operator, inputs[move.port], self._value(move.threshold))
            target = ir.Select(wanted, target, otherwise)
        if move.after:
            waited = ir.Comparison(
                ">=", ir.Read(self.states()[1]), self._literal(float(move.after))
            )
            target = ir.Select(waited, target, otherwise)
        return target

    def output(self, inputs: Inputs) -> ir.Expression:
        """The output of the next state."""
        chosen = self._value(self.machine_states[-1].output)
        for index in range(len(self.machine_states) - 2, -1, -1):
            below = ir.Comparison("<", ir.Read(self._local("next")), self._literal(index + 0.5))
            chosen = ir.Select(below, self._value(self.machine_states[index].output), chosen)
        return chosen

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """The time begins anew with each transition."""
        number, since = self.states()
        following = ir.Read(self._local("next"))
        most = self._literal(float(_LONGEST_WAIT))
        one = ir.Binary("+", ir.Read(since), self._literal(1.0))
        counted = ir.Select(ir.Comparison(">=", ir.Read(since), most), most, one)
        moved = ir.Binary("-", following, ir.Read(number))
        start, half = self._literal(1.0), self._literal(0.5)
        down = ir.Select(ir.Comparison("<", moved, self._literal(-0.5)), start, counted)
        spent = ir.Select(ir.Comparison(">", moved, half), start, down)
        return ((since, spent), (number, following))
