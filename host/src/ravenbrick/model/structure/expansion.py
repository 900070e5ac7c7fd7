# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagram with subsystems, vectors and buses as one of single blocks and lines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from ravenbrick.errors import DesignError
from ravenbrick.model.blocks.basic import Block, Inport, Outport
from ravenbrick.model.structure.signals import (
    BusCreator,
    BusSelector,
    Demux,
    Mux,
    RoutingBlock,
    Shape,
)
from ravenbrick.model.structure.subsystem import Subsystem

if TYPE_CHECKING:
    from ravenbrick.model.diagram import Diagram

__all__ = ["End", "Expanded", "PortUnit", "expanded", "unique_names"]

_LONGEST_NAME = 31

End = tuple[str, int]
"""A block by its path, and an output of it from 0."""


@dataclass(frozen=True)
class PortUnit:
    """The unit that a subsystem's port at `path` states for the signal that begins at `end`."""

    end: End
    path: str
    unit: str


@dataclass
class Expanded:
    """Single blocks by path, the sources of their inputs, and what enables them.

    `enabled` names the enabling output and whether states begin anew.
    """

    blocks: dict[str, Block] = field(default_factory=dict)
    sources: dict[tuple[str, int], End] = field(default_factory=dict)
    enabled: dict[str, tuple[End, bool]] = field(default_factory=dict)
    port_units: list[PortUnit] = field(default_factory=list)


def expanded(diagram: Diagram) -> Expanded:
    """The diagram without subsystems, vectors and buses; raises `DesignError` by paths."""
    inlined = _Inlining(diagram).found
    if any(isinstance(block, RoutingBlock) for block in inlined.blocks.values()):
        return _Unbundling(inlined, diagram.name).found
    return inlined


@dataclass(frozen=True)
class _Scope:
    """A diagram at a path, inside the subsystem `block` of `outer`."""

    diagram: Diagram
    path: str = ""
    outer: _Scope | None = None
    block: Subsystem | None = None

    def path_of(self, block: Block) -> str:
        return f"{self.path}{block.name}"

    def inside(self, block: Subsystem) -> _Scope:
        return _Scope(block.diagram, f"{self.path}{block.name}/", self, block)


class _Inlining:
    """Subsystems dissolved: the blocks inside, joined through the ports."""

    def __init__(self, root: Diagram) -> None:
        self.found = Expanded()
        self._seen: set[str] = set()
        self._take(_Scope(root), None)

    def _take(self, scope: _Scope, enabling: tuple[End, bool] | None) -> None:
        scope.diagram.check_connected()
        for block in scope.diagram.blocks:
            own = scope.diagram.enabled_by(block)
            by = enabling if own is None else (self._end(scope, own[0], 0), own[1])
            if isinstance(block, Subsystem):
                self._take(scope.inside(block), by)
            elif scope.outer is None or not isinstance(block, Inport | Outport):
                self._block(scope, block, by)

    def _block(self, scope: _Scope, block: Block, enabling: tuple[End, bool] | None) -> None:
        path, rate = scope.path_of(block), block.sample_time
        slower = scope.outer is not None and not block.is_continuous and block.states()
        if rate is None and slower:
            block = replace(block, sample_time=scope.diagram.sample_time)
        self.found.blocks[path] = block
        if enabling is not None and block.states():
            self.found.enabled[path] = enabling
        for port in range(len(block.input_types)):
            self.found.sources[path, port] = self._source(scope, block, port)

    def _source(self, scope: _Scope, block: Block, port: int) -> End:
        diagram = scope.diagram
        return self._end(scope, diagram.source(block, port), diagram.source_output(block, port))

    def _end(self, scope: _Scope, block: Block, output: int) -> End:
        """Where a signal really begins."""
        if isinstance(block, Inport) and scope.outer is not None and scope.block is not None:
            place = scope.block.inports.index(block)
            return self._stated(self._source(scope.outer, scope.block, place), scope, block)
        if isinstance(block, Subsystem):
            port, inner = block.outports[output], scope.inside(block)
            return self._stated(self._source(inner, port, 0), inner, port)
        return scope.path_of(block), output

    def _stated(self, end: End, scope: _Scope, port: Inport | Outport) -> End:
        path = scope.path_of(port)
        if port.unit and path not in self._seen:
            self._seen.add(path)
            self.found.port_units.append(PortUnit(end, path, port.unit))
        return end


