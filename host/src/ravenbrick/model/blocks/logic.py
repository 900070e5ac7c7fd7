# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""State machine, hold at a slower rate, and functions written by the user."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Block, Inputs, Value, choose
from ravenbrick.model.number_format import Enumeration, FixedFormat

__all__ = ["CustomFunction", "MachineState", "StateMachine", "Transition", "ZeroOrderHold"]

_LONGEST_WAIT = 1 << 22
_COUNT = FixedFormat(32, 0)
_OPERATORS = ("<", "<=", ">", ">=")
_PARAMETER = re.compile(r"[a-z][a-z0-9_]*[a-z0-9]\Z|[a-z]\Z")

_STATE_NAME = re.compile(r"[A-Za-z](_?[A-Za-z0-9])*\Z")


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
    simulation and code (`random_vectors`, `check_program`). State belongs in delays around it.
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
        for name in names:
            if not _STATE_NAME.match(name):
                raise ValueError(
                    f"block '{self.name}': the state's name '{name}' must be an identifier"
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

    @property
    def _timed_moves(self) -> bool:
        return any(move.after for move in self.transitions)

    def _number(self) -> ir.Slot:
        members = tuple(f"{self.name}_{state.name}" for state in self.machine_states)
        form = Enumeration(f"{self.name}_State", members)
        return ir.Slot(ir.Kind.STATE, f"{self.name}_DSTATE", form, self.name)

    def _since(self) -> ir.Slot:
        return ir.Slot(ir.Kind.STATE, f"{self.name}_SINCE", _COUNT, self.name)

    def states(self) -> tuple[ir.Slot, ...]:
        """The state; the steps spent in it, if a transition waits."""
        return (self._number(), self._since()) if self._timed_moves else (self._number(),)

    def _following(self, state: ir.Slot, suffix: str) -> ir.Slot:
        """The value that a state variable gets at the end of the step."""
        return ir.Slot(ir.Kind.SIGNAL, f"{self.name}_{suffix}", state.data_type, self.name)

    def compute(
        self, inputs: Inputs, targets: Sequence[ir.Slot | None]
    ) -> tuple[ir.Instruction, ...]:
        """For each state the transitions in order, then what it is to stay."""
        target = targets[0]
        branches = []
        for place, state in enumerate(self.machine_states):
            found = self._arrived(place, place, target)
            for move in reversed(self.transitions):
                if move.source == state.name:
                    found = (self._move(move, place, inputs, target, found),)
            branches.append(found)
        kind = type(self).__name__
        return (ir.Case(self._number(), tuple(branches), self.name, kind),)

    def _arrived(
        self, place: int, source: int, target: ir.Slot | None
    ) -> tuple[ir.Instruction, ...]:
        """The values in the state at `place`, coming from `source`."""
        state = self._number()
        following = self._following(state, "next")
        found = [self._assign(following, ir.Literal(place, state.data_type))]
        if self._timed_moves:
            spent = self._following(self._since(), "spent")
            stays = place == source
            found.append(self._assign(spent, self._longer(place) if stays else _count_of(1)))
        if target is not None:
            value = self._value(self.machine_states[place].output)
            found.append(self._assign(target, value))
        return tuple(found)

    def _longer(self, place: int) -> ir.Expression:
        """The steps spent in a state after one more, as far as a transition counts them."""
        name = self.machine_states[place].name
        moves = [move for move in self.transitions if move.source == name]
        longest = max((move.after for move in moves), default=0)
        if longest <= 1:
            return _count_of(1)
        since = ir.Read(self._since())
        more = ir.Binary("+", since, _count_of(1))
        if any(move.port is None for move in moves):  # which ends the state before
            return more
        most = _count_of(longest)
        return choose(since, ">=", most, most, more)

    def _move(
        self,
        move: Transition,
        source: int,
        inputs: Inputs,
        target: ir.Slot | None,
        otherwise: tuple[ir.Instruction, ...],
    ) -> ir.If:
        names = [state.name for state in self.machine_states]
        tests = []
        if move.after:
            waited = _count_of(move.after)
            tests.append(ir.Comparison(">=", ir.Read(self._since()), waited))
        if move.port is not None:
            threshold = self._value(move.threshold)
            tests.append(ir.Comparison(move.operator, inputs[move.port], threshold))
        found = self._arrived(names.index(move.target), source, target)
        return ir.If(tuple(tests), found, otherwise, self.name, type(self).__name__)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """State and time follow."""
        suffixes = ("next", "spent")
        return tuple(
            (state, ir.Read(self._following(state, suffix)))
            for state, suffix in zip(self.states(), suffixes, strict=False)
        )


def _count_of(value: int) -> ir.Literal:
    return ir.Literal(value, _COUNT)
