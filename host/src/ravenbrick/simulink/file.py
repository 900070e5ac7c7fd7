# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reads Simulink's model files: `.slx` (a zip of XML) and `.mdl` (text, today around XML)."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from ravenbrick.errors import DesignError
from ravenbrick.simulink.counts import count_of

__all__ = ["SimulinkBlock", "SimulinkScript", "SimulinkSystem", "read_simulink"]

_LARGEST_BYTES = 64 << 20
_MOST_FILES = 4000
_DEEPEST = 200
_MOST_ELEMENTS = 300_000
_ROOTS = ("simulink/systems/system_root.xml", "simulink/blockdiagram.xml")
_SETTINGS = re.compile(r"simulink/(blockdiagram|configSet\d+)\.xml\Z")
_WANTED = ("PreLoadFcn", "PostLoadFcn", "InitFcn", "StopTime")
_CHARTS = re.compile(r"simulink/stateflow(/\w+)?\.xml\Z")
_CHART_TAG = re.compile(r"Stateflow S-Function (?:.* )?(\d+)\Z", re.DOTALL)
_PART = re.compile(r"^__MWOPC_PART_BEGIN__ /(\S+).*\n", re.MULTILINE)
_PACKAGE_END = "__MWOPC_PACKAGE_END__"
_DEFAULTS = ("simulink/bddefaults.xml", "simulink/blockdiagram.xml")


@dataclass
class SimulinkBlock:
    """A block with its parameters as text, defaults included; `system` of a subsystem.

    `mask` are the parameters of the block's mask, `instance` what a link to a library changes,
    `script` is the program of a MATLAB Function block, whose kind is `MATLABFunction` here.
    """

    name: str
    kind: str
    parameters: dict[str, str]
    system: SimulinkSystem | None = None
    mask: dict[str, str] = field(default_factory=dict)
    instance: dict[str, str] = field(default_factory=dict)
    script: SimulinkScript | None = None


@dataclass(frozen=True)
class SimulinkScript:
    """A program in MATLAB's language; `parameters` are inputs that the workspace gives."""

    text: str
    parameters: frozenset[str]


@dataclass(frozen=True)
class SimulinkLine:
    """From an output port (block, port from 1) to input ports; other ports have names."""

    source: tuple[str, int | str]
    targets: tuple[tuple[str, int | str], ...]
    name: str = ""


@dataclass
class SimulinkSystem:
    """Blocks by key (their number or name in the file) and the lines between them.

    `settings` are those of the whole model, at its root: callbacks such as `InitFcn`, `StopTime`.
    """

    blocks: dict[str, SimulinkBlock] = field(default_factory=dict)
    lines: list[SimulinkLine] = field(default_factory=list)
    settings: dict[str, str] = field(default_factory=dict)


@dataclass
class _Node:
    tag: str
    attributes: Mapping[str, str]
    children: list[_Node] = field(default_factory=list)
    text: str = ""

    def all(self, tag: str) -> Iterator[_Node]:
        return (child for child in self.children if child.tag == tag)

    def values(self) -> dict[str, str]:
        """Named parameters: <P Name="x">text</P>, or entries of a .mdl section."""
        return {p.attributes["Name"]: p.text for p in self.all("P") if "Name" in p.attributes}


def read_simulink(path: Path) -> SimulinkSystem:
    """The root system of a model; raises `DesignError` for a file that is no such model.

    XML with a document type or entities is refused, and so are archives that unpack to more than
    64 MB.
    """
    if zipfile.is_zipfile(path):
        with _unpacking(path):
            archive = zipfile.ZipFile(path)
        with archive:
            return _Archive(_Members(archive, path), path).root()
    data = path.read_bytes()
    if len(data) > _LARGEST_BYTES:
        raise DesignError(f"{path}: larger than {_LARGEST_BYTES >> 20} MB")
    text = data.decode("utf-8", errors="replace")
    parts = _text_parts(text)
    return _Archive(parts, path).root() if parts else _mdl_root(text, path)


@contextmanager
def _unpacking(path: Path) -> Iterator[None]:
    """Readers of archives raise whatever their parts do, of names that are no UTF-8 too."""
    try:
        yield
    except Exception as error:
        raise DesignError(
            f"{path}: the archive is damaged: {error}; save the model again"
        ) from error


def _text_parts(text: str) -> dict[str, bytes]:
    """The XML files inside a package written as text, by name; none in an older file."""
    pieces = _PART.split(text.rpartition(_PACKAGE_END)[0])
    return {name: body.encode() for name, body in zip(pieces[1::2], pieces[2::2], strict=True)
            if name.endswith(".xml")}  # fmt: skip


