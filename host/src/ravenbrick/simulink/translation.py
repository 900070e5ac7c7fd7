# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks of a Simulink model, each translated into nodes of our own blocks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Block,
    Constant,
    DataType,
    Inport,
    Outport,
    ZeroOrderHold,
)
from ravenbrick.model.blocks.continuous import ContinuousBlock
from ravenbrick.model.blocks.implicit import LoopSignal
from ravenbrick.model.blocks.time_functions import TimeFunction
from ravenbrick.simulink.blocks.conditions import held_output, triggered
from ravenbrick.simulink.blocks.library import library_maker, library_name, only_checks, own_library
from ravenbrick.simulink.blocks.sources import recorded
from ravenbrick.simulink.blocks.table import IGNORED, IN_TIME, MAKERS, STRUCTURE
from ravenbrick.simulink.builder import Builder, ContinuousForm, Names, identifier
from ravenbrick.simulink.differentiation import Differentiation
from ravenbrick.simulink.matlab.linear_systems import LTI, is_lti
from ravenbrick.simulink.network import CONTROLS, End, Network, Site
from ravenbrick.simulink.numbers import value_of
from ravenbrick.simulink.rates import block_rates, own_rate
from ravenbrick.simulink.shapes import shapes_of
from ravenbrick.simulink.signals import Bus, Node, Ref, Shape, Tap, Wire, size_of

__all__ = ["Refusal", "Translation"]

_FARTHEST = 2000
Maker = Callable[[Builder], None]
_KNOWN = frozenset([*MAKERS, "Reference", "Outport"])
_NOTES = ("DocBlock", "Model Info", "Timed-Based Linearization", "Trigger-Based Linearization")
_SINKS = ("Scope", "Display", "ToWorkspace", "ToFile", "XYGraph", "FloatingScope")


@dataclass(frozen=True)
class Refusal:
    """A block without counterpart: its path, its type and why.

    `outside` says that it cannot be expressed with signals: physical modelling, a chart or
    program in another language, a device, a toolbox that is not at hand.
    """

    path: str
    kind: str
    reason: str
    outside: bool = False