class _Unbundling:
    """Vectors and buses dissolved: a block on a vector becomes one block per element."""

    def __init__(self, whole: Expanded, name: str) -> None:
        self._whole, self._name = whole, name
        self._shapes: dict[str, Shape] = {path: None for path in whole.blocks}
        self._infer()
        self.found = Expanded()
        for path, block in whole.blocks.items():
            if not isinstance(block, RoutingBlock):
                self._copies(path, block)
        for stated in whole.port_units:
            for end in _leaves(self._tree(*stated.end)):
                self.found.port_units.append(replace(stated, end=end))

    def _infer(self) -> None:
        """The shape of each computing block's signals, until nothing changes."""
        changed = True
        while changed:
            changed = False
            for path, block in self._whole.blocks.items():
                if isinstance(block, RoutingBlock) or self._shapes[path] is not None:
                    continue
                shape = self._widest(path, block)
                if shape is not None:
                    self._shapes[path], changed = shape, True

    def _widest(self, path: str, block: Block) -> Shape:
        found: Shape = None
        for port in range(len(block.input_types)):
            end = self._whole.sources[path, port]
            shape = self._shape(*end, frozenset())
            if shape is None:
                continue
            if found is not None and _size(found) != _size(shape):
                raise DesignError(
                    f"block '{path}' of diagram '{self._name}' has inputs with {_size(found)} and "
                    f"{_size(shape)} elements; give all the same number, or single numbers"
                )
            found = found or shape
        if found is not None and block.output_count > 1:
            raise DesignError(
                f"block '{path}' of diagram '{self._name}' has an input with {_size(found)} "
                "elements, but takes single numbers; put a Demux before it"
            )
        return found

    def _shape(self, path: str, output: int, way: frozenset[str]) -> Shape:
        block = self._whole.blocks[path]
        if not isinstance(block, RoutingBlock):
            return self._shapes[path]
        if path in way:
            raise DesignError(f"diagram '{self._name}': '{path}' is a bus that only holds itself")
        ends = [self._whole.sources[path, port] for port in range(len(block.input_types))]
        inner = [self._shape(*end, way | {path}) for end in ends]
        names = block.fields if isinstance(block, BusCreator) else _numbers(len(inner))
        if isinstance(block, BusCreator | Mux):
            return tuple(zip(names, inner, strict=True))
        try:
            return self._part(block, output, inner[0])
        except DesignError:
            return None  # the shape before it is not known yet; the trees complain

    def _part(self, block: Block, output: int, shape: Shape) -> Shape:
        path = self._way(block, output, _size(shape), shape)
        for name in path:
            shape = dict(shape or ())[name]
        return shape

    def _way(self, block: Block, output: int, count: int, shape: Shape) -> list[str]:
        """Names that lead to what a selector or demux gives."""
        if isinstance(block, Demux):
            if count != block.count or shape is None:
                raise DesignError(
                    f"demux '{block.name}' of diagram '{self._name}' has {block.count} outputs, "
                    f"but its input has {count} elements"
                )
            return [shape[output][0]]
        assert isinstance(block, BusSelector)
        way: list[str] = []
        for name in block.fields[output].split("."):
            known = [own for own, _ in shape or ()]
            if name not in known:
                raise DesignError(
                    f"bus selector '{block.name}' of diagram '{self._name}': there is no field "
                    f"'{block.fields[output]}'; there are: {', '.join(known) or 'none'}"
                )
            shape = dict(shape or ())[name]
            way.append(name)
        return way

    def _tree(self, path: str, output: int) -> _Tree:
        """Where the elements of a signal begin."""
        block = self._whole.blocks[path]
        if not isinstance(block, RoutingBlock):
            return _named(path, output, self._shapes[path])
        ends = [self._whole.sources[path, port] for port in range(len(block.input_types))]
        inner = [self._tree(*end) for end in ends]
        if isinstance(block, BusCreator | Mux):
            names = block.fields if isinstance(block, BusCreator) else _numbers(len(inner))
            return dict(zip(names, inner, strict=True))
        shape = self._shape(*ends[0], frozenset())
        found: _Tree = inner[0]
        for name in self._way(block, output, _size(shape), shape):
            assert isinstance(found, dict)
            found = found[name]
        return found

    def _copies(self, path: str, block: Block) -> None:
        endings = list(_endings(self._shapes[path]))
        inputs = [list(_leaves(self._tree(*self._whole.sources[path, port])))
                  for port in range(len(block.input_types))]  # fmt: skip
        enabling = self._whole.enabled.get(path)
        for place, ending in enumerate(endings):
            own = f"{path}{ending}"
            last = own.rpartition("/")[2].replace(".", "_")
            self.found.blocks[own] = replace(block, name=last) if ending else block
            for port, ends in enumerate(inputs):
                self.found.sources[own, port] = ends[place if len(ends) > 1 else 0]
            if enabling is not None:
                self.found.enabled[own] = enabling


_Tree = End | dict[str, "_Tree"]


def _numbers(count: int) -> tuple[str, ...]:
    return tuple(str(number) for number in range(1, count + 1))


def _size(shape: Shape) -> int:
    return 1 if shape is None else sum(_size(inner) for _, inner in shape)


def _endings(shape: Shape) -> Iterator[str]:
    if shape is None:
        yield ""
    else:
        for name, inner in shape:
            for ending in _endings(inner):
                yield f".{name}{ending}"


def _named(path: str, output: int, shape: Shape) -> _Tree:
    if shape is None:
        return path, output
    return {name: _named(f"{path}.{name}", output, inner) for name, inner in shape}


def _leaves(tree: _Tree) -> Iterator[End]:
    if isinstance(tree, tuple):
        yield tree
    else:
        for inner in tree.values():
            yield from _leaves(inner)


def unique_names(paths: list[str]) -> dict[str, str]:
    """An identifier of at most 31 characters for each path; the outermost keep their names."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for path in sorted(paths, key=lambda one: one.count("/")):
        base = path.replace("/", "_").replace(".", "_")
        name, number = base[-_LONGEST_NAME:].lstrip("_0123456789"), 1
        while name.lower() in taken:
            number += 1
            name = f"{base[-(_LONGEST_NAME - 4) :].lstrip('_0123456789')}_{number}"
        taken.add(name.lower())
        found[path] = name
    return found
