# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A model with its subsystems dissolved: all blocks by path, and where each signal comes from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ravenbrick.simulink.counts import count_of, counts_in
from ravenbrick.simulink.file import SimulinkBlock, SimulinkSystem
from ravenbrick.simulink.libraries import Libraries, tight
from ravenbrick.simulink.numbers import Workspace, value_of

__all__ = ["CONTROLS", "End", "Network", "Site"]

CONTROLS = {"ActionPort": "ifaction", "EnablePort": "enable", "TriggerPort": "trigger"}
_DEEPEST = 60
_MOST_BLOCKS = 200_000
_FARTHEST = 1000

End = tuple[str, int]


@dataclass(frozen=True)
class Site:
    """A block at its place.

    `system` is the path of the subsystem that it is in, `variables` what its dialog knows, `link`
    the path of the link to a library, or to another model, that it came with.
    """

    path: str
    block: SimulinkBlock
    system: str
    variables: Workspace
    link: str = ""

    @property
    def kind(self) -> str:
        """The type of block."""
        return self.block.kind

    @property
    def port(self) -> int:
        """The number of an Inport or Outport."""
        return count_of(self.block.parameters.get("Port", "1").strip()) or 1

    @property
    def commented(self) -> str:
        """`on` for a block that is commented out, `through` for one that passes its inputs."""
        found = self.block.parameters.get("Commented", "off")
        return found if found in ("on", "through") else ""


