# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A synchronous block diagram: blocks, lines, checks, and the lowering to a program."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
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
        self._sources: dict[tuple[str, int], tuple[str, int]] = {}
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

    def connect(self, source: Block, target: Block, port: int = 0, *, output: int = 0) -> None:
        """Draw a line from an output of `source` to input `port` of `target`, both from 0."""
        for block in (source, target):
            if self._blocks.get(block.name) is not block:
                raise DiagramError(f"block '{block.name}' is not in diagram '{self.name}'; add it")
        if source.output_type is None:
            raise DiagramError(f"block '{source.name}' has no output port to start a line at")
        if not 0 <= output < source.output_count:
            raise DiagramError(
                f"block '{source.name}' has {source.output_count} output ports, "
                f"so there is no port {output}"
            )
        if not 0 <= port < len(target.input_types):
            raise DiagramError(
                f"block '{target.name}' has {len(target.input_types)} input ports, "
                f"so there is no port {port}"
            )
        if (target.name, port) in self._sources:
            raise DiagramError(
                f"input {port} of block '{target.name}' is already connected to "
                f"'{self._sources[target.name, port][0]}'"
            )
        wanted = target.input_types[port]
        if source.output_type is not wanted:
            raise DiagramError(
                f"'{source.name}' gives {source.output_type.value}, but input {port} of "
                f"'{target.name}' takes {wanted.value}; put a Conversion between them"
            )
        self._sources[target.name, port] = source.name, output

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
        return self._blocks[self._sources[block.name, port][0]]

    def source_output(self, block: Block, port: int) -> int:
        """Which output of `source(block, port)` the line begins at."""
        return self._sources[block.name, port][1]

    def order(self) -> tuple[Block, ...]:
        """The blocks such that each comes after those its output needs; ties as added.

        Blocks of one rate stand together as far as that allows.
        Raises `DiagramError` that names open inputs, unused outputs or the algebraic loop.
        """
        self._check_connected()
        waiting = {block.name: self._needs(block) for block in self.blocks}
        ordered: list[Block] = []
        rate = 1
        while waiting:
            free = [name for name, needs in waiting.items() if not needs]
            if not free:
                raise AlgebraicLoopError(self.name, self._loop(waiting))
            same = (name for name in free if self.divisor(self._blocks[name]) == rate)
            ready = next(same, free[0])
            rate = self.divisor(self._blocks[ready])
            del waiting[ready]
            for needs in waiting.values():
                needs.discard(ready)
            ordered.append(self._blocks[ready])
        return tuple(ordered)

    def _needs(self, block: Block) -> set[str]:
        """The blocks whose outputs the block's output needs in the same step."""
        needs = {
            self._sources[block.name, port][0]
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
        used = {name for name, _ in self._sources.values()}
        used |= {enabled.by for enabled in self._enabled.values()}
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
            signals=signals,
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