class Translation:
    """Nodes of all blocks of a model, and refusals of those without counterpart."""

    def __init__(
        self, network: Network, sample_time: float, form: ContinuousForm, *,
        exact_rates: bool = False,
    ) -> None:  # fmt: skip
        self.network = network
        self.refusals: list[Refusal] = []
        self.open_inputs: list[str] = []
        self.sample_time = sample_time
        self._form = form
        self._names, self._parameters = Names(), Names()
        self._time = Node(TimeFunction("the_time"), "")
        if form is ContinuousForm.SOLVED:
            self._names.new(self._time.block.name)
        self._shapes = shapes_of(network, _KNOWN)
        self.nodes: list[Node] = []
        self._outputs: dict[End, list[Wire]] = {}
        self._conditions: dict[str, Wire] = {}
        self._ports: list[Node] = []
        self._failed: set[str] = set()
        self._rates = block_rates(network, sample_time)
        sites = list(network.sites.values())
        for site in sorted(sites, key=lambda site: not network.is_root_port(site)):
            self._make(site)
        if exact_rates and form is ContinuousForm.SOLVED:
            self._differentiate()

    def _differentiate(self) -> None:
        """Derivatives of smooth signals, in place of the filters of those blocks."""

        def node_of(wire: Wire) -> Node | None:
            found = self.node(wire, "a derivative")
            return found if self._flows(self.network.sites[found.path]) else None

        rules = Differentiation(node_of)
        waiting = [site for site in self.network.sites.values()
                   if site.kind == "Derivative" and not site.commented and self._flows(site)
                   and not self.refusals]  # fmt: skip
        changed = True
        while changed:
            changed = False
            for site in list(waiting):
                builder = self._builder(site)
                found = rules.rates(builder, builder.inputs())
                if found is not None:
                    self.nodes = [node for node in self.nodes if node.path != site.path]
                    self.nodes += builder.nodes
                    self._outputs[site.path, 1] = found
                    waiting.remove(site)
                    changed = True

    def _flows(self, site: Site) -> bool:
        """Whether a block changes at all times: it has no rate of its own, no condition."""
        free = own_rate(site) is None or site.kind == "Constant"
        return free and next(self.network.guards(site.system), None) is None

    def _builder(self, site: Site) -> Builder:
        rate = self._rates.get(site.path, self.sample_time)
        return Builder(site, self.network, self._shapes, self._names, self._parameters, rate,
                       self._condition, self._form, self._time_input)  # fmt: skip

    def _time_input(self) -> Wire:
        """The time, in a simulation."""
        if self._time not in self.nodes:
            self.nodes.append(self._time)
        return self._time

    def _refuse(self, site: Site, reason: str, *, outside: bool = False) -> None:
        if site.path not in self._failed:
            self._failed.add(site.path)
            self.refusals.append(Refusal(site.path, site.kind, reason, outside))

    def _make(self, site: Site) -> None:
        kind, network = site.kind, self.network
        if site.commented:
            return
        if site.path in network.odd:
            outside = "physical" in network.odd[site.path]
            self._refuse(site, network.odd[site.path], outside=outside)
        elif network.is_root_port(site):
            self._root_port(site)
        elif kind == "FromWorkspace":
            self._from_workspace(site)
        elif kind == "Outport" and network.controls.get(site.system):
            self._run(site, held_output)
        elif kind in STRUCTURE and (kind != "ModelReference" or network.is_system(site.path)):
            self._check_structure(site)
        elif kind in IGNORED or network.is_system(site.path):
            return
        else:
            self._try(site)

    def _check_structure(self, site: Site) -> None:
        if site.kind == "SubSystem" and site.block.parameters.get("Variant", "off") == "on":
            self._refuse(site, "a variant subsystem; replace it by the variant that is meant")
        controls = self.network.controls.get(site.path, {})
        for kind, port in CONTROLS.items():
            if kind not in controls and self.network.source(site.path, port) is not None:
                self._refuse(site, f"its port '{port}' has no block inside it")
        for kind in controls:
            if self.network.source(site.path, CONTROLS[kind]) is None:
                self._refuse(site, f"its {CONTROLS[kind]} port is not connected to a signal")

    def _try(self, site: Site) -> None:
        maker: Maker | None = MAKERS.get(site.kind)
        if self._form is ContinuousForm.SOLVED and own_rate(site) is None:
            maker = IN_TIME.get(site.kind, maker)
        if site.kind == "Reference":
            source = site.block.parameters.get("SourceBlock", "")
            maker = MAKERS[LTI] if is_lti(source) else library_maker(source)
            note = own_library(source) and library_name(source) in _NOTES
            if _is_sink(site) or note or only_checks(source):
                return
            if maker is None:
                where = "has no counterpart" if own_library(source) else "is not at hand"
                text = " ".join(source.split())
                self._refuse(site, f"the library block '{text}' {where}",
                             outside=not own_library(source))  # fmt: skip
                return
        if maker is None:
            reason, outside = _unsupported(site)
            self._refuse(site, reason, outside=outside)
            return
        self._run(site, maker)

    def _run(self, site: Site, maker: Maker) -> None:
        builder = self._builder(site)
        try:
            maker(builder)
        except (
            ValueError, KeyError, IndexError, DesignError, NotImplementedError, ArithmeticError,
        ) as error:  # fmt: skip
            self._refuse(site, f"{error}")
            return
        self._take(builder)

    def _take(self, builder: Builder) -> None:
        self.nodes += builder.nodes
        self.open_inputs += [f"{builder.site.path}:{port}" for port in builder.open_inputs]
        for port, wires in builder.outputs.items():
            self._outputs[builder.site.path, port] = wires

    def _root_port(self, site: Site) -> None:
        if site.kind == "Inport":
            self._inport(site)
        elif site.kind == "Outport":
            self._outport(site, identifier(site.block.name))

    def _inport(self, site: Site) -> None:
        shape = self._shapes.get((site.path, 1), (1,))
        wires: list[Wire] = []
        for ending in _endings(shape):
            name = self._names.new(site.path, ending)
            wires.append(Node(Inport(name), site.path))
        self.nodes += [wire for wire in wires if isinstance(wire, Node)]
        self._outputs[site.path, 1] = wires

    def _from_workspace(self, site: Site) -> None:
        """In a simulation the rows of time and values that a variable has, else an input."""
        text = site.block.parameters.get("VariableName", "simin")
        if self._form is ContinuousForm.SOLVED and not site.variables.guess:
            try:
                rows = value_of(text, site.variables)
            except ValueError:
                rows = np.zeros((0, 0))
            if len(rows) > 1 and rows.shape[1] > 1:
                self._run(site, lambda b: recorded(b, rows))
                return
        self._inport(site)

    def _outport(self, site: Site, name: str, port: int = 1) -> None:
        end = self.network.source(site.path, port)
        if end is None:
            builder = self._builder(site)
            node = Node(Outport(self._names.new(name)), site.path, builder.inputs(port))
            self._take(builder)
            self._ports.append(node)
            return
        shape = self._shapes.get(end, (1,))
        for element, ending in enumerate(_endings(shape)):
            own = self._names.new(name, ending)
            self._ports.append(Node(Outport(own), site.path, [Ref(*end, element)]))

    def _condition(self, system: str) -> Wire:
        """1 while a conditional subsystem and those around it run."""
        if system in self._conditions:
            return self._conditions[system]
        site = self.network.sites[system]
        builder = self._builder(site)
        tests = []
        for kind, block in self.network.controls[system].items():
            wires = builder.inputs(CONTROLS[kind])
            if kind == "ActionPort":
                tests.append(wires[0])
            elif kind == "EnablePort":
                above = [builder.compare(wire, ">", 0.0) for wire in wires]
                tests.append(above[0] if len(above) == 1 else builder.logic("OR", *above))
            else:
                tests.append(
                    triggered(builder, wires, block.parameters.get("TriggerType", "rising"))
                )
        outer = next(self.network.guards(site.system), None)
        if outer is not None:
            tests.append(self._condition(outer))
        found = tests[0] if len(tests) == 1 else builder.logic("AND", *tests)
        self.nodes += builder.nodes
        self._conditions[system] = found
        return found

    @property
    def has_outputs(self) -> bool:
        """Whether there is anything to simulate: an outport, a scope, or a signal."""
        sites = self.network.sites.values()
        shown = any(_is_sink(s) and not s.commented for s in sites)
        return bool(self._ports) or shown or bool(self._ends())

    def require_outputs(self, path: Path) -> None:
        """Without an outport, scopes are the outputs, and without those what leads nowhere.

        Raises `DesignError` if there is no signal at all.
        """
        if not self._ports:
            self.show_sinks()
        if not self._ports:
            for end in self._ends():
                name = identifier(self.network.sites[end[0]].block.name)
                for element in range(len(self._outputs[end])):
                    port = Outport(self._names.new(name, f"_{element + 1}" if element else ""))
                    self._ports.append(Node(port, end[0], [Ref(*end, element)]))
        if not self._ports:
            raise DesignError(
                f"{path}: the model has no signal to show; add a block and an outport"
            )

    def _ends(self) -> list[End]:
        """Outputs of blocks that no block reads, or only a terminator."""
        network = self.network
        readers = [s for s in network.sites.values() if s.kind not in {*STRUCTURE, "Terminator"}]
        read = {network.source(s.path, port) for s in readers
                for port in range(1, network.inputs(s.path) + 1)}  # fmt: skip
        return [end for end in self._outputs if end not in read]

    def show_sinks(self) -> None:
        """What scopes and the like show becomes outputs; raises `DesignError` for a refused one."""
        for site in self.network.sites.values():
            if _is_sink(site) and not site.commented:
                for port in range(1, self.network.inputs(site.path) + 1):
                    self._outport(site, identifier(site.block.name), port)
        if self.refusals:
            raise DesignError(f"{self.refusals[0].path}: {self.refusals[0].reason}")

    def node(self, wire: Wire, place: str) -> Node:
        """The node that gives a wire's signal."""
        return self.end(wire, place)[0]

    def end(self, wire: Wire, place: str) -> tuple[Node, int]:
        """The node that gives a wire's signal, and the number of its output."""
        for _ in range(_FARTHEST):
            if isinstance(wire, Node):
                return wire, 0
            if isinstance(wire, Tap):
                return wire.node, wire.output
            wires = self._outputs.get((wire.path, wire.port))
            if wires is None or wire.element >= len(wires):
                raise DesignError(
                    f"'{wire.path}' has no output {wire.port} with {wire.element + 1} elements, "
                    f"which '{place}' reads"
                )
            wire = wires[wire.element]
        raise DesignError(f"'{place}' reads a signal that only leads to itself")

    def open_loop(self, source: Node, target: Node, sampled: set[str]) -> None:
        """Let a signal that a simulation finds lead from one node to the next."""
        for place, wire in enumerate(target.inputs):
            node = self.node(wire, target.path)
            if node is source and target.block.feedthrough(place):
                loop = Node(LoopSignal(self._names.new(source.path, "_loop")), source.path, [wire])
                self.nodes.append(loop)
                target.inputs[place] = loop
                if source.block.name in sampled:
                    sampled.add(loop.block.name)

    @property
    def outports(self) -> list[Node]:
        """The ports of the model that give its outputs."""
        return self._ports

    def inports(self) -> list[Node]:
        """Those that take its inputs, in order."""
        return [node for node in self.nodes if isinstance(node.block, Inport)]

    def enabling(self, node: Node) -> tuple[Wire, bool] | None:
        """The condition under which a node's states change, and whether they begin anew."""
        if not node.block.states() or self.network.sites[node.path].kind == "Outport":
            return None
        site = self.network.sites[node.path]
        system = next(self.network.guards(site.system), None)
        if system is None:
            return None
        reset = any(
            "reset" in (block.parameters.get("InitializeStates"),
                        block.parameters.get("StatesWhenEnabling"))
            for block in self.network.controls[system].values()
        )  # fmt: skip
        return self._condition(system), reset

    def rated(self, node: Node) -> Block:
        """The node's block with a sample time if it needs one of its own."""
        rate = self._rates.get(node.path, self.sample_time)
        block = node.block
        if self._form is ContinuousForm.SOLVED:
            block = replace(block, data_type=DataType.REAL64)
        free = (Inport, Outport, Constant, ContinuousBlock)
        if isinstance(block, free) or rate == self.sample_time:
            return block
        given = own_rate(self.network.sites[node.path]) is not None
        if given or block.states() or isinstance(block, ZeroOrderHold):
            return replace(block, sample_time=rate)
        return block