class Network:
    """All blocks of a model, and for each input the block that gives its signal."""

    def __init__(self, root: SimulinkSystem, name: str, libraries: Libraries,
                 variables: Workspace, settings: Mapping[str, str]) -> None:  # fmt: skip
        self.settings = settings
        self.sites: dict[str, Site] = {}
        self.odd: dict[str, str] = {}
        self.controls: dict[str, dict[str, SimulinkBlock]] = {}
        self._libraries = libraries
        self._base = variables
        self._inner: dict[str, str] = {}
        self._lines: dict[tuple[str, int | str], tuple[End, str]] = {}
        self._ports: dict[tuple[str, str, int], str] = {}
        self._inputs: dict[str, int] = {}
        self._gotos: dict[str, list[Site]] = {}
        self._read(root, _Place("", variables, "", name, 0))

    def _read(self, system: SimulinkSystem, place: _Place) -> None:
        if place.depth > _DEEPEST or len(self.sites) > _MOST_BLOCKS:
            raise ValueError(f"'{place.path}' is nested more than {_DEEPEST} deep")
        paths: dict[str, str] = {}
        known: dict[int, str] = {}
        for key, block in system.blocks.items():
            name = block.name.replace("/", "//")
            own = f"{place.path}/{name}" if place.path else name
            if id(block) not in known:
                known[id(block)] = own
                if own not in self.sites:
                    self._add(Site(own, block, place.path, place.variables, place.link), place)
            paths[key] = known[id(block)]
        self._join(system, paths)

    def _add(self, site: Site, place: _Place) -> None:
        self.sites[site.path] = site
        if site.commented:
            return
        if site.kind in CONTROLS:
            self.controls.setdefault(site.system, {})[site.kind] = site.block
        elif site.kind == "Goto":
            self._gotos.setdefault(site.block.parameters.get("GotoTag", "A"), []).append(site)
        elif site.kind in ("Inport", "Outport"):
            self._ports.setdefault((site.system, site.kind, site.port), site.path)
        inside = self._inside(site, place)
        if inside is not None:
            self._inner[site.path] = inside[1].name
            self._read(*inside)

    def _inside(self, site: Site, place: _Place) -> tuple[SimulinkSystem, _Place] | None:
        """The system inside a block, with what is known there."""
        block, own = site.block, place.into(site)
        if site.kind == "SubSystem" and block.system is not None:
            return block.system, replace(own, variables=_masked(site, block.mask))
        if site.kind == "Reference":
            source = block.parameters.get("SourceBlock", "")
            found = self._libraries.block(source, place.name)
            if found is None:
                return None
            if found.system is None:
                mixed = {**found.parameters, **block.instance}
                single = SimulinkBlock(block.name, found.kind, mixed)
                self.sites[site.path] = replace(site, block=single, link=own.link or site.path)
                return None
            name = place.name if source.startswith("$bdroot") else source.partition("/")[0]
            variables = _masked(site, {**found.mask, **block.instance})
            inner = replace(own, variables=variables, name=name, link=own.link or site.path)
            return found.system, inner
        if site.kind == "ModelReference":
            name = _model_name(block.parameters)
            system = self._libraries.system(name)
            if system is not None:
                link = own.link or site.path
                return system, replace(own, variables=self._base, name=name, link=link)
        return None

    def _join(self, system: SimulinkSystem, paths: Mapping[str, str]) -> None:
        for line in system.lines:
            source = paths.get(line.source[0])
            for key, port in line.targets:
                target = paths.get(key)
                if source is None or target is None:
                    continue
                named = port.lower() if isinstance(port, str) else port
                if isinstance(named, str) and named not in CONTROLS.values():
                    self.odd[target] = (
                        f"its port '{port}' is not a signal (physical, reset or state)"
                    )
                elif not isinstance(line.source[1], int):
                    self.odd[target] = f"the port '{line.source[1]}' of '{source}' is not a signal"
                else:
                    self._lines[target, named] = ((source, line.source[1]), line.name)
                    if isinstance(named, int):
                        self._inputs[target] = max(named, self._inputs.get(target, 0))

    @property
    def variables(self) -> Workspace:
        """The model's workspace."""
        return self._base

    def program(self, name: str) -> str | None:
        """The text of a function's file beside the model; None if there is none."""
        return self._libraries.program(name)

    def is_workspace_variable(self, name: str, variables: Workspace) -> bool:
        """Whether a name means the same inside a block as in the model's workspace."""
        given = self._base.get(name)
        return given is not None and np.array_equal(given, variables[name])

    def is_system(self, path: str) -> bool:
        """Whether the block at `path` stands for the blocks inside it."""
        return path in self._inner

    def is_root_port(self, site: Site) -> bool:
        """Whether it is a port of the whole model."""
        return site.kind in ("Inport", "InportShadow", "Outport") and not site.system

    def inputs(self, path: str) -> int:
        """The number of input ports: as the file says, and not fewer than there are lines."""
        declared = counts_in(self.sites[path].block.parameters.get("Ports", "0"))
        return max([*declared[:1], self._inputs.get(path, 0)])

    def guards(self, system: str) -> Iterator[str]:
        """The conditionally executed subsystems around a place, the innermost first."""
        while system:
            if self.controls.get(system):
                yield system
            system = self.sites[system].system

    def source(self, path: str, port: int | str) -> End | None:
        """The block and output that give the signal at an input; None if it is open."""
        for _ in range(_FARTHEST):
            found = self._lines.get((path, port))
            if found is None:
                return None
            end = found[0]
            onwards = self._through(end)
            if onwards is None:
                return self._held(end)
            path, port = onwards
        return None

    def _held(self, end: End) -> End | None:
        """An end that gives a signal itself; the outport of a conditional subsystem for its."""
        if self.is_system(end[0]):
            outport = self._ports.get((end[0], "Outport", end[1]))
            return None if outport is None else (outport, 1)
        site = self.sites[end[0]]
        if site.kind == "InportShadow" and not site.system:
            inport = self._ports.get(("", "Inport", site.port))
            return None if inport is None else (inport, 1)
        return None if site.commented == "on" else end

    def _through(self, end: End) -> tuple[str, int | str] | None:
        """The input that a line's begin hands on; None if it is a signal of its own."""
        site = self.sites[end[0]]
        if site.commented == "through":
            return end[0], end[1]
        if self.is_system(end[0]):
            outport = self._ports.get((end[0], "Outport", end[1]))
            if outport is None or self.controls.get(end[0]):
                return None
            return outport, 1
        if site.kind == "From":
            goto = self._goto(site)
            return None if goto is None else (goto.path, 1)
        if site.kind in ("Inport", "InportShadow") and site.system:
            return site.system, site.port
        return None

    def _goto(self, site: Site) -> Site | None:
        """In the same system, else in one around it, else anywhere with global visibility."""
        found = self._gotos.get(site.block.parameters.get("GotoTag", "A"), [])
        system: str | None = site.system
        while system is not None:
            for goto in found:
                local = goto.block.parameters.get("TagVisibility", "local") == "local"
                if goto.system == system and (system == site.system or not local):
                    return goto
            system = self.sites[system].system if system else None
        wide = [g for g in found if g.block.parameters.get("TagVisibility", "local") != "local"]
        return wide[0] if wide else None

    def signal_name(self, path: str, port: int | str) -> str:
        """The name of the signal at an input, as a bus calls it; empty if it has none."""
        for _ in range(_FARTHEST):
            found = self._lines.get((path, port))
            if found is None:
                return ""
            end, name = found
            site = self.sites[end[0]]
            if name:
                return name.strip("<>")
            if site.kind == "BusSelector":
                chosen = site.block.parameters.get("OutputSignals", "").split(",")
                return chosen[end[1] - 1].split(".")[-1] if end[1] <= len(chosen) else ""
            onwards = self._through(end)
            if onwards is None:
                return ""
            path, port = onwards
        return ""


@dataclass(frozen=True)
class _Place:
    """Where the reading of a system is: its path, what is known there, its file, its depth."""

    path: str
    variables: Workspace
    link: str
    name: str
    depth: int

    def into(self, site: Site) -> _Place:
        """Inside a block."""
        return replace(self, path=site.path, variables=site.variables, link=site.link,
                       depth=self.depth + 1)  # fmt: skip


def _masked(site: Site, mask: Mapping[str, str]) -> Workspace:
    """Outer variables with those of the mask, without parameters that are not numbers."""
    own = {}
    for name, text in mask.items():
        try:
            own[name] = value_of(text, site.variables)
        except ValueError:
            continue
    return site.variables.inside(own)


def _model_name(parameters: Mapping[str, str]) -> str:
    for name in ("ModelNameDialog", "ModelName", "ModelFile"):
        if parameters.get(name):
            return tight(parameters[name]).removesuffix(".slx").removesuffix(".mdl")
    return ""
