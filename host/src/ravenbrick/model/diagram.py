# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A synchronous block diagram: blocks, lines, checks, and the lowering to a program."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Block, Inport, Outport, Parameter, parameter_slot
from ravenbrick.model.number_format import FixedFormat

__all__ = ["AlgebraicLoopError", "Diagram", "DiagramError"]

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")
_LONGEST_NAME = 31
_COUNT = FixedFormat(32, 0)
_AnyBlock = TypeVar("_AnyBlock", bound=Block)


class DiagramError(DesignError):
    """A diagram without a meaning: the sentence names the blocks."""


class AlgebraicLoopError(DiagramError):
    """Blocks whose outputs need each other in the same step; `loop` are their names in order."""

    def __init__(self, diagram: str, loop: Sequence[str]) -> None:
        super().__init__(
            f"diagram '{diagram}' has the algebraic loop {' -> '.join(loop)}; put a UnitDelay into "
            "it"
        )
        self.loop = tuple(loop)


@dataclass(frozen=True)
class _Enabled:
    """By which block, and whether states begin anew."""

    by: str
    reset: bool


class Diagram:
    """Blocks joined by lines, stepped every `sample_time` (s).

    A block with a sample time of its own, a whole multiple, runs at that slower rate: it samples
    its inputs in its turn, and its output is held in between.
    Names are identifiers of at most 31 characters; they appear in the generated C.
    """

    def __init__(self, name: str, sample_time: float) -> None:
        if not _IDENTIFIER.match(name):
            raise DiagramError(f"the diagram's name '{name}' must be an identifier")
        if not (math.isfinite(sample_time) and sample_time > 0):
            raise DiagramError(f"diagram '{name}': the sample time must be > 0 s")
        self.name = name
        self.sample_time = sample_time
        self._blocks: dict[str, Block] = {}
        self._sources: dict[tuple[str, int], str] = {}
        self._enabled: dict[str, _Enabled] = {}

    @property
    def blocks(self) -> tuple[Block, ...]:
        """All blocks in the order they were added."""
        return tuple(self._blocks.values())

    def add(self, block: _AnyBlock) -> _AnyBlock:
        """Put a block into the diagram and return it."""
        if not _IDENTIFIER.match(block.name) or len(block.name) > _LONGEST_NAME:
            raise DiagramError(
                f"block '{block.name}': the name must be an identifier of at most "
                f"{_LONGEST_NAME} characters"
            )
        taken = {name.lower(): name for name in self._blocks}
        if block.name.lower() in taken:
            raise DiagramError(
                f"block '{block.name}': the name '{taken[block.name.lower()]}' is taken; "
                "letter case does not tell names apart"
            )
        self._check_rate(block)
        self._blocks[block.name] = block
        return block

    def _check_rate(self, block: Block) -> None:
        if block.sample_time is None or block.sample_time == self.sample_time:
            return
        ratio = block.sample_time / self.sample_time
        if round(ratio) < 1 or not math.isclose(ratio, round(ratio), rel_tol=1e-9):
            raise DiagramError(
                f"block '{block.name}' has the sample time {block.sample_time} s, its diagram "
                f"'{self.name}' {self.sample_time} s; a slower rate is a whole multiple of it"
            )
        if isinstance(block, Inport | Outport):
            raise DiagramError(
                f"port '{block.name}' runs with its diagram '{self.name}', every "
                f"{self.sample_time} s; put a ZeroOrderHold behind it for a slower rate"
            )

    def divisor(self, block: Block) -> int:
        """The block runs in every `divisor`-th step, beginning with the first."""
        return 1 if block.sample_time is None else round(block.sample_time / self.sample_time)

    def connect(self, source: Block, target: Block, port: int = 0) -> None:
        """Draw a line from the output of `source` to input `port` (from 0) of `target`."""
        for block in (source, target):
            if self._blocks.get(block.name) is not block:
                raise DiagramError(f"block '{block.name}' is not in diagram '{self.name}'; add it")
        if source.output_type is None:
            raise DiagramError(f"block '{source.name}' has no output port to start a line at")
        if not 0 <= port < len(target.input_types):
            raise DiagramError(
                f"block '{target.name}' has {len(target.input_types)} input ports, "
                f"so there is no port {port}"
            )
        if (target.name, port) in self._sources:
            raise DiagramError(
                f"input {port} of block '{target.name}' is already connected to "
                f"'{self._sources[target.name, port]}'"
            )
        wanted = target.input_types[port]
        if source.output_type is not wanted:
            raise DiagramError(
                f"'{source.name}' gives {source.output_type.value}, but input {port} of "
                f"'{target.name}' takes {wanted.value}; put a Conversion between them"
            )
        self._sources[target.name, port] = source.name

    def connect_chain(self, *blocks: Block) -> None:
        """Draw lines through `blocks`, each into input 0 of the next."""
        for source, target in pairwise(blocks):
            self.connect(source, target)

    def enable(self, block: Block, by: Block, *, reset: bool = False) -> None:
        """Let the states of `block` change only in steps in which the output of `by` is 1, not 0.

        With `reset` they begin anew whenever that output becomes 1. The output of `block` is not
        held: what leaves the enabled part goes through a Merge.
        """
        for one in (block, by):
            if self._blocks.get(one.name) is not one:
                raise DiagramError(f"block '{one.name}' is not in diagram '{self.name}'; add it")
        if by.output_type is None:
            raise DiagramError(f"block '{by.name}' has no output port to enable others by")
        self._enabled[block.name] = _Enabled(by.name, reset)

    def enabled_by(self, block: Block) -> tuple[Block, bool] | None:
        """The block that enables `block`, and whether it resets the states; None if always."""
        found = self._enabled.get(block.name)
        return None if found is None else (self._blocks[found.by], found.reset)

    def source(self, block: Block, port: int) -> Block:
        """The block whose output feeds input `port` of `block`."""
        return self._blocks[self._sources[block.name, port]]

    def order(self) -> tuple[Block, ...]:
        """The blocks such that each comes after those its output needs; ties as added.

        Raises `DiagramError` that names open inputs, unused outputs or the algebraic loop.
        """
        self._check_connected()
        waiting = {block.name: self._needs(block) for block in self.blocks}
        ordered: list[Block] = []
        while waiting:
            ready = next((name for name, needs in waiting.items() if not needs), None)
            if ready is None:
                raise AlgebraicLoopError(self.name, self._loop(waiting))
            del waiting[ready]
            for needs in waiting.values():
                needs.discard(ready)
            ordered.append(self._blocks[ready])
        return tuple(ordered)

    def _needs(self, block: Block) -> set[str]:
        """The blocks whose outputs the block's output needs in the same step."""
        needs = {
            self._sources[block.name, port]
            for port in range(len(block.input_types))
            if block.feedthrough(port)
        }
        enabled = self._enabled.get(block.name)
        if enabled is not None and (enabled.reset or self.divisor(block) != 1):
            needs.add(enabled.by)
        return needs

    def _check_connected(self) -> None:
        for block in self.blocks:
            for port in range(len(block.input_types)):
                if (block.name, port) not in self._sources:
                    raise DiagramError(
                        f"input {port} of block '{block.name}' is not connected; draw a line to it "
                        "or remove the block"
                    )
        used = {*self._sources.values(), *(enabled.by for enabled in self._enabled.values())}
        for block in self.blocks:
            if block.output_type is not None and block.name not in used:
                raise DiagramError(
                    f"the output of block '{block.name}' is not connected; draw a line from it or "
                    "remove the block"
                )

    def _loop(self, waiting: dict[str, set[str]]) -> list[str]:
        path = [next(iter(waiting))]
        while path[-1] not in path[:-1]:
            path.append(min(waiting[path[-1]]))
        return path[path.index(path[-1]) :][::-1]

    def _parameters(self) -> tuple[ir.Slot, ...]:
        found: dict[str, tuple[Parameter, ir.Slot]] = {}
        for block in self.blocks:
            for value in block.values():
                if not isinstance(value, Parameter):
                    continue
                if not _IDENTIFIER.match(value.name) or len(value.name) > _LONGEST_NAME:
                    raise DiagramError(f"parameter '{value.name}' must be an identifier")
                slot = parameter_slot(value, block.data_type, block.name)
                known = found.setdefault(value.name, (value, slot))
                if known[0] != value or known[1].data_type is not block.data_type:
                    raise DiagramError(
                        f"parameter '{value.name}' of block '{block.name}' differs from that of "
                        f"block '{known[1].block}'"
                    )
        return tuple(slot for _, slot in found.values())

    def lower(self) -> ir.Program:
        """The program of one step: outputs in order of need, then the states' updates."""
        lowering = _Lowering(self)
        signals = lowering.signals
        states = (*(state for b in self.blocks for state in b.states()), *lowering.held)
        self._check_names_of(signals, states)
        return ir.Program(
            name=self.name,
            sample_time=self.sample_time,
            inputs=tuple(b.slot for b in self.blocks if isinstance(b, Inport)),
            outputs=tuple(b.slot for b in self.blocks if isinstance(b, Outport)),
            parameters=self._parameters(),
            states=states,
            signals=tuple(signals),
            statements=tuple(lowering.statements),
        )

    def _check_names_of(self, signals: Sequence[ir.Slot], states: Sequence[ir.Slot]) -> None:
        """Blocks with several values share their name with a suffix; none may be met twice."""
        for slots in (signals, states):
            seen: dict[str, str] = {}
            for slot in slots:
                if slot.name in seen:
                    raise DiagramError(
                        f"blocks '{seen[slot.name]}' and '{slot.block}' both have a value "
                        f"'{slot.name}'; rename one of them"
                    )
                seen[slot.name] = slot.block


