# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a picture shows of a diagram: blocks with ports and symbols, lines, subsystems by path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from enum import Enum

from ravenbrick.model.blocks import basic, logic, relational
from ravenbrick.model.blocks.basic import Block, Parameter
from ravenbrick.model.blocks.continuous import ContinuousStateSpace, Integrator
from ravenbrick.model.blocks.dynamic import Delay, DiscreteStateSpace
from ravenbrick.model.diagram import Diagram
from ravenbrick.model.picture.layers import Line
from ravenbrick.model.simulation.closed_loop import sampled_blocks
from ravenbrick.model.structure.signals import BusCreator, BusSelector, Demux, Mux
from ravenbrick.model.structure.subsystem import Subsystem

__all__ = ["Graph", "Node", "graph_of"]

_LONGEST_SYMBOL = 10  # letters of a parameter inside of a block
_MOST_DETAILS = 60  # characters of a value on hover


@dataclass
class Node:
    """A block to be drawn.

    `symbol` stands inside, `form` is its outline; `rate` in s, None in continuous time. `blocks`
    are the names of the blocks in the diagram that it stands for, `inner` what is inside it.
    """

    key: str
    name: str
    symbol: str
    form: str
    rate: float | None
    inputs: list[str]
    outputs: list[str]
    details: list[str]
    blocks: list[str]
    inner: Graph | None = None


@dataclass
class Graph:
    """Nodes and lines of one level; `path` is that of the subsystem, empty outside of all."""

    name: str
    path: str
    nodes: dict[str, Node] = field(default_factory=dict)
    lines: list[Line] = field(default_factory=list)

    def levels(self) -> Iterator[Graph]:
        """This one, then those of the subsystems inside."""
        yield self
        for node in self.nodes.values():
            if node.inner is not None:
                yield from node.inner.levels()


def graph_of(diagram: Diagram) -> Graph:
    """The levels of a diagram: by its subsystems, or by the paths of an imported model's blocks."""
    if diagram.paths and not any(isinstance(b, Subsystem) for b in diagram.blocks):
        graph = _by_paths(diagram)
    else:
        graph = _level(diagram, "")
    flat = diagram.flat()
    if any(block.is_continuous for block in flat.blocks):
        _mark_continuous(graph, flat)
    return graph


def _mark_continuous(graph: Graph, flat: Diagram) -> None:
    """Blocks without memory behind continuous ones are continuous too."""
    sampled, _ = sampled_blocks(flat)
    paths = {flat.paths.get(block.name, block.name) for block in flat.blocks
             if block.name not in sampled}  # fmt: skip
    for level in graph.levels():
        for node in level.nodes.values():
            if node.form == "port" or paths.intersection(node.blocks):
                node.rate = None


def _level(diagram: Diagram, path: str) -> Graph:
    graph = Graph(diagram.name, path)
    for block in diagram.blocks:
        node = _node(diagram, block, f"{path}{block.name}")
        if isinstance(block, Subsystem):
            node.inner = _level(block.diagram, f"{path}{block.name}/")
            node.blocks = [name for level in node.inner.levels() for one in level.nodes.values()
                           if one.inner is None for name in one.blocks]  # fmt: skip
        graph.nodes[block.name] = node
    for block in diagram.blocks:
        for port in range(len(block.input_types)):
            source = diagram.source(block, port)
            output = diagram.source_output(block, port)
            graph.lines.append(Line(source.name, output, block.name, port))
        _add_enable(graph, diagram, block)
    return graph


def _add_enable(graph: Graph, diagram: Diagram, block: Block) -> None:
    enabling = diagram.enabled_by(block)
    if enabling is not None:
        node = graph.nodes[block.name]
        node.inputs.append("reset" if enabling[1] else "enable")
        graph.lines.append(Line(enabling[0].name, 0, block.name, len(node.inputs) - 1))


def _by_paths(diagram: Diagram) -> Graph:
    """Blocks whose paths begin alike stand in one subsystem."""
    root = Graph(diagram.name, "")
    homes: dict[str, tuple[Graph, ...]] = {}
    for block in diagram.blocks:
        parts = diagram.paths.get(block.name, block.name).replace("//", "_").split("/")
        levels = [root]
        for part in parts[:-1]:
            here = levels[-1]
            key = f"system {part}"
            if key not in here.nodes:
                inner = Graph(part, f"{here.path}{part}/")
                here.nodes[key] = Node(key, part, "", "system", diagram.sample_time, [], [],
                                       [], [], inner)  # fmt: skip
            found = here.nodes[key].inner
            assert found is not None
            here.nodes[key].blocks.append(block.name)
            levels.append(found)
        node = _node(diagram, block, diagram.paths.get(block.name, block.name))
        levels[-1].nodes[block.name] = node
        homes[block.name] = tuple(levels)
    for block in diagram.blocks:
        for port in range(len(block.input_types)):
            source, output = diagram.source(block, port), diagram.source_output(block, port)
            _join(homes, source.name, output, block.name, port)
    return root