class _Members(Mapping[str, bytes]):
    """The files of an archive by name, unpacked when they are asked for."""

    def __init__(self, archive: zipfile.ZipFile, path: Path) -> None:
        self._archive = archive
        self._path = path
        infos = archive.infolist()
        if len(infos) > _MOST_FILES or sum(info.file_size for info in infos) > _LARGEST_BYTES:
            raise DesignError(
                f"{path}: the archive unpacks to more than {_LARGEST_BYTES >> 20} MB or "
                f"{_MOST_FILES} files"
            )
        self._names = {info.filename for info in infos}

    def __getitem__(self, name: str) -> bytes:
        with _unpacking(self._path), self._archive.open(name) as file:
            data = file.read(_LARGEST_BYTES + 1)
        if len(data) > _LARGEST_BYTES:
            raise DesignError(f"{self._path}: {name} is larger than its entry says")
        return data

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class _Archive:
    def __init__(self, members: Mapping[str, bytes], path: Path) -> None:
        self._members = members
        self._path = path
        self._names = set(members)
        self._defaults = self._read_defaults()
        charts = [self._parse(name) for name in sorted(self._names) if _CHARTS.match(name)]
        self._scripts = {key: script for part in charts for key, script in _scripts(part)}

    def _parse(self, name: str) -> _Node:
        return _parse_xml(self._members[name], f"{self._path}: {name}")

    def _read_defaults(self) -> dict[str, dict[str, str]]:
        for name in _DEFAULTS:
            if name in self._names:
                found = [n for n in _walk(self._parse(name)) if n.tag == "BlockParameterDefaults"]
                if found:
                    return {
                        b.attributes.get("BlockType", ""): b.values() for b in found[0].all("Block")
                    }
        return {}

    def root(self) -> SimulinkSystem:
        name = next((name for name in _ROOTS if name in self._names), None)
        if name is None:
            raise DesignError(f"{self._path}: no Simulink model is inside; expected {_ROOTS[1]}")
        node = self._parse(name)
        systems = [n for n in _walk(node) if n.tag == "System"]
        if not systems:
            raise DesignError(f"{self._path}: {name} holds no system")
        system = self._system(systems[0], 0)
        for part in (node, *(self._parse(n) for n in sorted(self._names) if _SETTINGS.match(n))):
            system.settings |= _settings(part)
        return system

    def _system(self, node: _Node, depth: int) -> SimulinkSystem:
        if depth > _DEEPEST:
            raise DesignError(f"{self._path}: subsystems are nested more than {_DEEPEST} deep")
        reference = node.attributes.get("Ref")
        if reference is not None:
            name = f"simulink/systems/{reference}.xml"
            if name not in self._names:
                raise DesignError(f"{self._path}: the subsystem file {name} is missing")
            node = next((n for n in _walk(self._parse(name)) if n.tag == "System"), node)
        return _system_of(
            node, self._defaults, lambda inner: self._system(inner, depth + 1), self._scripts
        )


def _walk(node: _Node) -> Iterator[_Node]:
    waiting = [node]
    while waiting:
        one = waiting.pop()
        yield one
        waiting += reversed(one.children)


def _settings(node: _Node) -> dict[str, str]:
    """What is set for the whole model, outside its blocks."""
    found: dict[str, str] = {}
    waiting = [node]
    while waiting:
        one = waiting.pop()
        found |= {key: text for key, text in one.values().items() if key in _WANTED}
        waiting += [child for child in one.children if child.tag not in ("System", "P")]
    return found


def _scripts(node: _Node) -> Iterator[tuple[str, SimulinkScript]]:
    """The programs of MATLAB Function blocks by the numbers of their charts."""
    for chart in _walk(node):
        inside = list(_walk(chart)) if chart.tag == "chart" else []
        texts = [one.values()["script"] for one in inside if "script" in one.values()]
        number = chart.values().get("chartFileNumber", "")
        if chart.values().get("type") == "EML_CHART" and number and len(texts) == 1:
            named = {one.attributes.get("name", ""): one.values() for one in inside
                     if one.tag == "data"}  # fmt: skip
            given = (n for n, v in named.items() if v.get("scope", "").startswith("PARAMETER"))
            yield number, SimulinkScript(texts[0], frozenset(given))


def _parse_xml(data: bytes, place: str) -> _Node:
    root = _Node("", {})
    stack, count = [root], 0

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > _MOST_ELEMENTS:
            raise DesignError(f"{place}: has more than {_MOST_ELEMENTS} elements")
        if len(stack) > _DEEPEST:
            raise DesignError(f"{place}: nested more than {_DEEPEST} deep")
        stack[-1].children.append(_Node(tag, attributes))
        stack.append(stack[-1].children[-1])

    def characters(text: str) -> None:
        stack[-1].text += text

    def refuse(*_: object) -> None:
        raise DesignError(f"{place}: has a document type, which model files never have")

    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = begin
    parser.EndElementHandler = lambda tag: stack.pop()
    parser.CharacterDataHandler = characters
    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, LookupError, ValueError) as error:  # the others: an encoding's
        raise DesignError(f"{place}: is not XML: {error}") from error
    return root