def _is_sink(site: Site) -> bool:
    """Whether a block only shows signals."""
    source = site.block.parameters.get("SourceBlock", "") if site.kind == "Reference" else ""
    return site.kind in _SINKS or (own_library(source) and library_name(source) == "XY Graph")


def _endings(shape: Shape) -> list[str]:
    """Endings of the names of a signal's elements."""
    if isinstance(shape, Bus) and shape.fields:
        found = []
        for name, inner in shape.fields:
            found += [f"_{identifier(name)}{ending}"[-24:] for ending in _endings(inner)]
        return found
    count = size_of(shape)
    return [""] if count == 1 else [f"_{index}" for index in range(1, count + 1)]


def _unsupported(site: Site) -> tuple[str, bool]:
    """Why a type of block is refused, and whether it lies outside."""
    if site.kind == "S-Function":
        tag = site.block.parameters.get("Tag", "")
        if "Stateflow" in tag or site.block.parameters.get("FunctionName") == "sf_sfun":
            return (
                "a Stateflow chart, or a MATLAB function of a .mdl file; draw it with a "
                "StateMachine, or save the model as .slx"
            ), True
        return "an S-Function, a program in another language; write a CustomFunction", True
    if site.kind in ("PMIOPort", "PMComponent", "SimscapeBlock", "SimscapeComponentBlock"):
        return "physical modelling", True
    if site.kind in ("MATLABSystem", "ModelReference"):
        return "it stands for something outside the model", True
    return "this type of block is not supported", False
