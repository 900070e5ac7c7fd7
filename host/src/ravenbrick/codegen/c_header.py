# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reads the header of a generated model: ours, or Embedded Coder's under either naming scheme."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from ravenbrick.errors import DesignError

__all__ = ["C_SIZES", "CField", "ModelHeader", "read_header"]

# Sizes in bytes of the names of rtwtypes.h and of their C99 counterparts on the brick.
C_SIZES: Mapping[str, int] = {
    **dict.fromkeys(("int8_T", "int8_t", "uint8_T", "uint8_t", "boolean_T", "bool", "char_T"), 1),
    **dict.fromkeys(("int16_T", "int16_t", "uint16_T", "uint16_t"), 2),
    **dict.fromkeys(("int32_T", "int32_t", "uint32_T", "uint32_t", "int_T", "uint_T"), 4),
    **dict.fromkeys(("int", "real32_T", "float", "ulong_T"), 4),
    **dict.fromkeys(("int64_T", "int64_t", "uint64_T", "uint64_t"), 8),
    **dict.fromkeys(("real_T", "real64_T", "double", "time_T"), 8),
}

# What a structure is for, by the name of its type: the names of 2012 and those of today.
_ROLES = {
    "inputs": ("ExternalInputs_{}", "ExtU_{}_T", "ExtU_{}"),
    "outputs": ("ExternalOutputs_{}", "ExtY_{}_T", "ExtY_{}"),
    "work": ("D_Work_{}", "DW_{}_T", "DW_{}"),
    "signals": ("BlockIO_{}", "B_{}_T", "B_{}"),
    "parameters": ("Parameters_{}", "P_{}_T", "P_{}"),
}
_STRUCTURE = re.compile(
    r"(?:typedef\s+struct(?:\s+\w+)?\s*\{(?P<body>[^{}]*)\}\s*(?P<name>\w+)\s*;)"
    r"|(?:struct\s+(?P<tag>\w+)\s*\{(?P<tagged>[^{}]*)\}\s*;)"
)
_FIELD = re.compile(
    r"(?P<type>[A-Za-z_]\w*)\s+(?P<name>[A-Za-z_]\w*)\s*(?:\[(?P<length>\w+)\])?\s*;"
    r"[ \t]*(?:/\*(?P<about>.*?)\*/)?",
    re.DOTALL,
)
_VARIABLE = re.compile(r"^\s*extern\s+(?P<type>\w+)\s+(?P<name>\w+)\s*;", re.MULTILINE)
_FUNCTION = re.compile(r"^\s*extern\s+void\s+(?P<name>\w+)\s*\((?P<of>[^)]*)\)\s*;", re.MULTILINE)


@dataclass(frozen=True)
class CField:
    """A field of a structure; `length` is that of an array, `about` the comment behind it."""

    c_type: str
    name: str
    length: int | None
    about: str

    @property
    def size_bytes(self) -> int:
        """Size of one element."""
        return C_SIZES[self.c_type]

    @property
    def unit(self) -> str:
        """The unit at the end of our comments, such as V; empty where there is none."""
        head = self.about.partition(";")[0]
        return head.rpartition(", ")[2].strip() if ", " in head else ""


@dataclass(frozen=True)
class ModelHeader:
    """The interface of a model.

    `types` and `fields` by role (inputs, outputs, work, signals, parameters), `symbols` the
    variables of the single instance by role, `functions` the entry points with their parameters.
    """

    model: str
    types: Mapping[str, str]
    fields: Mapping[str, tuple[CField, ...]]
    symbols: Mapping[str, str]
    functions: Mapping[str, str]

    @property
    def reentrant(self) -> bool:
        """Whether the step function takes its state as an argument, as ours does."""
        return f"{self.model}_step_instance" in self.functions

    def size_bits(self, role: str) -> int:
        """Size of a structure by the rules of C."""
        offset, widest = 0, 1
        for field in self.fields[role]:
            size = field.size_bytes
            offset = -(-offset // size) * size + size * (field.length or 1)
            widest = max(widest, size)
        return 8 * (-(-offset // widest) * widest)


def _model_name(text: str, file: str) -> str:
    found: list[str] = re.findall(r"\bextern\s+void\s+(\w+)_initialize\s*\(", text)
    if not found:
        raise DesignError(
            f"{file}: no entry point <model>_initialize is declared; give the header of a "
            "generated model, such as functional.h"
        )
    return found[0]


def _fields(body: str, structure: str, file: str) -> tuple[CField, ...]:
    fields = []
    code = re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL)
    for match in _FIELD.finditer(body):
        kind, name, length = match["type"], match["name"], match["length"]
        if kind not in C_SIZES:
            raise DesignError(
                f"{file}: field '{name}' of {structure} has the type {kind}; a binding is written "
                "for numbers and arrays of numbers only"
            )
        if length is not None and not length.isdigit():
            raise DesignError(f"{file}: the length of '{name}' in {structure} must be a number")
        about = " ".join((match["about"] or "").split())
        fields.append(CField(kind, name, int(length) if length else None, about))
    if len(fields) != code.count(";"):
        raise DesignError(f"{file}: {structure} has a field that is no number and no array")
    return tuple(fields)


def read_header(text: str, file: str = "header") -> ModelHeader:
    """The interface that a header declares; raises `DesignError` with what cannot be bound."""
    model = _model_name(text, file)
    text = re.sub(r"^[ \t]*//.*$", "", text, flags=re.MULTILINE)
    bodies: dict[str, str] = {}
    for match in _STRUCTURE.finditer(text):
        name = match["name"] or match["tag"].rstrip("_")
        bodies[name] = match["body"] if match["body"] is not None else match["tagged"]
    types: dict[str, str] = {}
    fields: dict[str, tuple[CField, ...]] = {}
    for role, patterns in _ROLES.items():
        names = [pattern.format(model) for pattern in patterns]
        chosen = next((name for name in names if name in bodies), None)
        if chosen is not None:
            types[role] = chosen
            fields[role] = _fields(bodies[chosen], chosen, file)
    if "inputs" not in types and "RT_MODEL" in text:
        raise DesignError(
            f"{file}: the model has reusable functions (RT_MODEL); generate it with nonreusable "
            "functions, so that its inputs and outputs are variables"
        )
    for role in ("inputs", "outputs"):
        if role not in types:
            raise DesignError(f"{file}: no structure of the model's {role} is declared")
    roles = {name: role for role, name in types.items()}
    symbols = {
        roles[match["type"]]: match["name"]
        for match in _VARIABLE.finditer(text)
        if match["type"] in roles
    }
    functions = {m["name"]: " ".join(m["of"].split()) for m in _FUNCTION.finditer(text)}
    return ModelHeader(model, types, fields, symbols, functions)
