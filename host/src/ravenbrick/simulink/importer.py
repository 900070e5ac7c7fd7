# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A Simulink model becomes a diagram; what has no counterpart is listed by its path."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from ravenbrick.errors import DesignError
from ravenbrick.model import Block, Diagram, Inport, Outport
from ravenbrick.simulink.blocks import IGNORED, MAKERS, STRUCTURE, Dialog
from ravenbrick.simulink.file import SimulinkBlock, SimulinkSystem, read_simulink

__all__ = ["Refusal", "Survey", "import_simulink", "survey_simulink"]

_LONGEST_NAME = 31
_End = tuple[str, int]


@dataclass(frozen=True)
class Refusal:
    """A block without counterpart: its path, its type and why."""

    path: str
    kind: str
    reason: str


@dataclass(frozen=True)
class Survey:
    """How many blocks a model has, by what becomes of them."""

    blocks: int
    refusals: tuple[Refusal, ...]

    @property
    def supported(self) -> int:
        """Blocks that are imported, or that only show or end signals."""
        return self.blocks - len(self.refusals)


def import_simulink(
    path: Path, sample_time: float, variables: Mapping[str, float] | None = None
) -> Diagram:
    """The model in `path` (.slx or .mdl) as a diagram stepped every `sample_time` (s).

    Subsystems are dissolved, their paths become names. `variables` are the workspace's numbers.
    Continuous blocks are made discrete by Tustin's method. Scopes and terminators are left out,
    with what only leads to them. Raises `DesignError` with every block that cannot be imported.
    """
    flat = _Flat(read_simulink(path))
    makings = _Making(flat, sample_time, variables or {})
    if makings.refusals:
        lines = [f"{r.path} ({r.kind}): {r.reason}" for r in makings.refusals]
        raise DesignError(
            f"{path}: {len(lines)} of {len(flat.blocks)} blocks cannot be imported; replace them",
            detail="\n".join(lines),
        )
    return makings.diagram(_identifier(path.stem), path)


def survey_simulink(path: Path, sample_time: float = 0.01) -> Survey:
    """What of a model can be imported; unknown variables count as 1."""
    flat = _Flat(read_simulink(path))
    makings = _Making(flat, sample_time, _AnyNumber())
    return Survey(len(flat.blocks), tuple(makings.refusals))


class _AnyNumber(dict[str, float]):
    """Gives each variable a number."""

    def __contains__(self, name: object) -> bool:
        return name not in ("pi", "inf", "Inf", "eps")

    def __missing__(self, name: str) -> float:
        return 1.0


class _Flat:
    """All blocks by path, and for each input where its signal comes from."""

    def __init__(self, root: SimulinkSystem) -> None:
        self.blocks: dict[str, SimulinkBlock] = {}
        self.odd: dict[str, str] = {}
        self._sources: dict[_End, _End] = {}
        self._ports: dict[_End, str] = {}
        self._inner: dict[str, str] = {}
        self._tags: dict[str, str] = {}
        self._read(root, "")

    def _read(self, system: SimulinkSystem, path: str) -> None:
        paths: dict[str, str] = {}
        for key, block in system.blocks.items():
            own = f"{path}/{block.name}" if path else block.name
            paths[key] = own
            if own in self.blocks:
                continue
            self.blocks[own] = block
            if block.kind == "SubSystem" and block.system is not None:
                self._read(block.system, own)
            elif block.kind in ("Inport", "Outport") and path:
                number = int(block.parameters.get("Port", "1") or 1)
                inside = block.kind == "Inport"
                self._ports[path, number if inside else -number] = own
                if inside:
                    self._inner[own] = path
            elif block.kind == "Goto":
                self._tags[block.parameters.get("GotoTag", "A")] = own
        for line in system.lines:
            if line.source[0] not in paths:
                continue
            for key, port in line.targets:
                target = paths.get(key)
                if target is None:
                    continue
                origin = line.source[1]
                if not isinstance(port, int) or not isinstance(origin, int):
                    self.odd[target] = f"its port '{port}' is no signal (enable, trigger, physical)"
                    continue
                self._sources[target, port] = (paths[line.source[0]], origin)

    def source(self, path: str, port: int, depth: int = 0) -> str | None:
        """The path of the block that gives the signal at an input; None if it is open."""
        end = self._sources.get((path, port))
        if end is None or depth > 1000:
            return None
        block = self.blocks[end[0]]
        if block.kind == "SubSystem":
            inner = self._ports.get((end[0], -end[1]))
            return None if inner is None else self.source(inner, 1, depth + 1)
        if block.kind == "From":
            goto = self._tags.get(block.parameters.get("GotoTag", "A"))
            return None if goto is None else self.source(goto, 1, depth + 1)
        if block.kind == "Inport" and end[0] in self._inner:
            number = int(block.parameters.get("Port", "1") or 1)
            return self.source(self._inner[end[0]], number, depth + 1)
        return end[0]

    def is_port(self, path: str) -> bool:
        """Whether it is a port of the whole model."""
        return self.blocks[path].kind in ("Inport", "Outport") and "/" not in path


