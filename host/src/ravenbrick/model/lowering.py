# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""From blocks in order to the instructions of one step, with guards around slower rates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Block, Inport, Outport
from ravenbrick.model.number_format import FixedFormat

if TYPE_CHECKING:
    from ravenbrick.model.diagram import Diagram

__all__ = ["Lowering"]

_COUNT = FixedFormat(32, 0)


class Lowering:
    """One pass over the blocks in order. What runs at a slower rate is held in between.

    A counter per rate says whether it is the rate's turn. Neighbours of one rate share one guard;
    what is read outside of it is a state that keeps its value in the other steps. The states of a
    slow block change inside the same guard if their inputs are known there, else at the end.
    """

    def __init__(self, diagram: Diagram) -> None:
        self._diagram = diagram
        self._values: dict[tuple[str, int], ir.Expression] = {}
        self._counters: dict[int, ir.Slot] = {}
        self._begun: dict[str, ir.Slot] = {}
        self._blocks = [self._timed(block) for block in diagram.order()]
        self._runs = self._numbered_runs()
        self._read_at = self._places_of_readers()
        self._signals: dict[ir.Slot, None] = {}
        self.held: list[ir.Slot] = []
        self.statements: list[ir.Instruction] = []
        for _, run in groupby(self._blocks, lambda block: self._runs[block.name]):
            self._run(list(run))
        late = [block for block in self._blocks if not self._updates_in_run(block)]
        for _, group in groupby(late, self._guards_of_states):
            blocks = list(group)
            updates = [one for block in blocks for one in self._updates(block)]
            self.statements += self._guarded(self._guards_of_states(blocks[0]), updates)
        for divisor, counter in sorted(self._counters.items()):
            self._count(divisor, counter)
        for name, was in self._begun.items():
            self.statements.append(ir.Statement(was, self._values[name, 0], name, "Enable"))
        for statement in ir.statements(self.statements):
            if statement.target.kind is ir.Kind.SIGNAL:
                self._signals.setdefault(statement.target)

    @property
    def signals(self) -> tuple[ir.Slot, ...]:
        """Values that no step keeps."""
        return tuple(self._signals)

    def _timed(self, block: Block) -> Block:
        return block.timed(block.sample_time or self._diagram.sample_time)

    def _resets(self, block: Block) -> bool:
        enabled = self._diagram.enabled_by(block)
        return enabled is not None and enabled[1] and bool(block.states())

    def _numbered_runs(self) -> dict[str, int]:
        """Neighbours that share a guard have the same number; a reset begins a new run."""
        runs: dict[str, int] = {}
        number, before = 0, None
        for block in self._blocks:
            guards = self._guards_of_outputs(block)
            if before not in (None, guards) or (guards and self._resets(block)):
                number += 1
            runs[block.name], before = number, guards
        return runs

    def _sources_of(self, block: Block) -> Iterator[tuple[int, Block, int]]:
        for port in range(len(block.input_types)):
            yield (
                port,
                self._diagram.source(block, port),
                self._diagram.source_output(block, port),
            )

    def _updates_in_run(self, block: Block) -> bool:
        """Whether a guarded block's inputs are all known at the end of its run."""
        own = self._runs[block.name]
        return bool(self._guards_of_outputs(block)) and all(
            self._runs[source.name] <= own for _, source, _ in self._sources_of(block)
        )

    def _places_of_readers(self) -> dict[tuple[str, int], set[int]]:
        """By output: the runs that read it, -1 for what is outside of all."""
        places: dict[tuple[str, int], set[int]] = {}
        for block in self._blocks:
            own = self._runs[block.name]
            at_update = self._updated_at(block)
            for port, source, output in self._sources_of(block):
                found = places.setdefault((source.name, output), set())
                found |= at_update | ({own} if block.feedthrough(port) else set())
            enabled = self._diagram.enabled_by(block)
            if enabled is not None:
                places.setdefault((enabled[0].name, 0), set()).add(-1)
        for block in self._blocks:
            places.get((block.name, 0), set()).update(self._updated_at(block))
        return places

    def _updated_at(self, block: Block) -> set[int]:
        """Where the states change: the block's run, or -1; nowhere if there are none."""
        if not block.states():
            return set()
        return {self._runs[block.name] if self._updates_in_run(block) else -1}

    def _run(self, blocks: Sequence[Block]) -> None:
        """The outputs of neighbours with one guard, and the states that can change with them."""
        found: list[ir.Instruction] = []
        for block in blocks:
            if self._resets(block):
                self.statements += found
                found = []
                self._reset(block)
            found += self._outputs(block)
        for block in blocks:
            if self._updates_in_run(block):
                guards = self._guards_of_states(block)[len(self._guards_of_outputs(block)) :]
                found += self._guarded(guards, self._updates(block))
        self.statements += self._guarded(self._guards_of_outputs(blocks[0]), found)

    def _outputs(self, block: Block) -> tuple[ir.Instruction, ...]:
        inputs = self._inputs(block)
        if isinstance(block, Inport):
            self._values[block.name, 0] = block.output(inputs)
            return ()
        if isinstance(block, Outport):
            return (_of(block, block.slot, inputs[0]),)
        targets = [self._target(block, output) for output in range(block.output_count)]
        return block.compute(inputs, targets)

    def _target(self, block: Block, output: int) -> ir.Slot | None:
        """The variable of an output: a state if it is read outside of its guard."""
        readers = self._read_at.get((block.name, output))
        if readers is None:
            return None
        assert block.output_type is not None
        name = block.name if block.output_count == 1 else f"{block.name}_{output + 1}"
        if self._guards_of_outputs(block) and readers - {self._runs[block.name]}:
            target = ir.Slot(ir.Kind.STATE, f"{name}_held", block.output_type, block.name)
            self.held.append(target)
        else:
            target = ir.Slot(ir.Kind.SIGNAL, name, block.output_type, block.name)
        self._values[block.name, output] = ir.Read(target)
        return target

    def _updates(self, block: Block) -> list[ir.Statement]:
        pending = ir.Read(ir.Slot(ir.Kind.SIGNAL, "", block.data_type, ""))
        output = self._values.get((block.name, 0), pending)
        return [_of(block, *one) for one in block.updates(self._inputs(block), output)]

    def _guards_of_outputs(self, block: Block) -> tuple[str | int, ...]:
        """What decides whether the block's outputs change: a rate, and what enables it."""
        divisor = self._diagram.divisor(block)
        return () if divisor == 1 else self._guards_of_states(block)

    def _guards_of_states(self, block: Block) -> tuple[str | int, ...]:
        divisor, enabled = self._diagram.divisor(block), self._diagram.enabled_by(block)
        rate = () if divisor == 1 else (divisor,)
        return rate if enabled is None else (*rate, enabled[0].name)

    def _guarded(
        self, guards: Sequence[str | int], body: Sequence[ir.Instruction]
    ) -> tuple[ir.Instruction, ...]:
        """The instructions under all of the guards."""
        if not guards or not body:
            return tuple(body)
        tests, names = [], []
        for guard in guards:
            if isinstance(guard, int):
                counter = self._counter(guard)
                tests.append(ir.Comparison("<=", ir.Read(counter), _count_of(0)))
                names.append(counter.block)
            else:
                value = self._values[guard, 0]
                half = ir.Literal(0.5, ir.expression_type(value))
                tests.append(ir.Comparison(">=", value, half))
                names.append(guard)
        kind = "Rate" if isinstance(guards[0], int) else "Enable"
        return (ir.If(tuple(tests), tuple(body), (), names[0], kind),)

    def _reset(self, block: Block) -> None:
        """States begin anew in the step in which the block is enabled again."""
        enabled = self._diagram.enabled_by(block)
        assert enabled is not None
        by = enabled[0]
        half, zero = ir.Literal(0.5, by.data_type), ir.Literal(0.0, by.data_type)
        begun = ir.Slot(ir.Kind.SIGNAL, f"{by.name}_begins", by.data_type, by.name)
        if by.name not in self._begun:
            was = ir.Slot(ir.Kind.STATE, f"{by.name}_was", by.data_type, by.name)
            self._begun[by.name] = was
            self.held.append(was)
            test = ir.Comparison(">=", ir.Read(was), half)
            begins = ir.Select(test, zero, self._values[by.name, 0])
            self.statements.append(_of(by, begun, begins))
        test = ir.Comparison(">=", ir.Read(begun), half)
        restart = ir.Restart(block.states(), block.name, type(block).__name__)
        self.statements.append(ir.If((test,), (restart,), (), by.name, "Enable"))

    def _counter(self, divisor: int) -> ir.Slot:
        if divisor not in self._counters:
            name = f"every_{divisor}_steps"
            self._counters[divisor] = ir.Slot(ir.Kind.STATE, f"{name}_count", _COUNT, name)
            self.held.append(self._counters[divisor])
        return self._counters[divisor]

    def _count(self, divisor: int, counter: ir.Slot) -> None:
        kind = "RateCounter"
        last = ir.Comparison(">=", ir.Read(counter), _count_of(divisor - 1))
        begin = ir.Statement(counter, _count_of(0), counter.block, kind)
        more = ir.Binary("+", ir.Read(counter), _count_of(1))
        following = ir.Statement(counter, more, counter.block, kind)
        self.statements.append(ir.If((last,), (begin,), (following,), counter.block, kind))

    def _inputs(self, block: Block) -> list[ir.Expression]:
        """Values at the inputs; those not yet computed are without feed-through."""
        inputs = []
        for port, source, output in self._sources_of(block):
            pending = ir.Read(
                ir.Slot(ir.Kind.SIGNAL, source.name, block.input_types[port], source.name)
            )
            inputs.append(self._values.get((source.name, output), pending))
        return inputs


def _count_of(value: int) -> ir.Literal:
    return ir.Literal(value, _COUNT)


def _of(block: Block, target: ir.Slot, expression: ir.Expression) -> ir.Statement:
    return ir.Statement(target, expression, block.name, type(block).__name__)