def _system_of(
    node: _Node,
    defaults: Mapping[str, dict[str, str]],
    inner: Callable[[_Node], SimulinkSystem],
    scripts: Mapping[str, SimulinkScript],
) -> SimulinkSystem:
    """A system from its node; `inner` makes those inside, `scripts` are by chart number."""
    system = SimulinkSystem()
    for block in node.all("Block"):
        own = block.values()
        kind = block.attributes.get("BlockType") or own.get("BlockType", "")
        name = block.attributes.get("Name") or own.get("Name", "")
        key = block.attributes.get("SID") or name
        instance = {key: text for data in block.all("InstanceData")
                    for key, text in data.values().items()}  # fmt: skip
        parameters = {**defaults.get(kind, {}), **own, **instance}
        # Names of blanks only are told apart by the block's number, or else by their length.
        shown = " ".join(name.split()) or f"{kind} {key.strip() or len(name)}"
        found = SimulinkBlock(shown, kind, parameters)
        found.mask, found.instance = _mask_of(block, own), instance
        chart = _CHART_TAG.match(own.get("Tag", ""))
        if chart and chart[1] in scripts:
            found.kind, found.script = "MATLABFunction", scripts[chart[1]]
        for child in block.all("System"):
            found.system = inner(child)
        system.blocks[key] = found
        system.blocks.setdefault(name, found)
    for line in node.all("Line"):
        source = _end(line.values(), "Src")
        targets = tuple(end for end in _targets(line) if end is not None)
        if source is not None and targets:
            name = " ".join(line.values().get("Name", "").split())
            system.lines.append(SimulinkLine(source, targets, name))
    return system


def _mask_of(block: _Node, own: Mapping[str, str]) -> dict[str, str]:
    """Names and values of a mask's parameters, in either way of writing them."""
    found = {}
    for mask in block.all("Mask"):
        for parameter in mask.all("MaskParameter"):
            name = parameter.attributes.get("Name") or parameter.values().get("Name", "")
            texts = [child.text for child in parameter.all("Value")]
            found[name] = texts[0] if texts else parameter.values().get("Value", "")
    names = re.findall(r"(\w+)=[@&](\d+)", own.get("MaskVariables", ""))
    values = own.get("MaskValueString", "").split("|")
    for name, text in names:
        place = count_of(text)
        if place is not None and place <= len(values):
            found[name] = values[place - 1]
    return found


def _targets(line: _Node) -> Iterator[tuple[str, int | str] | None]:
    waiting = [line]
    while waiting:
        one = waiting.pop()
        yield _end(one.values(), "Dst")
        waiting.extend(one.all("Branch"))


def _end(values: Mapping[str, str], side: str) -> tuple[str, int | str] | None:
    """An end of a line: `12#out:1` in newer files, two entries in older ones."""
    if side in values:
        match = re.match(r"(.+)#(out|in|\w+)(?::(\d+))?\Z", values[side])
        number = count_of(match[3] or "1") if match else None
        if match is None or number is None:
            return None
        return match[1], number if match[2] in ("in", "out") else match[2]
    if f"{side}Block" in values:
        port = values.get(f"{side}Port", "1")
        number = count_of(port)
        return values[f"{side}Block"], port if number is None else number
    return None


_MDL = re.compile(r"\s*(?:(?P<open>[\w.]+)\s*\{|(?P<close>\})|(?P<key>[\w.$]+)\s+(?P<value>.*))\Z")


def _mdl_root(text: str, path: Path) -> SimulinkSystem:
    node = _mdl_tree(text, path)
    models = [n for n in _walk(node) if n.tag in ("Model", "Library")]
    if not models:
        raise DesignError(f"{path}: is neither .slx nor .mdl: no Model section")
    defaults: dict[str, dict[str, str]] = {}
    for section in models[0].all("BlockParameterDefaults"):
        for block in section.all("Block"):
            values = block.values()
            defaults[values.get("BlockType", "")] = values
    systems = list(models[0].all("System"))
    if not systems:
        raise DesignError(f"{path}: the model holds no system")

    def system(inner: _Node) -> SimulinkSystem:
        return _system_of(inner, defaults, system, {})

    root = system(systems[0])
    root.settings |= _settings(node)
    return root


def _mdl_tree(text: str, path: Path) -> _Node:
    root = _Node("", {})
    stack = [root]
    last: _Node | None = None
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip()
        if not bare or bare.startswith("#"):
            continue
        if bare.startswith('"') and last is not None:
            last.text += _unquoted(bare)
            continue
        match = _MDL.match(line)
        if match is None:
            continue
        if match["open"]:
            if len(stack) > _DEEPEST:
                raise DesignError(f"{path}:{number}: nested more than {_DEEPEST} deep")
            stack[-1].children.append(_Node(match["open"], {}))
            stack.append(stack[-1].children[-1])
            last = None
        elif match["close"]:
            if len(stack) == 1:
                raise DesignError(f"{path}:{number}: a closing brace too many")
            stack.pop()
            last = None
        else:
            last = _Node("P", {"Name": match["key"]}, [], _unquoted(match["value"]))
            stack[-1].children.append(last)
    if len(stack) != 1:
        raise DesignError(f"{path}: ends inside section {stack[-1].tag}")
    return root


def _unquoted(text: str) -> str:
    text = text.strip()
    if len(text) > 1 and text[0] == '"' == text[-1]:
        return text[1:-1].replace('\\"', '"').replace("\\n", " ").replace("\\\\", "\\")
    return text
