# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reads the header of a generated model: ours, or Embedded Coder's under either naming scheme."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from ravenbrick.codegen.c.declarations import (
    NUMBERS,
    Declarations,
    Leaf,
    Parameter,
    Structure,
    read_declarations,
)
from ravenbrick.errors import DesignError

__all__ = ["KEPT_ROLES", "CField", "ModelHeader", "read_header"]

# What a structure is for, by the name of its type: the names of 2012 and those of today. The
# model's name stands behind it, or nothing where the names are short.
_ROLES = {
    "inputs": ("ExternalInputs", "ExtU"),
    "outputs": ("ExternalOutputs", "ExtY"),
    "work": ("D_Work", "DW"),
    "signals": ("BlockIO", "B"),
    "crossings": ("PrevZCSigStates", "PrevZCX"),
    "continuous": ("ContinuousStates", "X"),
    "parameters": ("Parameters", "P"),
    "model": ("RT_MODEL",),
}
KEPT_ROLES = ("work", "signals", "crossings", "continuous")
# Identifiers of generated C are cut there.
_IDENTIFIER_LENGTH = 31
_INITIALIZE = re.compile(r"(\w+)_initialize\Z")
# Names that people give the entry points in the code mappings.
_ENTRIES = {
    "initialize": re.compile(r"(?:\w+_)?(?:init|initiali[sz]e)\Z", re.IGNORECASE),
    "step": re.compile(r"(?:\w+_)?(?:step|run|update)\Z", re.IGNORECASE),
}
_NO_PORTS = (
    "the root of the model needs at least one inport and one outport, with the storage class Auto; "
    "replace blocks of a board's devices by ports, because the drivers are in Ada"
)
_SOLVER = (
    "the model has a solver (RTWSolverInfo), which integrates continuous states between the steps; "
    "make its blocks discrete (Model Discretizer, or 'ravenbrick import'), choose the solver "
    "'discrete (no continuous states)' and the target ert.tlc, and generate it again"
)


@dataclass(frozen=True)
class CField:
    """A number in a structure; `length` is that of an array, `about` the comment behind it.

    `name` is a path (`pid.P`) where structures stand inside each other.
    """

    c_type: str
    name: str
    length: int | None
    about: str
    offset_bytes: int = 0

    @property
    def size_bytes(self) -> int:
        """Size of one element."""
        return NUMBERS[self.c_type]

    @property
    def unit(self) -> str:
        """The unit at the end of our comments, such as V; empty where there is none."""
        head = self.about.partition(";")[0]
        return head.rpartition(", ")[2].strip() if ", " in head else ""


@dataclass(frozen=True)
class EntryPoint:
    """A function of the model: its C name and what it takes, in order.

    Each argument is a role whose structure's address is passed, or `first_time`.
    """

    name: str
    arguments: tuple[str, ...]


@dataclass(frozen=True)
class ModelHeader:
    """The interface of a model.

    `types` and `fields` by role (inputs, outputs, work, signals, parameters, model), `sizes` and
    `alignments` in bytes, `symbols` the variables of the single instance by role, `links` which
    role's address stands where (byte offset) in the model's own structure, `entries` by
    initialize and step. `reentrant`: the functions for instances are there, as ours have them.
    """

    model: str
    types: Mapping[str, str]
    fields: Mapping[str, tuple[CField, ...]]
    sizes: Mapping[str, int]
    alignments: Mapping[str, int]
    symbols: Mapping[str, str]
    links: Mapping[str, int]
    entries: Mapping[str, EntryPoint]
    reentrant: bool

    @property
    def reusable(self) -> bool:
        """Whether the entry points take the model's data as arguments."""
        return any(set(entry.arguments) - {"first_time"} for entry in self.entries.values())

    def size_bits(self, role: str) -> int:
        """Size of a structure by the rules of C."""
        return 8 * self.sizes[role]


