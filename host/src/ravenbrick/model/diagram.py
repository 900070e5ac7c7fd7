# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A synchronous block diagram: blocks, lines, checks, and the lowering to a program."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeVar

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Block, Inport, Outport, Parameter, parameter_slot
from ravenbrick.model.lowering import Lowering
from ravenbrick.model.structure.expansion import Expanded, expanded, unique_names
from ravenbrick.model.structure.units import check_units

__all__ = ["AlgebraicLoopError", "Diagram", "DiagramError"]

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")
_LONGEST_NAME = 31
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
        self._taken: dict[str, str] = {}
        self._expanded: Diagram | None = None
        self.paths: Mapping[str, str] = {}
        """Paths of blocks that stand for one inside a subsystem, or for an element of a vector."""
        self.units: Mapping[str, str] = {}
        """Units of outputs as far as `flat` has found them, by "path:output" with output from 0."""

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
        taken = self._taken.get(block.name.lower())
        if taken is not None:
            raise DiagramError(
                f"block '{block.name}': the name '{taken}' is taken; letter case does not tell "
                "names apart"
            )
        self._check_rate(block)
        self._taken[block.name.lower()] = block.name
        self._expanded = None
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
        self._expanded = None

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
        self._expanded = None

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
        if self.flat() is not self:
            return self.flat().order()
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

    def flat(self) -> Diagram:
        """Single blocks and lines in place of subsystems, vectors and buses, with units checked.

        Its `paths` tell where the blocks come from. Raises `DiagramError` by paths.
        """
        if self._expanded is None:
            whole = expanded(self)
            units = check_units(self.name, whole)
            self.units = {f"{path}:{output}": text for (path, output), text in units.items()}
            single = list(whole.blocks) == list(self._blocks)
            self._expanded = self if single else self._rebuilt(whole)
        return self._expanded

    def _rebuilt(self, whole: Expanded) -> Diagram:
        names = unique_names(list(whole.blocks))
        found = Diagram(self.name, self.sample_time)
        blocks = {path: found.add(replace(block, name=names[path]))
                  for path, block in whole.blocks.items()}  # fmt: skip
        for (path, port), (source, output) in whole.sources.items():
            found.connect(blocks[source], blocks[path], port, output=output)
        for path, ((by, _), reset) in whole.enabled.items():
            found.enable(blocks[path], blocks[by], reset=reset)
        found.paths = {names[path]: path for path in whole.blocks}
        found._expanded = found
        return found

    def _repr_svg_(self) -> str:
        """The picture, for notebooks."""
        from ravenbrick.model.picture.svg import diagram_svg  # it draws diagrams

        return diagram_svg(self)

    def check_connected(self) -> None:
        """Raise `DiagramError` for an open input or an output that nothing reads."""
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

    def lower(self, *, continuous: bool = False) -> ir.Program:
        """The program of one step: outputs in order of need, then the states' updates.

        Blocks in continuous time are refused unless a simulation asks for them with `continuous`.
        """
        if not continuous:
            self.flat()._check_sampled()
        lowering = Lowering(self.flat())
        signals = lowering.signals
        blocks = self.flat().blocks
        states = (*(state for b in blocks for state in b.states()), *lowering.held)
        self._check_names_of(signals, states)
        return ir.Program(
            name=self.name,
            sample_time=self.sample_time,
            inputs=tuple(b.slot for b in blocks if isinstance(b, Inport)),
            outputs=tuple(b.slot for b in blocks if isinstance(b, Outport)),
            parameters=self.flat()._parameters(),
            states=states,
            signals=signals,
            statements=tuple(lowering.statements),
        )

    def _check_sampled(self) -> None:
        for block in self.blocks:
            if block.is_continuous:
                raise DiagramError(
                    f"block '{block.name}' of diagram '{self.name}' is continuous: it can be "
                    "simulated, but no sampled program has it; put it into the plant, or make it "
                    "discrete, for instance with transfer_function_block"
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
