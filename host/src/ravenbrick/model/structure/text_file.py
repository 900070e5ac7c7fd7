# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagrams as text files (TOML) that a person can edit and a tool can compare."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from ravenbrick.errors import DesignError
from ravenbrick.model.blocks import basic, logic, sections
from ravenbrick.model.blocks.basic import Block
from ravenbrick.model.diagram import Diagram
from ravenbrick.model.program import DataType
from ravenbrick.model.structure.subsystem import Subsystem
from ravenbrick.toml_values import toml_values

__all__ = ["diagram_text", "load_diagram", "read_diagram"]

_PARTS = (basic.Parameter, sections.Section, logic.MachineState, logic.Transition)
_ENUMERATIONS = (basic.IntegrationMethod, DataType)
_OWN = ("kind", "inputs", "enabled_by", "reset", "blocks", "path")
_NONE = "none"


def diagram_text(diagram: Diagram) -> str:
    """The diagram as a TOML document; fields with their default values are left out.

    The inputs of a block are the blocks that feed its ports, in order, "Motor.2" the second
    output of Motor. Raises `DesignError` for blocks that hold Python functions.
    """
    head = [f"name = {json.dumps(diagram.name)}", f"sample_time = {_value(diagram.sample_time)}"]
    return "\n".join([*head, *_blocks(diagram, "blocks")]) + "\n"


def _blocks(diagram: Diagram, table: str) -> Iterator[str]:
    for block in diagram.blocks:
        yield ""
        yield f"[{table}.{block.name}]"
        yield f"kind = {json.dumps(type(block).__name__)}"
        for name, value in _given(block):
            yield f"{name} = {value}"
        if diagram.paths.get(block.name, block.name) != block.name:
            yield f"path = {json.dumps(diagram.paths[block.name])}"
        inputs = [_end(diagram, block, port) for port in range(len(block.input_types))]
        if inputs:
            yield f"inputs = {json.dumps(inputs)}"
        enabling = diagram.enabled_by(block)
        if enabling is not None:
            yield f"enabled_by = {json.dumps(enabling[0].name)}"
            if enabling[1]:
                yield "reset = true"
        if isinstance(block, Subsystem):
            yield from _blocks(block.diagram, f"{table}.{block.name}.blocks")


def _end(diagram: Diagram, block: Block, port: int) -> str:
    try:
        source, output = diagram.source(block, port), diagram.source_output(block, port)
    except KeyError:
        return ""  # an open input, which is refused when the diagram is used
    return source.name if output == 0 else f"{source.name}.{output + 1}"


def _given(block: Block) -> Iterator[tuple[str, str]]:
    """Fields that differ from their defaults, as text."""
    if isinstance(block, Subsystem):
        yield "sample_time", _value(block.diagram.sample_time)
        return
    for one in fields(block):
        value = getattr(block, one.name)
        default = one.default if one.default_factory is MISSING else one.default_factory()
        if one.name == "name" or value == default or value is None:
            continue
        try:
            yield one.name, _value(value)
        except TypeError as error:
            raise DesignError(
                f"block '{block.name}': its {one.name} is a Python object, which a text file does "
                "not hold; keep this diagram as a program"
            ) from error


def _value(value: object) -> str:
    match value:
        case None:
            return json.dumps(_NONE)
        case bool():
            return str(value).lower()
        case float():
            return repr(float(value)) if math.isfinite(value) else str(value)
        case int():
            return str(int(value))
        case str():
            return json.dumps(value, ensure_ascii=False)
        case tuple() | list():
            return f"[{', '.join(map(_value, value))}]"
        case Enum() if isinstance(value, _ENUMERATIONS):
            return json.dumps(value.name)
        case _ if isinstance(value, _PARTS):
            given = {"part": type(value).__name__} | {
                one.name: getattr(value, one.name) for one in fields(value)
                if getattr(value, one.name) != one.default
            }  # fmt: skip
            return f"{{ {', '.join(f'{name} = {_value(own)}' for name, own in given.items())} }}"
    raise TypeError(type(value).__name__)


def read_diagram(text: str, place: str = "diagram") -> Diagram:
    """The diagram of a document as `diagram_text` writes it; `place` is its file, for errors."""
    try:
        content = toml_values(text)
        return _diagram(str(content["name"]), content, content["sample_time"])
    except (DesignError, ValueError, RecursionError) as error:
        raise DesignError(f"{place}: {error}") from error
    except KeyError as error:
        raise DesignError(f"{place}: {error} is missing") from error


def load_diagram(path: Path) -> Diagram:
    """The diagram in a file."""
    return read_diagram(path.read_text(encoding="utf-8"), str(path))


def _diagram(name: str, content: Mapping[str, Any], sample_time: float) -> Diagram:
    diagram = Diagram(name, float(sample_time))
    tables: Mapping[str, Mapping[str, Any]] = content.get("blocks", {})
    blocks = {own: diagram.add(_block(own, table)) for own, table in tables.items()}

    def named(block: str, source: str) -> Block:
        if source not in blocks:
            raise DesignError(f"block '{block}': there is no block '{source}' to feed it")
        return blocks[source]

    paths = {own: str(table.get("path", own)) for own, table in tables.items()}
    if any(own != path for own, path in paths.items()):
        diagram.paths = paths
    for own, table in tables.items():
        for port, end in enumerate(table.get("inputs", [])):
            source, _, output = str(end).partition(".")
            if source:
                number = int(output or 1) - 1
                diagram.connect(named(own, source), blocks[own], port, output=number)
        if "enabled_by" in table:
            by = named(own, table["enabled_by"])
            diagram.enable(blocks[own], by, reset=bool(table.get("reset", False)))
    return diagram


def _kinds(kind: type[Block]) -> Iterator[type[Block]]:
    yield kind
    for inner in kind.__subclasses__():
        yield from _kinds(inner)


def _block(name: str, table: Mapping[str, Any]) -> Block:
    known = {kind.__name__: kind for kind in _kinds(Block)}
    kind = known.get(str(table.get("kind")))
    if kind is None:
        raise DesignError(f"block '{name}': there is no kind of block '{table.get('kind')}'")
    if kind is Subsystem:
        return Subsystem(name, diagram=_diagram(name, table, table["sample_time"]))
    own = {one.name for one in fields(kind)}
    given = {}
    for key, value in table.items():
        if key in _OWN:
            continue
        if key not in own:
            raise DesignError(
                f"block '{name}' of kind {kind.__name__} has no '{key}'; there are: "
                f"{', '.join(sorted(own - {'name'}))}"
            )
        given[key] = _read(name, key, value)
    return kind(name, **given)


def _read(block: str, key: str, value: Any) -> Any:
    """A value of a field: an enumeration by the name of the field, else by its form."""
    if (key == "method" and isinstance(value, str)) or key in ("data_type", "from_type"):
        kind = basic.IntegrationMethod if key == "method" else DataType
        if value not in kind.__members__:
            raise DesignError(f"block '{block}': {key} is one of {', '.join(kind.__members__)}")
        return kind[value]
    if value == _NONE:
        return None
    if isinstance(value, list):
        return tuple(_read(block, "", one) for one in value)
    if isinstance(value, dict):
        kinds = {part.__name__: part for part in _PARTS}
        part = kinds.get(str(value.get("part")))
        if part is None or not is_dataclass(part):
            raise DesignError(f"block '{block}': 'part' is one of {', '.join(kinds)}")
        return part(**{k: _read(block, k, v) for k, v in value.items() if k != "part"})
    return value
