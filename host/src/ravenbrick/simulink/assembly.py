# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The diagram of a translated model: the nodes that its outputs need, connected."""

from __future__ import annotations

from pathlib import Path

from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Block,
    Diagram,
)
from ravenbrick.simulink.signals import Node
from ravenbrick.simulink.translation import Translation

__all__ = ["Assembly"]


class Assembly:
    """A diagram of the nodes that lead to an output."""

    def __init__(self, translation: Translation, name: str, path: Path) -> None:
        self._translation = translation
        self._diagram = Diagram(name, translation.sample_time)
        self._path = path
        self._blocks: dict[int, Block] = {}

    def diagram(self) -> Diagram:
        """Inports in the model's order, then what leads to the outports."""
        translation = self._translation
        needed = self._needed()
        for node in translation.inports():
            if id(node) in needed:
                self._blocks[id(node)] = self._diagram.add(translation.rated(node))
        for node in needed.values():
            if id(node) not in self._blocks:
                self._blocks[id(node)] = self._diagram.add(translation.rated(node))
        for node in needed.values():
            block = self._blocks[id(node)]
            for port, wire in enumerate(node.inputs):
                source, output = translation.end(wire, node.path)
                self._diagram.connect(self._blocks[id(source)], block, port, output=output)
            enabling = translation.enabling(node)
            if enabling is not None:
                by = self._blocks[id(translation.node(enabling[0], node.path))]
                self._diagram.enable(block, by, reset=enabling[1])
        self._diagram.paths = {block.name: needed[key].path or block.name
                               for key, block in self._blocks.items()}  # fmt: skip
        return self._diagram

    def _needed(self) -> dict[int, Node]:
        translation = self._translation
        waiting = list(reversed(translation.outports))
        needed: dict[int, Node] = {}
        while waiting:
            node = waiting.pop()
            if id(node) in needed:
                continue
            needed[id(node)] = node
            wires = list(node.inputs)
            enabling = translation.enabling(node)
            if enabling is not None:
                wires.append(enabling[0])
            if len(node.inputs) != len(node.block.input_types):
                raise DesignError(f"{self._path}: an input of '{node.path}' is not connected")
            waiting += [translation.node(wire, node.path) for wire in wires]
        return needed