def _identifier(path: str) -> str:
    words = re.sub(r"[^A-Za-z0-9]+", "_", path).strip("_") or "Block"
    words = words if words[0].isalpha() else f"B_{words}"
    return words[-_LONGEST_NAME:].lstrip("_0123456789") or "Block"


class _Making:
    """Blocks of ours by path, and what could not be made."""

    def __init__(self, flat: _Flat, sample_time: float, variables: Mapping[str, float]) -> None:
        self._flat = flat
        self._sample_time = sample_time
        self._variables = variables
        self._taken: set[str] = set()
        self._made: dict[str, Block] = {}
        self.refusals: list[Refusal] = []
        for path, block in flat.blocks.items():
            self._make(path, block)

    def _name(self, path: str) -> str:
        base = _identifier(path.rpartition("/")[2])
        base = base if base.lower() not in self._taken else _identifier(path)
        name, number = base, 2
        while name.lower() in self._taken:
            tail = f"_{number}"
            name, number = f"{base[: _LONGEST_NAME - len(tail)]}{tail}", number + 1
        self._taken.add(name.lower())
        return name

    def _make(self, path: str, block: SimulinkBlock) -> None:
        kind, flat = block.kind, self._flat
        if path in flat.odd:
            self.refusals.append(Refusal(path, kind, flat.odd[path]))
        elif flat.is_port(path):
            port = Inport if kind == "Inport" else Outport
            self._made[path] = port(self._name(path))
        elif kind in IGNORED | STRUCTURE:
            return
        elif kind not in MAKERS:
            self.refusals.append(Refusal(path, kind, "this type of block is not supported"))
        else:
            try:
                self._made[path] = self._one(path, block)
            except (ValueError, KeyError, IndexError, DesignError, NotImplementedError) as error:
                self.refusals.append(Refusal(path, kind, f"{error}"))

    def _one(self, path: str, block: SimulinkBlock) -> Block:
        own = self._sample_time
        text = block.parameters.get("SampleTime", "-1").strip().strip("[]").split(",")[0].split()
        given = text[0] if text else "-1"
        if block.kind != "Constant" and given not in ("-1", "0", "inf", "Inf"):
            try:
                own = float(Dialog(block, "", self._variables, own).number("SampleTime", "-1"))
            except ValueError:
                raise
        if isinstance(self._variables, _AnyNumber) or own <= 0 or not math.isfinite(own):
            own = self._sample_time
        found = MAKERS[block.kind](Dialog(block, self._name(path), self._variables, own))
        return found if own == self._sample_time else replace(found, sample_time=own)

    def diagram(self, name: str, path: Path) -> Diagram:
        """All blocks that lead to an outport, joined."""
        needed = self._needed()
        diagram = Diagram(name, self._sample_time)
        for place, block in self._made.items():
            if place in needed:
                diagram.add(block)
        for place, block in self._made.items():
            if place not in needed:
                continue
            for port in range(len(block.input_types)):
                source = self._flat.source(place, port + 1)
                if source is None:
                    raise DesignError(f"{path}: input {port + 1} of '{place}' is not connected")
                diagram.connect(self._made[source], block, port)
        return diagram

    def _needed(self) -> set[str]:
        waiting = [path for path, block in self._made.items() if isinstance(block, Outport)]
        needed: set[str] = set()
        while waiting:
            place = waiting.pop()
            if place in needed or place not in self._made:
                continue
            needed.add(place)
            for port in range(len(self._made[place].input_types)):
                source = self._flat.source(place, port + 1)
                if source is not None:
                    waiting.append(source)
        return needed