def _join(
    homes: Mapping[str, tuple[Graph, ...]], source: str, output: int, target: str, port: int
) -> None:
    """A line through the borders of subsystems, with a port for each that it passes."""
    up, down = homes[source], homes[target]
    common = sum(1 for one, two in zip(up, down, strict=False) if one is two)
    key, place = source, output
    for depth in range(len(up) - 1, common - 1, -1):
        label = source if output == 0 else f"{source}_{output + 1}"
        key, place = _border(up[depth - 1], up[depth], label, key, place, leaves=True)
    entries = [(down[depth - 1], down[depth]) for depth in range(common, len(down))]
    for outer, inner in entries:
        label = source if output == 0 else f"{source}_{output + 1}"
        system = f"system {inner.name}"
        node = outer.nodes[system]
        if label not in node.inputs:
            node.inputs.append(label)
            inner.nodes[f"in {label}"] = _port(f"in {label}", label, leaves=False)
            outer.lines.append(Line(key, place, system, len(node.inputs) - 1))
        key, place = f"in {label}", 0
    down[-1].lines.append(Line(key, place, target, port))


def _border(
    outer: Graph, inner: Graph, label: str, key: str, place: int, *, leaves: bool
) -> tuple[str, int]:
    node = outer.nodes[f"system {inner.name}"]
    if label not in node.outputs:
        node.outputs.append(label)
        inner.nodes[f"out {label}"] = _port(f"out {label}", label, leaves=leaves)
        inner.lines.append(Line(key, place, f"out {label}", 0))
    return node.key, node.outputs.index(label)


def _port(key: str, label: str, *, leaves: bool) -> Node:
    ends = ([""], []) if leaves else ([], [""])
    return Node(key, label, "", "port", 0.0, *ends, [f"port {label}"], [])


def _node(diagram: Diagram, block: Block, path: str) -> Node:
    symbol, form = _symbol(block)
    rate = None if block.is_continuous else block.sample_time or diagram.sample_time
    inputs, outputs = _port_names(block)
    details = [f"{path}: {type(block).__name__}", *_details(block)]
    details.append("continuous" if rate is None else f"every {rate * 1000:g} ms")
    return Node(block.name, block.name, symbol, form, rate, inputs, outputs, details, [path])


def _port_names(block: Block) -> tuple[list[str], list[str]]:
    count, outputs = len(block.input_types), [""] * block.output_count
    inputs = [""] * count
    if isinstance(block, Subsystem):
        return [port.name for port in block.inports], [port.name for port in block.outports]
    if isinstance(block, BusCreator):
        inputs = list(block.fields)
    elif isinstance(block, BusSelector):
        outputs = list(block.fields)
    elif isinstance(block, basic.Sum):
        inputs = list(block.signs)
    elif isinstance(block, relational.Product):
        inputs = [
            sign.replace("*", "\N{MULTIPLICATION SIGN}").replace("/", "\N{DIVISION SIGN}")
            for sign in block.operators
        ]
    elif count > 1:
        inputs = [str(port + 1) for port in range(count)]
    if len(outputs) > 1 and not isinstance(block, BusSelector):
        outputs = [str(port + 1) for port in range(len(outputs))]
    return inputs, outputs


def _symbol(block: Block) -> tuple[str, str]:
    """What stands in a block, and its outline."""
    if isinstance(block, basic.Inport | basic.Outport):
        return "", "port"
    if isinstance(block, basic.Gain):
        return _short(block.gain), "triangle"
    if isinstance(block, basic.Sum):
        return ("", "circle") if len(block.signs) < 3 else ("Σ", "box")
    if isinstance(block, basic.Constant):
        return _short(block.value), "box"
    if isinstance(block, Subsystem):
        return "", "system"
    if isinstance(block, BusCreator | BusSelector | Mux | Demux):
        return "", "bar"
    if isinstance(block, logic.StateMachine):
        return "states", "box"
    if isinstance(block, relational.RelationalOperator):
        return block.operator, "box"
    if isinstance(block, Delay):
        return f"z^-{block.length}", "box"
    plain = {
        basic.UnitDelay: "z^-1", basic.DiscreteIntegrator: "T/(z-1)", Integrator: "1/s",
        relational.Product: "", basic.Saturation: "~limit", logic.ZeroOrderHold: "hold",
        DiscreteStateSpace: "A, B, C, D (z)", ContinuousStateSpace: "A, B, C, D (s)",
        basic.DiscreteTransferFunction: "B(z)/A(z)", relational.Abs: "|u|",
    }  # fmt: skip
    return plain.get(type(block), _words(type(block).__name__)), "box"


def _words(name: str) -> str:
    letters = [f" {c.lower()}" if c.isupper() and n else c for n, c in enumerate(name)]
    return "".join(letters)


def _short(value: object) -> str:
    if isinstance(value, Parameter):
        return value.name if len(value.name) <= _LONGEST_SYMBOL else _short(value.value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _details(block: Block) -> Iterator[str]:
    """Parameters as text."""
    for one in fields(block):
        value = getattr(block, one.name)
        if one.name in ("name", "data_type", "sample_time", "diagram") or value in ("", None):
            continue
        if isinstance(value, Parameter):
            text = f"{value.name} = {value.value:g} {value.unit}".rstrip()
        elif isinstance(value, Enum):
            text = str(value.value)
        elif callable(value):
            continue
        else:
            text = f"{value:g}" if isinstance(value, float) else str(value)
        yield f"{one.name}: {text[:_MOST_DETAILS]}"