class _Reader:
    def __init__(self, text: str, file: str, others: Mapping[str, str]) -> None:
        self._file = file
        headers = {name: other for name, other in others.items() if not name.endswith(".c")}
        self._found = read_declarations({**headers, file: text})
        sources = {name: other for name, other in others.items() if name.endswith(".c")}
        self._defined = read_declarations(sources).variables
        self._own = read_declarations({file: text})
        self._model, self._names = self._entry_names()

    def _entry_names(self) -> tuple[str, dict[str, str]]:
        """The model's name, and those of its functions: Embedded Coder's, or the only likely."""
        for name in self._own.functions:
            match = _INITIALIZE.match(name)
            if match and f"{match[1]}_step" in self._own.functions:
                return match[1], {word: f"{match[1]}_{word}" for word in _ENTRIES}
        likely = {
            word: [name for name in self._own.functions if pattern.match(name)]
            for word, pattern in _ENTRIES.items()
        }
        if all(len(names) == 1 for names in likely.values()):
            return self._file.rpartition(".")[0], {word: likely[word][0] for word in likely}
        match = next(filter(None, map(_INITIALIZE.match, self._own.functions)), None)
        if match:
            return match[1], {word: f"{match[1]}_{word}" for word in _ENTRIES}
        raise DesignError(
            f"{self._file}: no entry point <model>_initialize is declared, but "
            f"{', '.join(self._own.functions) or 'no function'}; give the header of a generated "
            "model, such as functional.h, and let one function end in _initialize and one in _step "
            "(Code Mappings, Functions)"
        )

    def _role(self, name: str) -> str | None:
        """What a type of that name is for, if for anything."""
        for role, prefixes in _ROLES.items():
            for prefix in prefixes:
                if name == prefix:
                    return role
                if not name.startswith(f"{prefix}_"):
                    continue
                rest = name[len(prefix) + 1 :]
                plain = rest[:-2] if rest.endswith(("_T", "_t")) else rest
                cut = len(name) >= _IDENTIFIER_LENGTH - 1 and len(plain) > 3
                if self._model in (plain, rest) or (cut and self._model.startswith(plain)):
                    return role
        return None

    def _types(self) -> dict[str, str]:
        """Names of types by role; one that has a structure before one that is only declared."""
        names = [*self._found.structures, *self._found.aliases]
        types: dict[str, str] = {}
        for name in names:
            role = self._role(name)
            if role is not None and self._found.structure(name) is not None:
                types.setdefault(role, name)
        for name in names:
            role = self._role(name.rstrip("_"))
            if role is not None and self._found.structure(name) is not None:
                types.setdefault(role, name.rstrip("_"))
                self._found.aliases.setdefault(name.rstrip("_"), name)
        return types | self._linked_types(types)

    def _linked_types(self, types: Mapping[str, str]) -> dict[str, str]:
        """What the model's own structure points to: a subsystem may bear the model's name."""
        return {
            role: leaf.type_name
            for leaf in self._model_leaves(types)
            if leaf.pointer
            and (role := self._role(leaf.type_name)) is not None
            and self._found.structure(leaf.type_name) is not None
        }

    def _model_leaves(self, types: Mapping[str, str]) -> list[Leaf]:
        if "model" not in types:
            return []
        return self._found.leaves(self._structure(types["model"]))

    def _structure(self, name: str) -> Structure:
        found = self._found.structure(name)
        assert found is not None
        try:
            self._found.field_count(found)
        except DesignError as error:
            raise DesignError(f"{self._file}: {name}: {error}") from error
        return found

    def _fields(self, name: str) -> tuple[CField, ...]:
        structure = self._structure(name)
        self._check_members(structure, name)
        return tuple(
            CField(one.type_name, one.path, one.length, one.about, one.offset_bytes)
            for one in self._found.leaves(structure)
        )

    def _check_members(self, structure: Structure, name: str) -> None:
        for member in structure.members:
            inner = self._found.inside(member)
            if member.pointer:
                raise DesignError(
                    f"{self._file}: {name} has a field that is neither a number nor an array: "
                    f"'{member.name}'"
                )
            if inner is not None and not member.lengths:
                self._check_members(inner, name)
            elif self._found.resolved(member.type_name) not in NUMBERS:
                raise DesignError(
                    f"{self._file}: field '{member.name}' of {name} has the type "
                    f"{member.type_name}; a binding is written for numbers and arrays of numbers "
                    "only"
                )

    def _entry(self, word: str, types: Mapping[str, str]) -> EntryPoint | None:
        name = self._names[word]
        parameters = self._own.functions.get(name)
        if parameters is None:
            return None
        return EntryPoint(name, tuple(self._argument(name, one, types) for one in parameters))

    def _argument(self, function: str, parameter: Parameter, types: Mapping[str, str]) -> str:
        if parameter.name == "firstTime":
            return "first_time"
        role = self._role(parameter.type_name) if parameter.pointer else None
        if role is None:
            raise DesignError(
                f"{self._file}: {function} takes '{parameter.name}' by itself; generate the model "
                "with root inputs and outputs as structures, or as part of the model's data"
            )
        if role not in types:
            raise DesignError(
                f"{self._file}: {function} takes a {parameter.type_name}, which is not declared; "
                "give the model's other headers too"
            )
        return role

    def _links(self, types: Mapping[str, str]) -> dict[str, int]:
        links: dict[str, int] = {}
        for leaf in self._model_leaves(types):
            role = self._role(leaf.type_name) if leaf.pointer else None
            if role is not None:
                links.setdefault(role, leaf.offset_bytes)
        return links

    def read(self) -> ModelHeader:
        """The interface."""
        unsolved = "RTWSolverInfo" not in self._found.structures
        if unsolved and any(map(_has_solver, self._found.structures.values())):
            raise DesignError(f"{self._file}: {_SOLVER}")
        types = self._types()
        entries = {word: self._entry(word, types) for word in ("initialize", "step")}
        for role in ("inputs", "outputs"):
            if role not in types:
                raise DesignError(
                    f"{self._file}: no structure of the model's {role} is declared; {_NO_PORTS}"
                )
        bound = ["inputs", "outputs", "parameters"]
        reentrant = f"{self._model}_step_instance" in self._own.functions
        bound += ["work"] if reentrant else []
        fields = {role: self._fields(types[role]) for role in bound if role in types}
        extents = {role: self._found.extent(self._structure(name)) for role, name in types.items()}
        return ModelHeader(
            model=self._model,
            types=types,
            fields=fields,
            sizes={role: extent[0] for role, extent in extents.items()},
            alignments={role: extent[1] for role, extent in extents.items()},
            symbols=self._symbols(self._found, types),
            links=self._links(types),
            entries={word: entry for word, entry in entries.items() if entry is not None},
            reentrant=reentrant,
        )

    def _symbols(self, found: Declarations, types: Mapping[str, str]) -> dict[str, str]:
        symbols: dict[str, str] = {}
        for name, variable in found.variables.items():
            role = self._role(variable.type_name)
            if role is not None and role in types and variable.pointer == (role == "model"):
                symbols.setdefault(role, name)
        for name, variable in self._defined.items():
            if self._role(variable.type_name) == "parameters" and not variable.pointer:
                symbols.setdefault("parameters", name)
        return symbols


def _has_solver(structure: Structure) -> bool:
    return any(one.type_name == "RTWSolverInfo" and not one.pointer for one in structure.members)


def read_header(
    text: str, file: str = "header", others: Mapping[str, str] | None = None
) -> ModelHeader:
    """The interface that a header declares; raises `DesignError` with what cannot be bound.

    `others` are texts by name of headers that it includes, and of sources, in which parameters may
    be defined that no header declares.
    """
    return _Reader(text, file, others or {}).read()