class _Lowering:
    """One pass over the blocks in order. What runs at a slower rate is held in between.

    A counter per rate says whether it is the rate's turn; a slow block's output and states are
    states of the program that keep their values in the steps that are not its turn.
    """

    def __init__(self, diagram: Diagram) -> None:
        self._diagram = diagram
        self._values: dict[str, ir.Expression] = {}
        self._counters: dict[int, ir.Slot] = {}
        self._begun: dict[str, ir.Slot] = {}
        self.signals: list[ir.Slot] = []
        self.held: list[ir.Slot] = []
        self.statements: list[ir.Statement] = []
        ordered = diagram.order()
        for block in ordered:
            self._outputs(block)
        for block in ordered:
            self._updates(block)
        for divisor, counter in sorted(self._counters.items()):
            self._count(divisor, counter)
        for name, was in self._begun.items():
            self.statements.append(ir.Statement(was, self._values[name], name, "Enable"))

    def _outputs(self, block: Block) -> None:
        inputs = self._inputs(block)
        if isinstance(block, Inport):
            self._values[block.name] = block.output(inputs)
            return
        self._reset(block)
        for target, expression in block.intermediates(inputs):
            self._signal(block, target, expression)
        if isinstance(block, Outport):
            self.statements.append(_of(block, block.slot, inputs[0]))
            return
        assert block.output_type is not None
        expression = block.output(inputs)
        if self._diagram.divisor(block) == 1:
            target = ir.Slot(ir.Kind.SIGNAL, block.name, block.output_type, block.name)
            self._signal(block, target, expression)
        else:
            target = ir.Slot(ir.Kind.STATE, f"{block.name}_held", block.output_type, block.name)
            self.held.append(target)
            self._assign_in_turn(block, target, expression)
        self._values[block.name] = ir.Read(target)

    def _updates(self, block: Block) -> None:
        inputs = self._inputs(block)
        pending = ir.Read(ir.Slot(ir.Kind.SIGNAL, "", block.data_type, ""))
        output = self._values.get(block.name, pending)
        for target, expression in block.updates(inputs, output):
            if target.kind is ir.Kind.SIGNAL:
                self._signal(block, target, expression)
            elif self._conditions(block):
                self._assign_in_turn(block, target, expression)
            else:
                self.statements.append(_of(block, target, expression))

    def _conditions(self, block: Block) -> list[ir.Comparison]:
        """What must hold for the block's states to change."""
        found = []
        if self._diagram.divisor(block) != 1:
            count = ir.Read(self._counter(self._diagram.divisor(block)))
            found.append(ir.Comparison("<=", count, _count_of(0)))
        enabled = self._diagram.enabled_by(block)
        if enabled is not None:
            half = ir.Literal(0.5, enabled[0].data_type)
            found.append(ir.Comparison(">=", self._values[enabled[0].name], half))
        return found

    def _reset(self, block: Block) -> None:
        """States begin anew in the step in which the block is enabled again."""
        enabled = self._diagram.enabled_by(block)
        if enabled is None or not enabled[1] or not block.states():
            return
        by = enabled[0]
        half, zero = ir.Literal(0.5, by.data_type), ir.Literal(0.0, by.data_type)
        begun = ir.Slot(ir.Kind.SIGNAL, f"{by.name}_begins", by.data_type, by.name)
        if by.name not in self._begun:
            was = ir.Slot(ir.Kind.STATE, f"{by.name}_was", by.data_type, by.name)
            self._begun[by.name] = was
            self.held.append(was)
            test = ir.Comparison(">=", ir.Read(was), half)
            self._signal(by, begun, ir.Select(test, zero, self._values[by.name]))
        for state in block.states():
            first = ir.Literal(state.initial, state.data_type)
            chosen = ir.Select(ir.Comparison(">=", ir.Read(begun), half), first, ir.Read(state))
            self.statements.append(_of(block, state, chosen))

    def _signal(self, block: Block, target: ir.Slot, expression: ir.Expression) -> None:
        self.signals.append(target)
        self.statements.append(_of(block, target, expression))

    def _assign_in_turn(self, block: Block, target: ir.Slot, expression: ir.Expression) -> None:
        if isinstance(expression, ir.Clamp):
            limited = ir.Slot(ir.Kind.SIGNAL, f"{block.name}_limited", target.data_type, block.name)
            self._signal(block, limited, expression)
            expression = ir.Read(limited)
        for condition in self._conditions(block):
            expression = ir.Select(condition, expression, ir.Read(target))
        self.statements.append(_of(block, target, expression))

    def _counter(self, divisor: int) -> ir.Slot:
        if divisor not in self._counters:
            name = f"every_{divisor}_steps"
            self._counters[divisor] = ir.Slot(ir.Kind.STATE, f"{name}_count", _COUNT, name)
            self.held.append(self._counters[divisor])
        return self._counters[divisor]

    def _count(self, divisor: int, counter: ir.Slot) -> None:
        last = ir.Comparison(">=", ir.Read(counter), _count_of(divisor - 1))
        following = ir.Select(last, _count_of(0), ir.Binary("+", ir.Read(counter), _count_of(1)))
        self.statements.append(ir.Statement(counter, following, counter.block, "Rate"))

    def _inputs(self, block: Block) -> list[ir.Expression]:
        """Values at the inputs; those not yet computed are without feed-through."""
        inputs = []
        for port in range(len(block.input_types)):
            name = self._diagram.source(block, port).name
            pending = ir.Read(ir.Slot(ir.Kind.SIGNAL, name, block.input_types[port], name))
            inputs.append(self._values.get(name, pending))
        return inputs


def _count_of(value: int) -> ir.Literal:
    return ir.Literal(value, _COUNT)


def _of(block: Block, target: ir.Slot, expression: ir.Expression) -> ir.Statement:
    return ir.Statement(target, expression, block.name, type(block).__name__)
