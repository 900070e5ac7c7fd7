# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A synchronous block diagram: blocks, lines, checks, and the lowering to a program."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from typing import TypeVar

from ravenbrick.errors import DesignError
from ravenbrick.model.blocks import Block, Inport, Outport, Parameter, parameter_slot
from ravenbrick.model.program import Expression, Kind, Program, Read, Slot, Statement

__all__ = ["Diagram", "DiagramError"]

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")
_LONGEST_NAME = 31
_AnyBlock = TypeVar("_AnyBlock", bound=Block)


class DiagramError(DesignError):
    """A diagram without a meaning: the sentence names the blocks."""


class Diagram:
    """Blocks of one sample time `sample_time` (s), joined by lines.

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
        if block.sample_time is not None and block.sample_time != self.sample_time:
            raise DiagramError(
                f"block '{block.name}' has the sample time {block.sample_time} s, its diagram "
                f"'{self.name}' {self.sample_time} s; one diagram has one rate"
            )
        self._blocks[block.name] = block
        return block

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

    def source(self, block: Block, port: int) -> Block:
        """The block whose output feeds input `port` of `block`."""
        return self._blocks[self._sources[block.name, port]]

    def order(self) -> tuple[Block, ...]:
        """The blocks such that each comes after those its output needs; ties as added.

        Raises `DiagramError` that names open inputs, unused outputs or the algebraic loop.
        """
        self._check_connected()
        waiting = {
            block.name: {
                self._sources[block.name, port]
                for port in range(len(block.input_types))
                if block.feedthrough(port)
            }
            for block in self.blocks
        }
        ordered: list[Block] = []
        while waiting:
            ready = next((name for name, needs in waiting.items() if not needs), None)
            if ready is None:
                raise DiagramError(self._describe_loop(waiting))
            del waiting[ready]
            for needs in waiting.values():
                needs.discard(ready)
            ordered.append(self._blocks[ready])
        return tuple(ordered)

    def _check_connected(self) -> None:
        for block in self.blocks:
            for port in range(len(block.input_types)):
                if (block.name, port) not in self._sources:
                    raise DiagramError(f"input {port} of block '{block.name}' is not connected")
        used = set(self._sources.values())
        for block in self.blocks:
            if block.output_type is not None and block.name not in used:
                raise DiagramError(f"the output of block '{block.name}' is not connected")

    def _describe_loop(self, waiting: dict[str, set[str]]) -> str:
        path = [next(iter(waiting))]
        while path[-1] not in path[:-1]:
            path.append(min(waiting[path[-1]]))
        loop = path[path.index(path[-1]) :][::-1]
        return (
            f"diagram '{self.name}' has the algebraic loop {' -> '.join(loop)}; "
            "put a UnitDelay into it"
        )

    def _parameters(self) -> tuple[Slot, ...]:
        found: dict[str, tuple[Parameter, Slot]] = {}
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

    def lower(self) -> Program:
        """The program of one step: outputs in order of need, then the states' updates."""
        ordered = self.order()
        values: dict[str, Expression] = {}
        signals: list[Slot] = []
        statements: list[Statement] = []
        for block in ordered:
            inputs = self._inputs(block, values)
            if isinstance(block, Inport):
                values[block.name] = block.output(inputs)
                continue
            for target, expression in block.intermediates(inputs):
                signals.append(target)
                statements.append(_of(block, target, expression))
            if isinstance(block, Outport):
                target, expression = block.slot, inputs[0]
            else:
                assert block.output_type is not None
                target = Slot(Kind.SIGNAL, block.name, block.output_type, block.name)
                expression = block.output(inputs)
                signals.append(target)
                values[block.name] = Read(target)
            statements.append(_of(block, target, expression))
        for block in ordered:
            inputs = self._inputs(block, values)
            output = values.get(block.name, Read(Slot(Kind.SIGNAL, "", block.data_type, "")))
            for target, expression in block.updates(inputs, output):
                if target.kind is Kind.SIGNAL:
                    signals.append(target)
                statements.append(_of(block, target, expression))
        self._check_names_of(signals)
        return Program(
            name=self.name,
            sample_time=self.sample_time,
            inputs=tuple(b.slot for b in self.blocks if isinstance(b, Inport)),
            outputs=tuple(b.slot for b in self.blocks if isinstance(b, Outport)),
            parameters=self._parameters(),
            states=tuple(state for b in self.blocks for state in b.states()),
            signals=tuple(signals),
            statements=tuple(statements),
        )

    def _check_names_of(self, signals: list[Slot]) -> None:
        """Blocks with several values share their name with a suffix; none may be met twice."""
        states = [state for block in self.blocks for state in block.states()]
        for slots in (signals, states):
            seen: dict[str, str] = {}
            for slot in slots:
                if slot.name in seen:
                    raise DiagramError(
                        f"blocks '{seen[slot.name]}' and '{slot.block}' both have a value "
                        f"'{slot.name}'; rename one of them"
                    )
                seen[slot.name] = slot.block

    def _inputs(self, block: Block, values: dict[str, Expression]) -> list[Expression]:
        """Values at the inputs; those not yet computed are without feed-through."""
        inputs = []
        for port in range(len(block.input_types)):
            name = self._sources[block.name, port]
            pending = Read(Slot(Kind.SIGNAL, name, block.input_types[port], name))
            inputs.append(values.get(name, pending))
        return inputs


def _of(block: Block, target: Slot, expression: Expression) -> Statement:
    return Statement(target, expression, block.name, type(block).__name__)
